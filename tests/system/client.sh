#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl against a real unit: long programs, refusals, silence, broadcast, machine-readable answers.

. "$(dirname "$0")/lib.sh"

test_no_answer_in_time_is_exit_3_with_advice() {
    serve bus --node 2 --no-control # as at a real bus: no client can be asked
    exits 3 ctl bus -n 5 --timeout 200 version
    holds "$complained" 5 "the message names the node"
    holds "${complained,,}" framing "the message says what to check"
}

# pretend SHELL: the device $folder/device, at whose other end this is.
pretend() {
    [[ -z ${device-} ]] || kill "$device"
    [[ -z ${device-} ]] || status_of "$device"
    start device socat "PTY,raw,echo=0,link=$folder/device" "SYSTEM:$1"
    device=$started
    soon "the device is there" test -e "$folder/device"
}

# A shell that answers a request with these bytes, in hex.
answering() {
    say_bytes 1 "$1" >"$folder/bytes"
    echo "head -c 3 >/dev/null; cat $folder/bytes; cat >/dev/null"
}

# no_answer PART [ARGUMENTS...]: a request that gets no answer; the message has the part. What comes instead may come late on a
# busy machine: then more time is given. $again is done before each request.
no_answer() {
    local part=$1 time
    shift
    for time in 200 2000 20000; do
        $again
        exits 3 "$RKMCTL" --timeout $time "$@" version
        [[ $complained == *"$part"* ]] && return
    done
    fail "no '$part' in '$complained'"
}
again=true

test_no_answer_names_the_cause_where_it_can_be_known() {
    serve bus --baud 0
    exits 0 "$RKMCTL" -c "$folder/bus.control" fault inject wrong_fcs
    no_answer "1 frames came with a wrong check value" -p "$folder/bus"
    holds "$complained" "two units have the address 1" "what may have damaged it"
    plain() { pretend "$(answering 00000404313100)"; } # from node 0: not the answer
    again=plain
    no_answer "came in the framing plain: try --framing plain" -p "$folder/device"
    rm "$folder/bus.control"
    exits 3 ctl bus --timeout 200 -n 7 version
    holds "$complained" "nothing was received" "silence"
}

# silent PART ARGUMENTS...: a request that gets no answer; the message has the part.
silent() {
    exits 3 ctl bus --timeout 200 "${@:2}" version
    holds "$complained" "$1" "the message"
}

test_no_answer_names_what_the_emulator_knows() {
    serve bus --node 5,7 --framing plain
    silent "use the framing plain: try --framing plain" -n 5
    [[ $complained != *"have power"* ]] || fail "a general list though the cause is known: $complained"
    silent "no unit of this emulator has the address 6; there are 5, 7" --framing plain -n 6
    exits 0 "$RKMCTL" -c "$folder/bus.control" --unit 7 power off
    silent "unit 7 of this emulator is without power" --framing plain -n 7
    kill "$started"
    status_of "$started"
    serve bus --clock stepped
    exits 0 "$RKMCTL" -c "$folder/bus.control" fault inject delay delay=1s
    silent "time of this emulator is stopped"
}

# Their answers overlap in part: no frame is whole.
test_two_units_of_one_address_with_different_delays_are_named() {
    serve bus --node 5,5
    exits 0 "$RKMCTL" -c "$folder/bus.control" --unit 5-2 fault inject delay delay=700us
    silent "2 units of this emulator have the address 5: their answers collide" -n 5
    rm "$folder/bus.control" # as at a real bus: no client can be asked
    no_answer "do two units have the address 5" -p "$folder/bus" -n 5
}

test_a_request_that_comes_back_is_called_an_echo() {
    echo_it() { pretend cat; }
    again=echo_it
    no_answer "the request itself came back" -p "$folder/device"
}

