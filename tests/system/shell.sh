#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl shell: commands and program text from a file and from a person.

. "$(dirname "$0")/lib.sh"
here=$(cd "$(dirname "$0")" && pwd)

# script LINE...: the file of commands.
script() {
    printf '%s\n' "$@" >"$folder/script"
}

# person LINE...: what a person types; what is shown is in $shown.
person() {
    shown=$(printf '%s\n' "$@" | XDG_STATE_HOME=$folder/state python3 "$here/shell_client.py" "$RKMCTL" -p "$folder/bus" \
        -c "$folder/bus.control" shell) || fail "the shell: $shown"
}

test_a_file_has_commands_and_program_text() {
    serve bus --clock x50
    script '# a comment' 'version --help' version 'motor 2' '\ S100 V1000 A2000 F50 R' 'wait m2.position=50' position
    exits 0 "$RKMCTL" -p "$folder/bus" -c "$folder/bus.control" shell -f "$folder/script"
    holds "$said" "01.02" "the version"
    holds "$said" "motor 2: 50" "the position"
}

test_a_file_ends_at_the_first_command_that_fails() {
    serve bus
    script position 'motor 9' version
    exits 2 "$RKMCTL" -p "$folder/bus" shell -f "$folder/script"
    holds "$complained" "script:2: error: expected a motor 0 to 4, found '9'" "the place"
    [[ $said != *01.02* ]] || fail "it went on"
    script 'set "x'
    exits 2 "$RKMCTL" -p "$folder/bus" shell -f "$folder/script"
    holds "$complained" "script:1: error: expected a closing quote" "an open quote"
    script 'F100 q'
    exits 1 "$RKMCTL" -p "$folder/bus" shell -f "$folder/script"
    exits 1 "$RKMCTL" shell -f "$folder/none"
}

test_a_file_that_cannot_be_read_as_lines_is_an_error() {
    serve bus
    mkdir "$folder/directory"
    exits 1 "$RKMCTL" -p "$folder/bus" shell -f "$folder/directory"
    holds "$complained" "cannot read $folder/directory: Is a directory" "a folder"
    head -c 100000 /dev/zero | tr '\0' F >"$folder/long"
    exits 1 "$RKMCTL" -p "$folder/bus" shell -f "$folder/long"
    holds "$complained" "long:1: error: expected a line of at most" "a line without an end"
    printf 'F100\0 R\n' >"$folder/binary"
    exits 1 "$RKMCTL" -p "$folder/bus" shell -f "$folder/binary"
    holds "$complained" "binary:1: error: expected a text" "a byte 0"
}

test_a_pmc_has_commands_over_each_way() {
    serve bus --device pmc-2hs --control "$folder/bus.control"
    script 'pmc move x=20' 'wait m1.position=20' 'wait m1.idle' 'pmc program get' 'pmc position' \
        "call pmc.register_position '{\"axes\":\"x\",\"reg\":7}'" 'pmc program get'
    exits 0 "$RKMCTL" -p "$folder/bus" -c "$folder/bus.control" shell -f "$folder/script"
    holds "$said" "X: 07 ABS 20 V1" "the program"
    holds "$said" "x: 20" "the position"
    script 'pmc position'
    exits 0 "$RKMCTL" -p "$folder/bus" shell -f "$folder/script"
    holds "$said" "x: 20" "the position over the port"
    script 'POS'
    exits 2 "$RKMCTL" -p "$folder/bus" --face ascii shell -f "$folder/script"
    holds "$complained" "expected a command, as pmc: program text is for an RKM04, found 'POS'" "program text"
}

test_a_pmc_with_modbus_has_them_too() {
    serve bus --device pmc-1hs --device-option face=modbus --node 16
    script 'node 16' 'pmc speed x=77' 'pmc position' 'pmc parameters get'
    exits 0 "$RKMCTL" -p "$folder/bus" --face modbus --baud 9600 shell -f "$folder/script"
    same "x: 0" "${said%%$'\n'*}" "the position"
}

test_commands_of_a_pmc_are_completed() {
    serve bus --device pmc-2hs --control "$folder/bus.control"
    person 'pmc pos\t' 'pm\tjo\tx+' 'pmc stop' quit
    holds "$shown" "pmc position" "completion"
    holds "$shown" "y: 0" "the positions"
    holds "$shown" "pmc jog x+" "completion of both"
}

test_all_commands_are_for_the_same_emulator() {
    serve one --node 3
    serve two
    script 'di 5=1' state
    exits 0 env -u RKM04_CONTROL XDG_RUNTIME_DIR="$folder" "$RKMCTL" -p "$folder/two" shell -f "$folder/script"
    holds "$said" "unit 1" "the unit of the emulator whose bus it is"
    script 'node 3' position
    exits 0 env -u RKM04_PORT "$RKMCTL" -c "$folder/one.control" shell -f "$folder/script"
    same "motor 1: 0" "$said" "the position in the emulator whose control socket it is"
    script state
    exits 1 env -u RKM04_CONTROL "$RKMCTL" -p "$folder/none" shell -f "$folder/script"
    holds "$complained" "no emulator of yours has the bus $folder/none: expected --control" "a bus without an emulator"
    exits 0 env -u RKM04_CONTROL RKM04_PORT="$folder/one" "$RKMCTL" state
    holds "$said" "unit 3" "the emulator of RKM04_PORT"
}

test_commands_come_from_a_pipe_too() {
    serve bus
    said=$(echo position | "$RKMCTL" -p "$folder/bus" shell) || fail "a pipe"
    same "motor 1: 0" "$said" "the position"
}

test_a_person_edits_and_completes_and_finds_the_lines_again() {
    serve bus --node 3
    person 'node 3' 'motor 2' 'pos\t' 'help di' 'bogus' 'di 3=1' quit
    holds "$shown" "unit 3, motor 2> " "the prompt"
    holds "$shown" "motor 2: 0" "a completed command"
    holds "$shown" "Usage: rkmctl [OPTION...] di" "help for a command"
    holds "$shown" "found 'bogus'" "a wrong command"
    holds "$shown" "03=1" "the inputs"
    grep -q '^di' "$folder/state/rkm04/history" || fail "the history"
    same 600 "$(stat -c %a "$folder/state/rkm04/history")" "its mode"
}

test_an_interrupt_ends_the_command_and_not_the_shell() {
    serve bus
    person 'events step...' 'wait for listening' '^C' position '^D'
    holds "$shown" "motor 1: 0" "a command behind it"
    [[ $shown != *unknown* ]] || fail "events had not begun"
}

test_the_end_may_be_pressed_while_a_command_runs() {
    serve bus
    person 'events step count=1...' 'wait for listening' '^D...' "! '$RKMCTL' -p '$folder/bus' set 'F1 R'"
    holds "$shown" "step" "the event"
}

run_cases "$@"
