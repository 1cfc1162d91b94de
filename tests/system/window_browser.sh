#!/bin/bash
# SPDX-License-Identifier: MIT
# The window's page in headless Chromium: each view and button. PICTURES names a folder for screenshots.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/window/browser.sh"

test_the_service_view_sends_each_message() { drive service; }
test_the_editor_marks_explains_formats_opens_and_saves() { drive editor; }
test_each_control_of_the_panel_acts() { drive panel; }
test_mistakes_of_an_operator_do_no_harm() { drive mistakes; }
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
# show_cnc CASE OPTION...: the panel of a CNC872 with these options.
show_cnc() {
    start bus "$RKM04" serve --device cnc872 --control "$folder/bus.control" "${@:2}"
    soon "the unit is ready" ready bus
    drive_with "$1" "$folder/bus.control"
}
test_a_device_without_a_bus_shows_what_it_has() { show_cnc nobus; }
test_the_panel_of_a_CNC872_moves_its_axes_and_draws_their_path() {
    printf 'G1 X30 F600\nY2\n' >"$folder/corner.nc"
    show_cnc cnc --nc "$folder/corner.nc"
}
test_keys_of_a_CNC872_are_let_go_whatever_happens_to_the_page() { show_cnc cncheld; }
test_keys_of_a_CNC872_are_let_go_when_the_window_ends() {
    show_cnc cncend
    soon "the axis has stopped" stands
}
stands() { [[ $("$RKMCTL" -c "$folder/bus.control" call cnc.state) != *'"state":"manual"'* ]]; }
test_an_NC_program_is_loaded_into_a_CNC872_and_a_block_chosen() { show_cnc cnctext; }
test_keys_displays_and_mechanisms_of_a_PLC_program_are_shown() {
    cat >"$folder/show.plc" <<'PLC'
MODULE_INIT
  LOD CNST.16
  STO BYTE.DISPTOC1.TOC_COLUMN
  LOD CNST.'A'
  STO BYTE.DISPTOC1.TOC_CHAR1
  LOD CNST.'b'
  STO BYTE.DISPTOC1.TOC_CHAR2
  LOD CNST.'c'
  STO BYTE.DISPTOC1.TOC_CHAR3
  LOD CNST.0FFh
  STO BYTE.DISPTOC1.TOC_CHAR4
MODULE_INIT_END
MODULE_MAIN
MECH_BEGIN WAIT
  LDR STOPPI
  EX0
MECH_END WAIT
MODULE_MAIN_END
PLC
    show_cnc cncplc --plc "$folder/show.plc"
}
test_cells_of_a_CNC872_are_found_shown_and_set() { show_cnc cnccells; }
test_a_PLC_program_is_listed_with_its_values_edited_and_loaded() {
    export RKMCTL
    cat >"$folder/wait.plc" <<'PLC'
DATA
COUNT DW 0
GO BIT 0
DATA_END
MODULE_MAIN
  LOD COUNT
  AD CNST.1
  STO COUNT
MECH_BEGIN WAIT
  LDR GO
  EX0
MECH_END WAIT
MODULE_MAIN_END
PLC
    sed 's/WAIT/OTHER/' "$folder/wait.plc" >"$folder/other.plc"
    show_cnc cncedit --plc "$folder/wait.plc" --clock stepped
}
test_a_bit_that_is_1_for_one_T_is_seen() {
    export RKMCTL
    cat >"$folder/blip.plc" <<'PLC'
DATA
COUNT DW 0
BLIP BIT 0
PEAK DW 0
DATA_END
MODULE_MAIN
  LOD COUNT
  AD CNST.1
  STO COUNT
  EQ CNST.5
  WR BLIP
  FL1 1,SHORT
  LOD CNST.0
  JL0 LOW
  LOD CNST.7
LOW: STO PEAK
MECH_BEGIN SHORT
  EX
MECH_END SHORT
MODULE_MAIN_END
PLC
    show_cnc cncpulse --plc "$folder/blip.plc" --clock stepped
}
test_cells_that_change_without_motion_are_seen_soon() {
    export RKMCTL
    show_cnc cncnews
}
test_a_curve_is_level_while_nothing_changes() { show_cnc cnclevel; }
test_an_emulator_of_a_CNC872_that_comes_again_shows_what_it_has() {
    export RKM04 RKMCTL
    printf 'MODULE_MAIN\nMECH_BEGIN WAIT\n EX\nMECH_END WAIT\nMODULE_MAIN_END\n' >"$folder/wait.plc"
    start bus "$RKM04" serve --device cnc872 --control "$folder/bus.control"
    export EMULATOR_PID=$started
    soon "the unit is ready" ready bus
    drive_with cncloss "$folder/bus.control"
}
test_all_axes_of_a_CNC872_have_their_curves() {
    {
        echo '<ChannelConfig>'
        for name in X Y Z {5..16}; do echo "<Axis Name=\"$name\"/>"; done
        echo '<Axis Name="4" Rotary="1"/></ChannelConfig>'
    } >"$folder/all.xml"
    show_cnc cncaxes --config "$folder/all.xml"
}
test_the_panel_of_a_PMC_does_what_its_maker_s_window_does() {
    serve bus --device pmc-2hs
    drive_with pmc "$folder/bus.control"
}

run_cases "$@"
