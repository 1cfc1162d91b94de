#!/bin/bash
# SPDX-License-Identifier: MIT
# The message examples of the manual's chapter 5.3, byte for byte over the unit's own pty, in both framings (L1, L2).
# The port is opened like a file, without any setting of the line: it must be raw from the start.

. "$(dirname "$0")/lib.sh"

hex() { printf '%s' "$1" | od -An -v -tx1 | tr -d ' \n'; }

# what | request | its FCS-16 | answer | its FCS-16. The check sums were computed apart from the product (RFC 1662 appendix C).
fresh_unit="
5.3.1 Version                       |01                   |99 8d|01 10 $(hex 01.02,06.03.2009)|8a fa
5.3.2 Set Command, motor 3          |02 33 $(hex C100)    |ae ab|02 33 00 00                  |77 ac
5.3.2 Set Command, motor 1          |02 31 $(hex C100)    |26 bd|02 31 00 00                  |cf 19
5.3.2 Set Command, bad value        |02 31 $(hex I01X5)   |85 73|02 31 01 $(hex I)            |d2 df
5.3.2 Set Command, unknown          |02 31 $(hex 'R q')   |02 22|02 31 02 $(hex q)            |71 48
5.3.3 Store Flash, motor 4          |03 34                |aa bd|03 34 00                     |6a ed
5.3.4 Get Position, motor 1         |04 31                |0f a7|04 31 0a $(hex '         0') |b0 0d
5.3.5 Set Command, motor 2          |02 32 $(hex C100)    |ea a0|02 32 00 00                  |ab f6
5.3.5 Get Command, motor 2          |05 32                |4c 8c|05 32 $(hex C100)            |51 a2
5.3.5 Get Command, all motors       |05 30                |5e af|05 30 $(hex 'ERROR COMMAND! ')|37 c8
5.3.6 Get Tabul Run, all motors     |06 30                |36 85|06 30 $(hex 'ERROR COMMAND! ')|26 f8
5.3.6 Get Tabul Run, no motion      |06 32                |24 a6|06 32 $(hex ' 0;[]')         |47 9a
5.3.7 Get Pozic Run, all motors     |07 30                |ee 9c|07 30 $(hex 'ERROR COMMAND! ')|29 e8
5.3.8 Unknown message 8             |08                   |58 10|ff 08 00 00                  |db ff"

points='(1;100),(61;500),(2001;500),(2938;2000),(3063;2000),(4001;500),(9001;500),(12001;2500),(14001;1500),(15001;1500)'
points+=',(16001;500),(17881;500),(18000;0)'
table="
5.3.6 Get Tabul Run of 7.36         |06 32                |24 a6|06 32 $(hex " 13;[$points]") |94 96"
progress="
5.3.7 Get Pozic Run, motor 4        |07 34                |ca da|07 34 $(hex ' 45823; 5')     |5e a9"

# plain NODE MESSAGE: the frame in hex: node, length, message.
plain() {
    local message=${2// /}
    printf '%s%04x%s' "$1" $((${#message} / 2)) "$message"
}

# examples FD FRAMING ROWS
examples() {
    local what request request_check answer answer_check
    while IFS='|' read -r what request request_check answer answer_check; do
        [[ -n $what ]] || continue
        if [[ $2 == hdlc ]]; then
            dialogue "$1" "7e 01 00 $request $request_check 7e" "7e 00 01 $answer $answer_check 7e" "$what"
        else
            dialogue "$1" "$(plain 01 "$request")" "$(plain 01 "$answer")" "$what"
        fi
    done <<<"$3"
}

all_positions() {
    local zero="0a $(hex '         0')"
    if [[ $2 == hdlc ]]; then
        dialogue "$1" "7e 01 00 04 30 86 b6 7e" "7e 00 01 04 30 $zero $zero $zero $zero e0 df 7e" "5.3.4 Get Position, all motors"
    else
        dialogue "$1" "$(plain 01 0430)" "$(plain 01 "0430 $zero $zero $zero $zero")" "5.3.4 Get Position, all motors"
    fi
}

every_example() {
    serve bus --baud 0 --framing "$1"
    exec 3<>"$folder/bus"
    examples 3 "$1" "$fresh_unit"
    all_positions 3 "$1"
    exec 3>&-
}

test_L1_every_example_of_5_3_over_the_pty_in_hdlc() { every_example hdlc; }
test_L2_every_example_of_5_3_over_the_pty_in_plain() { every_example plain; }

moving() { [[ $(ctl bus --framing "$1" -m "$2" table) != *"0;[]"* ]]; }

table_of_736() {
    serve bus --baud 0 --framing "$1"
    ctl bus --framing "$1" -m 2 set 'S100 A2000 V500 F2000 Y V2000 Y V500 F5000 Y V3000 A1000 Y V1500 F2000 Y V500 Y R' >&2 ||
        fail "the program of 7.36 was refused"
    soon "motor 2 moves" moving "$1" 2
    exec 3<>"$folder/bus"
    examples 3 "$1" "$table"
    exec 3>&-
}

test_P7_the_table_of_7_36_over_the_pty_in_hdlc() { table_of_736 hdlc; }
test_P7_the_table_of_7_36_over_the_pty_in_plain() { table_of_736 plain; }

steps_done() {
    local said
    said=$(ctl bus --framing "$1" -m 4 progress --json)
    said=${said#*\"steps\":}
    said=${said%%[,\}]*}
    ((${said:-0} >= $2))
}

# K on the final ramp lets the motion run to its own end and holds then (C3): all steps are done, R is the fifth command.
progress_of_a_finished_motion() {
    serve bus --baud 0 --clock x100 --framing "$1"
    ctl bus --framing "$1" -m 4 set 'S1 V16000 A1 F45823 R' >&2 || fail "the program was refused"
    soon "the motor is on its final ramp" steps_done "$1" 23000
    ctl bus --framing "$1" -m 4 set K >&2 || fail "K was refused"
    soon "the motion has ended" steps_done "$1" 45823
    exec 3<>"$folder/bus"
    examples 3 "$1" "$progress"
    exec 3>&-
}

test_P9_the_progress_example_of_5_3_7_over_the_pty_in_hdlc() { progress_of_a_finished_motion hdlc; }
test_P9_the_progress_example_of_5_3_7_over_the_pty_in_plain() { progress_of_a_finished_motion plain; }

# Silence cannot be waited for; but the next answer shows that there was nothing before it.
test_L3_broadcasts_and_other_nodes_get_no_answer() {
    serve bus --baud 0
    exec 3<>"$folder/bus"
    say_bytes 3 "7e 00 00 01 45 d7 7e"
    say_bytes 3 "7e 02 00 01 fd 62 7e"
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "only the unit's own request is answered"
    exec 3>&-
    serve plain --baud 0 --framing plain
    exec 3<>"$folder/plain"
    say_bytes 3 "00 00 01 01  02 00 01 01"
    dialogue 3 "01 00 01 08" "01 00 04 ff 08 00 00" "only the unit's own request is answered"
    exec 3>&-
}

test_L1_damaged_frames_are_dropped_and_the_next_one_is_answered() {
    serve bus --baud 0
    exec 3<>"$folder/bus"
    say_bytes 3 "7e 01 00 01 99 8e 7e" # wrong check sum
    say_bytes 3 "7e 01 00 01 7d 7e"    # aborted
    say_bytes 3 "7e 01 00 7e 7e 7e"    # too short, empty
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "a good frame after bad ones"
    exec 3>&-
}

run_cases "$@"
