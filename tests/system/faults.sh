#!/bin/bash
# SPDX-License-Identifier: MIT
# Faults on demand, as a host sees them that knows nothing of them: byte by byte on the pty and over TCP.

. "$(dirname "$0")/lib.sh"

command -v python3 >/dev/null || skip_all "python3 is not there"
here=$(cd "${0%/*}" && pwd)
export RKM04 RKMCTL PYTHONDONTWRITEBYTECODE=1

unknown="7e 01 00 08 58 10 7e"            # message 8 to unit 1
answer="7e 00 01 ff 08 00 00 db ff 7e"    # and its answer
broken="7e 00 01 ff 08 00 00 da ff 7e"    # with the wrong check value

# fault KIND NAME=VALUE...
fault() {
    exits 0 "$RKMCTL" --control "$folder/bus.control" fault inject "$@"
}

clear() {
    exits 0 "$RKMCTL" --control "$folder/bus.control" fault clear
}

# state_of JQ-LIKE NAME: a number or word of the unit's state.
state_of() {
    "$RKMCTL" --control "$folder/bus.control" --json state | python3 -c "import json,sys; print(json.load(sys.stdin)$1)"
}

begin() {
    serve bus "$@"
    exec 3<>"$folder/bus"
    dialogue 3 "$unknown" "$answer" "without a fault"
}

# spent: no fault acts any more, which is so when the one request for which it was meant has come.
spent() { [[ $("$RKMCTL" --control "$folder/bus.control" fault) != *state=armed* ]]; }

# unanswered ARGUMENTS...: the client gets no answer, and the fault is spent. One that a busy machine lets wait for too long has
# gone before its request was read: then it asks again.
unanswered() {
    until spent; do
        exits 3 ctl bus --timeout 300 "$@"
    done
}

# silent WHAT: nothing has come; then a request is answered at once, and by nothing else.
silent() {
    same "" "$(timeout 0.3 head -c 1 <&3 | od -An -v -tx1)" "$1"
    dialogue 3 "$unknown" "$answer" "after it: $1"
}

test_bytes_to_the_host_are_dropped_flipped_duplicated_and_inserted() {
    begin
    fault drop direction=to_master skip=3 count=1
    dialogue 3 "$unknown" "7e 00 01 08 00 00 db ff 7e" "the fourth byte dropped"
    fault flip direction=to_master mask=240 skip=1 count=2
    dialogue 3 "$unknown" "7e f0 f1 ff 08 00 00 db ff 7e" "two bytes flipped"
    fault duplicate direction=to_master skip=4 count=1
    dialogue 3 "$unknown" "7e 00 01 ff 08 08 00 00 db ff 7e" "the fifth byte twice"
    fault insert byte=85 direction=to_master count=1
    dialogue 3 "$unknown" "55 $answer" "a byte before the first one"
    dialogue 3 "$unknown" "$answer" "all over"
}

test_bytes_to_the_unit_are_dropped_flipped_duplicated_and_inserted() {
    local kind
    begin
    for kind in drop "flip mask=4" duplicate "insert byte=0"; do
        # shellcheck disable=SC2086
        fault $kind direction=to_units skip=3 count=1
        say_bytes 3 "$unknown"
        silent "a request spoilt by $kind"
    done
    same 4 "$(state_of "['counters']['dropped']")" "frames that the unit dropped"
}

test_an_answer_is_late_by_what_was_asked_for() {
    local before after
    begin
    fault delay delay=400ms count=1
    before=$(date +%s%3N)
    dialogue 3 "$unknown" "$answer" "late"
    after=$(date +%s%3N)
    ((after - before >= 400)) || fail "it was late by $((after - before)) ms only"
}

test_no_answer_comes_and_the_request_is_obeyed() {
    begin
    fault no_answer count=1
    unanswered set '=4711'
    soon "the unit has obeyed" position_is bus 1 4711
}

test_the_check_value_of_an_answer_is_wrong() {
    begin
    fault wrong_fcs count=1
    dialogue 3 "$unknown" "$broken" "the wrong check value"
    dialogue 3 "$unknown" "$answer" "over"
    fault wrong_fcs
    exits 3 ctl bus --timeout 300 version
}

