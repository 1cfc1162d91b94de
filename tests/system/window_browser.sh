#!/bin/bash
# SPDX-License-Identifier: MIT
# The window's page in headless Chromium: each view and button. npm installs what drives it into the build folder, once.
# PICTURES names a folder for screenshots.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/setup.sh"
[[ -n ${RKM04_WINDOW-} ]] || skip_all "built without the window"
CHROMIUM=$(command -v chromium) || skip_all "there is no chromium"
export CHROMIUM
drive=$(cd "$(dirname "$0")" && pwd)/window/drive.mjs
modules=${BUILD-${TMPDIR-/tmp}}/node-window
export NODE_PATH=$modules/node_modules
setup_window "$modules" || skip_all "there is no node with npm, or npm cannot install playwright-core (see $modules/npm.log)"

# open_window OPTION...: starts it; $address is what it prints.
open_window() {
    start window "$RKMCTL" window "$@"
    export WINDOW_PID=$started
    soon "the address of the window" grep -q '^WINDOW http://' "$folder/window.out"
    address=$(sed -n 's/^WINDOW //p' "$folder/window.out")
}

# drive CASE: with an emulator and the window.
drive() {
    serve bus
    drive_with "$1" "$folder/bus.control"
}

# drive_with CASE CONTROL: with the window for the emulator with this control socket.
drive_with() {
    open_window -c "$2"
    HOME=$folder exits 0 timeout 200 node "$drive" "$1" "$address" "$folder" ${PICTURES-}
    [[ -z $said ]] || printf '  %s\n' "$said"
}

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
test_the_page_is_small() { drive size; }
test_the_page_looks_as_its_references() {
    serve bus --clock stepped
    drive_with references "$folder/bus.control"
}
test_the_page_is_quickly_there() { drive load; }
test_stop_all_answers_within_100_ms() { drive stop; }
test_curves_of_sixteen_units_are_drawn_smoothly() {
    serve bus --node 1-16
    exits 0 "$RKMCTL" -p "$folder/bus" -n 0 -m 0 set '\ C100 S200 V4000 A8000 L20 F90000 R B90000 R E'
    drive_with frames "$folder/bus.control"
}

run_cases "$@"