test_C10_a_program_that_overflows_is_a_failure_unless_allowed() {
    local i
    serve bus --clock stepped
    for i in {1..400}; do echo "W$i"; done >"$folder/half.rks"
    exits 0 ctl bus send "$folder/half.rks"
    exits 1 ctl bus send "$folder/half.rks"
    holds "$complained" "overflowed (flag 3)" "what happened"
    holds "$complained" "--allow-overflow" "what to do if that is meant"
    exits 0 ctl bus --allow-overflow send "$folder/half.rks"
    holds "$complained" "warning" "still said"
    exits 1 ctl bus set "$(tr '\n' ' ' <"$folder/half.rks")"
    exits 2 "$RKMCTL" -c "$folder/bus.control" --allow-overflow state
}

test_a_device_that_cannot_be_opened_is_exit_1() {
    exits 1 "$RKMCTL" -p "$folder/nothing" version
    holds "$complained" "$folder/nothing" "the message names it"
}

test_P1_a_refusal_is_exit_1_and_names_the_character() {
    serve bus --baud 0
    exits 1 ctl bus set 'F1000 R q'
    holds "$complained" q "the character"
    exits 0 ctl bus command
    [[ $said != *F1000* ]] || fail "something of a refused text was stored: $said"
}

test_a_refusal_in_a_file_is_shown_with_line_and_column() {
    serve bus --baud 0
    printf 'S100 A2000\n{ two }\nF1000 V99999 R\n' >"$folder/program.rks"
    exits 1 ctl bus send "$folder/program.rks"
    holds "$complained" "$folder/program.rks:3:7:" "place of the error"
}

test_a_program_longer_than_a_message_is_cut_and_runs_once_it_is_whole() {
    local i
    serve bus --baud 0 --clock max
    {
        echo '\ C100 { a comment longer than one message:'
        for i in {1..400}; do echo "  line $i of a comment that goes on and on"; done
        echo '}'
        for i in {1..300}; do echo "F$i R { step $i }"; done
    } >"$folder/long.rks"
    (($(wc -c <"$folder/long.rks") > 9216)) || fail "the program is not long"
    exits 0 ctl bus -m 1 send "$folder/long.rks"
    soon "all 300 motions are done" position_is bus 1 45150
}

test_a_program_that_memory_cannot_hold_is_refused() {
    local i
    serve bus --baud 0
    for i in {1..2000}; do echo "F16000000 {$i}"; done >"$folder/long.rks"
    exits 1 ctl bus send "$folder/long.rks"
    holds "$complained" 69 "the message says how many commands fit"
}

test_typographic_apostrophes_are_calls() {
    serve bus --baud 0 --clock max
    exits 0 ctl bus set 'F250 ´3 J4 @3 R . @4'
    soon "the subroutine has run" position_is bus 1 250
    exits 0 ctl bus command
    holds "$said" "'3" "the canonical call"
}

test_L3_a_broadcast_is_obeyed_and_not_waited_for() {
    serve bus --node 9 --baud 0 --clock max
    exits 0 ctl bus -n 0 -m 0 set 'F77 R'
    soon "the broadcast was obeyed" position_of_node_9
}

position_of_node_9() { [[ $(ctl bus -n 9 -m 4 position) == "motor 4: 77" ]]; }

test_raw_shows_the_bytes_of_the_answer() {
    serve bus
    exits 0 ctl bus raw 08
    same "ff080000" "$(tr -d ' \n' <<<"${said,,}")" "answer to message 8"
}

test_every_answer_can_be_had_as_json() {
    serve bus --baud 0
    exits 0 ctl bus --json version
    holds "$said" '"01.02,06.03.2009"' version
    exits 0 ctl bus --json -m 2 position
    holds "$said" '"position"' position
    exits 0 ctl bus --json -m 2 set 'W16000000'
    holds "$said" '"flag"' set
    exits 0 ctl bus --json -m 2 command
    holds "$said" '"W16000000"' command
    exits 0 ctl bus --json -m 2 progress
    holds "$said" '"index"' progress
    exits 0 ctl bus --json -m 2 table
    holds "$said" '"points"' table
}

run_cases "$@"
