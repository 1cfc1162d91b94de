#!/bin/bash
# SPDX-License-Identifier: MIT
# Clocks: the same session whatever the clock does, stepped time, changes at run time, a process that was stopped.

. "$(dirname "$0")/lib.sh"

ctrl() { "$RKMCTL" --control "$folder/bus.control" "$@"; }

# A session with a program that waits for an input and for the other unit's line, on the unit of `bus`.
session() {
    exits 0 ctl bus -n 1 set '\C100 A20000 V4000 F600 R O01 T05 B200 R W3 T06'
    exits 0 ctl bus -n 2 -m 2 set 'L3 G300 W2 H E'
    exits 0 ctrl di --unit 1 1=1
    exits 0 ctl bus -n 1 -m 1 progress
    exits 1 ctl bus -n 2 set 'F0'
    [[ $1 == stepped ]] && exits 0 ctrl advance 10s
    exits 0 ctrl wait --unit 1 'do6=1' --limit 20s
    exits 0 ctrl wait --unit 2 'm2.state=idle' --limit 20s
    exits 0 ctl bus -n 2 -m 0 position
}

# What a session was under a clock is done again in virtual time: the same answers, the same trace, byte for byte.
under_clock() {
    serve bus --node 1,2 --clock "$1" --record "$folder/session.record" --trace "$folder/live.csv" --trace "$folder/live.vcd" \
        --wire "$folder/live.log"
    session "$1"
    exits 0 ctrl shutdown
    status_of "$started"
    same 0 "$status" "exit status of serve"
    exits 0 "$RKM04" replay --trace "$folder/again.csv" --trace "$folder/again.vcd" --wire "$folder/again.log" \
        "$folder/session.record"
    local kind
    for kind in csv vcd log; do
        cmp "$folder/live.$kind" "$folder/again.$kind" || fail "the .$kind of the replay differs"
    done
    grep -q ',m1,step,600$\|m1,step,600$' "$folder/live.csv" || fail "no pulses in the trace"
}

test_K3_a_session_in_real_time_is_the_same_as_in_virtual_time() { under_clock real; }
test_K3_a_session_ten_times_as_fast_is_the_same_as_in_virtual_time() { under_clock x10; }
test_K3_a_session_as_fast_as_can_be_is_the_same_as_in_virtual_time() { under_clock max; }
test_K3_a_session_in_steps_is_the_same_as_in_virtual_time() { under_clock stepped; }

# tick: where the line's time stands.
tick() { ctrl state --json | sed 's/.*"t_us": *\([0-9]*\).*/\1/'; }

test_stepped_time_is_stopped_and_requests_are_answered_at_that_instant() {
    serve bus --clock stepped
    exits 0 ctl bus set 'F100 R'
    exits 0 ctl bus position
    same "motor 1: 0" "$said" "nothing has moved"
    same 0 "$(tick)" "the time after two requests"
    exits 0 ctrl advance 2s
    same 2000000 "$(tick)" "the time after an advance"
    exits 0 ctl bus position
    same "motor 1: 100" "$said" "the motor has moved"
}

test_advance_stops_where_its_condition_holds() {
    serve bus --clock stepped
    exits 0 ctl bus set 'S1000 V1000 F100 R'
    exits 0 ctrl advance 'm1.position>=40' --limit 10s
    exits 0 ctl bus position
    same "motor 1: 40" "$said" "the position"
    exits 3 ctrl advance 'do1=1' --limit 1s
}

test_time_cannot_be_advanced_while_it_goes_by_itself() {
    serve bus
    exits 1 ctrl advance 1s
    holds "$complained" stepped "the message"
}

# Sixteen times four motors that begin a motion every few ms are too much for ten thousand times real time.
test_units_that_cannot_follow_a_fast_clock_answer_all_the_same() {
    serve bus --node 1-16 --clock x10000
    local node
    for node in {1..16}; do
        exits 0 ctl bus -n "$node" -m 0 set 'S2000 V2000 @1 F9 R J1'
    done
    exits 0 ctl bus -n 1 version
    soon "it is told" grep -q 'too slow for clock x10000 for a second' "$folder/bus.err"
    exits 0 ctrl clock real
    exits 0 ctl bus -n 16 version
}