test_an_answer_ends_after_some_bytes() {
    begin
    fault cut bytes=4 count=1
    dialogue 3 "$unknown" "7e 00 01 ff" "four bytes of it"
    silent "the rest"
}

test_a_two_wire_adapter_lets_the_host_receive_its_own_bytes() {
    begin
    fault echo
    dialogue 3 "$unknown" "$unknown $answer" "echo and answer"
    clear
    dialogue 3 "$unknown" "$answer" "no echo"
}

test_a_break_swallows_what_is_sent_meanwhile() {
    begin
    fault break duration=1000s
    say_bytes 3 "$unknown"
    soon "the request has passed" passed 24 # and the one before, and its answer
    same "" "$(timeout 0.3 head -c 1 <&3 | od -An -v -tx1)" "what comes during the break"
    same 1 "$(state_of "['line']['framing_errors']")" "framing errors"
    clear
    dialogue 3 "$unknown" "$answer" "after the break"
}

# passed BYTES: so many have been on the line.
passed() { [[ $(state_of "['line']['bytes']") == "$1" ]]; }

test_a_cut_cable_is_silence_on_a_port_that_stays() {
    local pty
    begin
    pty=$(readlink "$folder/bus")
    fault cable
    say_bytes 3 "$unknown"
    same "" "$(timeout 0.3 head -c 1 <&3 | od -An -v -tx1)" "the cut cable"
    same "$pty" "$(readlink "$folder/bus")" "the link"
    [[ -c $pty ]] || fail "the pty is gone"
    clear
    dialogue 3 "$unknown" "$answer" "mended"
}

gone() { [[ ! -L $folder/bus ]]; }
back() { [[ -c $folder/bus ]]; }

test_an_unplugged_adapter_is_a_pty_that_goes_away_and_another_one_under_the_same_link() {
    begin --clock stepped
    fault unplugged duration=1500ms
    soon "the link goes" gone
    same "" "$(timeout "$limit" head -c 1 <&3 2>"$folder/hung" | od -An -v -tx1)" "a client that was there"
    { say_bytes 3 "7e" 2>"$folder/hung"; } && fail "writing to the adapter that is gone"
    exits 1 ctl bus version
    exec 3>&-
    exits 0 "$RKMCTL" --control "$folder/bus.control" advance 1499ms
    gone || fail "the link is back too early"
    exits 0 "$RKMCTL" --control "$folder/bus.control" advance 1ms
    soon "the link comes back" back
    exec 3<>"$folder/bus"
    dialogue 3 "$unknown" "$answer" "the new pty"
    kill "$started"
    status_of "$started"
    same 0 "$status" "exit status"
    gone || fail "the link is left"
    [[ ! -e $folder/bus.lock ]] || fail "the lock is left"
}

test_an_adapter_is_plugged_in_again_when_there_are_descriptors_for_it() {
    ulimit -n 40
    begin
    fault unplugged
    soon "the link goes" gone
    exec 3>&-
    exits 0 timeout "$limit" python3 "$here/descriptors_client.py" "$folder/bus.control" "$folder/bus.err"
    soon "the link comes back" back
    exec 3<>"$folder/bus"
    dialogue 3 "$unknown" "$answer" "the new pty"
}

test_the_new_pty_has_the_group_and_mode_of_the_old_one() {
    local group
    begin
    group=$(id -G | tr ' ' '\n' | tail -n 1)
    [[ $(id -u) != 0 ]] || group=65534
    chgrp "$group" "$(readlink "$folder/bus")"
    chmod 664 "$(readlink "$folder/bus")"
    fault unplugged duration=1ms
    soon "another pty" grep -q 'plugged in again' "$folder/bus.err"
    same "$group 664" "$(stat -L -c '%g %a' "$folder/bus")" "group and mode"
}

test_a_unit_that_ends_while_its_adapter_is_unplugged_leaves_nothing() {
    begin
    fault unplugged
    soon "the link goes" gone
    kill "$started"
    status_of "$started"
    same 0 "$status" "exit status"
    same "bus.err bus.out complained" "$(ls "$folder" | tr '\n' ' ' | sed 's/ $//')" "what is left"
}

test_a_unit_killed_while_its_adapter_is_unplugged_can_be_started_again() {
    begin
    fault unplugged
    soon "the link goes" gone
    kill -KILL "$started"
    wait "$started"
    exec 3>&-
    begin
}

