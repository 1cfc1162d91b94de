#!/bin/bash
# SPDX-License-Identifier: MIT
# The window's page in headless Chromium: each view and button. PICTURES names a folder for screenshots.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/window/browser.sh"

test_the_service_view_sends_each_message() { drive service; }
test_the_editor_marks_explains_formats_opens_and_saves() { drive editor; }
test_each_control_of_the_panel_acts() { drive panel; }
test_a_program_is_listed_with_the_present_command_in_it() { drive listing; }
test_axes_are_drawn_and_dragged_between_their_stops() { drive axes; }
test_faults_of_flash_and_power_are_injected_by_the_form() { drive faults; }
test_several_buses_are_shown_one_at_a_time() {
    start bus "$RKM04" serve --lines 2 --node 1,2 --link "$folder/bus%l" --control "$folder/control"
    soon "the units are ready" ready bus
    drive_with buses "$folder/control"
}
test_the_language_changes_what_is_in_the_logs() { drive language; }
test_two_pages_show_the_same() { drive pages; }
test_everything_works_with_the_keyboard_alone() { drive keyboard; }
test_both_languages_and_themes_are_accessible_at_three_sizes() { drive looks; }
test_an_emulator_that_ends_and_comes_again_is_shown() {
    export RKM04 RKMCTL
    drive loss
}
test_the_page_looks_as_its_references() {
    serve bus --clock stepped
    drive_with references "$folder/bus.control"
}
test_the_panel_of_a_CIB_module_shows_drives_outputs_and_configuration() {
    serve bus --device cib
    drive_with cib "$folder/bus.control"
}
test_the_panel_of_a_CNC872_moves_its_axes_and_draws_their_path() {
    printf 'G1 X3 F600\nY2\n' >"$folder/corner.nc"
    start bus "$RKM04" serve --device cnc872 --nc "$folder/corner.nc" --control "$folder/bus.control"
    soon "the unit is ready" ready bus
    drive_with cnc "$folder/bus.control"
}
test_a_device_without_a_bus_shows_what_it_has() {
    start bus "$RKM04" serve --device cnc872 --control "$folder/bus.control"
    soon "the unit is ready" ready bus
    drive_with nobus "$folder/bus.control"
}
test_the_panel_of_a_PMC_does_what_its_maker_s_window_does() {
    serve bus --device pmc-2hs
    drive_with pmc "$folder/bus.control"
}

run_cases "$@"