test_the_clock_can_be_changed_while_the_units_run() {
    serve bus --clock stepped
    exits 0 ctl bus set 'F5000 R'
    exits 0 ctrl clock max
    soon "the motor has arrived" position_is bus 1 5000
    exits 0 ctrl clock stepped
    local stood
    stood=$(tick)
    exits 0 ctl bus set 'F10 R'
    same "$stood" "$(tick)" "the time stands again"
    exits 2 ctrl clock sometimes
    holds "$complained" stepped "the message"
}

# A program of dwells runs through all of virtual time in a moment.
test_virtual_time_ends_and_it_is_said() {
    serve bus --clock max --record "$folder/session.record"
    exits 0 ctl bus set '@1 W16000000 J1'
    soon "the end is told" grep -q 'virtual time has reached its end, 1000000000 s' "$folder/bus.err"
    same 1000000000000000 "$(tick)" "the time"
    exits 3 ctrl wait 'do1=1'
    exits 0 ctrl clock stepped
    exits 1 ctrl advance 1s
    holds "$complained" 'virtual time ends at 1000000000000000 us: expected at most 0 us more' "the message"
    exits 0 ctrl snapshot "file=$folder/end.record"
    exits 0 ctrl restore "file=$folder/end.record"
    exits 0 ctrl clock real
    exits 0 ctrl shutdown
    status_of "$started"
    same 0 "$status" "exit status of serve"
    exits 0 "$RKM04" replay "$folder/session.record"
}

test_no_advance_beyond_the_end_of_time() {
    serve bus --clock stepped
    exits 0 ctrl advance 999999999s
    exits 1 ctrl advance 2s
    holds "$complained" 'virtual time ends at 1000000000000000 us: expected at most 1000000 us more' "the message"
    same 999999999000000 "$(tick)" "the time"
    exits 3 ctrl advance 'do1=1' --limit 10s
    same 1000000000000000 "$(tick)" "the time"
}

stopped() { [[ $(ps -o stat= -p "$started") == T* ]]; }
passed() { ((${EPOCHREALTIME/[.,]/} >= until)); }

# A unit that runs is stopped for a second.
be_late() {
    serve bus --late "$1"
    exits 0 ctl bus set 'L255 W100 E'
    kill -STOP "$started"
    soon "the process stands" stopped
    local until=$((${EPOCHREALTIME/[.,]/} + 1500000)) begun
    begun=${EPOCHREALTIME/[.,]/}
    soon "a second and a half has passed" passed
    kill -CONT "$started"
    soon "it says so" grep -q 'late by 1\.' "$folder/bus.err"
    behind=$((${EPOCHREALTIME/[.,]/} - begun))
}

test_a_process_that_was_stopped_catches_up() {
    be_late catch-up
    grep -q 'late by .*catch up' "$folder/bus.err" || fail "it does not say what it does"
    (($(tick) >= 1400000)) || fail "it is at $(tick) us only"
}

test_a_process_that_was_stopped_skips() {
    be_late skip
    grep -q 'late by .*paused' "$folder/bus.err" || fail "it does not say what it does"
    local after
    after=$(sed -n 's/^\[ *\([0-9]*\)\.\([0-9]*\)\] late by .*/\1\2/p' "$folder/bus.err")
    ((10#$after < 1400000)) || fail "its time has gone on to $after us"
}

# One that sleeps for long: idle, in a dwell, while a client waits.
stopped_while() {
    serve bus --late skip
    [[ $1 == idle ]] || exits 0 ctl bus set "$1"
    [[ $2 == wait ]] && start waiting "$RKMCTL" --control "$folder/bus.control" wait 'do8=1' --limit 100s
    local emulator=${processes[0]} until before after
    exits 0 ctl bus version
    before=$(tick)
    kill -STOP "$emulator"
    until=$((${EPOCHREALTIME/[.,]/} + 2500000))
    soon "two seconds and a half have passed" passed
    kill -CONT "$emulator"
    soon "it says so" grep -q 'late by [12]\..*paused' "$folder/bus.err"
    after=$(tick)
    ((after - before < 2000000)) || fail "its time has gone on by $((after - before)) us"
}

test_an_idle_process_that_was_stopped_skips() { stopped_while idle ''; }
test_a_process_that_was_stopped_in_a_dwell_skips() { stopped_while W100000 ''; }
test_a_process_that_was_stopped_while_a_client_waits_skips() { stopped_while idle wait; }

run_cases "$@"