test_an_adapter_that_is_unplugged_for_no_time_that_can_be_seen_is_another_pty_all_the_same() {
    begin --clock stepped
    fault unplugged duration=1ms after=1ms
    exits 0 "$RKMCTL" --control "$folder/bus.control" advance 10ms
    same "" "$(timeout "$limit" head -c 1 <&3 2>"$folder/hung" | od -An -v -tx1)" "a client that was there"
    exec 3>&-
    soon "the link comes back" back
    exec 3<>"$folder/bus"
    dialogue 3 "$unknown" "$answer" "the new pty"
}

tcp_port() { sed -n 's/^READY .*"tcp":"127.0.0.1:\([0-9]*\)".*/\1/p' "$folder/bus.out"; }

test_clients_over_tcp_are_hung_up_when_the_adapter_is_unplugged() {
    serve bus --tcp 0
    exec 3<>"/dev/tcp/127.0.0.1/$(tcp_port)"
    dialogue 3 "$unknown" "$answer" "before"
    fault unplugged
    same "" "$(timeout "$limit" head -c 1 <&3 2>"$folder/hung" | od -An -v -tx1)" "the client"
    exec 3<>"/dev/tcp/127.0.0.1/$(tcp_port)"
    same "" "$(timeout "$limit" head -c 1 <&3 2>"$folder/hung" | od -An -v -tx1)" "another client"
    clear
    exec 3<>"/dev/tcp/127.0.0.1/$(tcp_port)"
    dialogue 3 "$unknown" "$answer" "afterwards"
}

test_a_write_to_flash_fails() {
    begin
    exits 0 ctl bus set 'W5'
    fault flash count=1
    exits 1 ctl bus store
    exits 0 ctl bus store
}

test_power_lost_in_the_middle_of_a_write_to_flash_leaves_the_old_program() {
    begin --flash "$folder/flash"
    exits 0 ctl bus set '\ W5'
    exits 0 ctl bus store
    exits 0 ctl bus set '\ W6 W7'
    fault power operation=2
    unanswered store
    exits 3 ctl bus --timeout 300 version
    same False "$(state_of "['powered']")" "power"
    exits 0 "$RKMCTL" --control "$folder/bus.control" power on
    exits 0 ctl bus -m 1 command
    holds "$said" "W5" "what was in flash before"
}

test_an_input_is_stuck() {
    begin
    fault input input=3 level=1
    same 4 "$(state_of "['di']")" "the inputs"
    exits 0 "$RKMCTL" --control "$folder/bus.control" di 3=0
    same 4 "$(state_of "['di']")" "the inputs, set by hand"
    clear
    same 0 "$(state_of "['di']")" "the inputs afterwards"
}

test_a_session_with_faults_is_the_same_when_it_is_replayed() {
    local i
    serve bus --node 1,2 --clock max --seed 11 --record "$folder/record"
    fault drop probability=0.02
    fault wrong_fcs probability=0.5
    fault delay delay=7ms probability=0.5
    fault unplugged after=100s duration=1s
    for i in 1 2 1 2 1 2; do
        ctl bus -n "$i" --timeout 300 version >"$folder/said" 2>"$folder/complained"
    done
    fault power unit=2 operation=3 duration=2s
    ctl bus -n 2 -m 1 --timeout 300 set 'W5' >"$folder/said" 2>"$folder/complained"
    ctl bus -n 2 -m 1 --timeout 300 store >"$folder/said" 2>"$folder/complained"
    clear
    kill "$started"
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/record"
}

test_every_example_of_the_document_is_so() {
    python3 "$here/control_examples.py" "$here/../../docs/FAULTS.md" >"$folder/examples" 2>&1 ||
        fail "$(grep -v '^ok' "$folder/examples")"
}

test_units_that_answer_one_another_for_ever_are_cut_off_and_it_is_told() {
    serve bus --framing plain --node 1,1 --baud 0
    exits 0 "$RKMCTL" -c "$folder/bus.control" -u 1-2 fault inject delay delay=10 count=1
    exits 0 ctl bus --framing plain version
    soon "it is told" grep -q 's in all: stopped' "$folder/bus.err"
    exits 0 "$RKMCTL" -c "$folder/bus.control" fault clear
    exits 0 ctl bus --framing plain version
}

run_cases "$@"
