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
    person 'events step...' 'wait for events step' '^C' position '^D'
    holds "$shown" "motor 1: 0" "a command behind it"
}

run_cases "$@"
