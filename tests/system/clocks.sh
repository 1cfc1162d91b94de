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

stopped() { [[ $(ps -o stat= -p "$1") == T* ]]; }
passed() { ((${EPOCHREALTIME/[.,]/} >= until)); }

# late WHAT: how late the emulator was, in us, all its reports of that together. A busy machine makes it late, too.
late() {
    sed -n "s/.* late by \([0-9]*\)\.\([0-9]*\) s: .*$1.*/\1\2/p" "$folder/bus.err" |
        awk '{ sum += $1 * 1000 } END { print sum + 0 }'
}

was_late() { (($(late "$1") - earlier >= least)); }

# stop_it EMULATOR SECONDS WHAT: stop it for so long; it reports that it was late.
stop_it() {
    local until least=$(($2 * 1000000 - 300000)) earlier # it may have been about to sleep for a quarter of a second
    earlier=$(late "$3")
    kill -STOP "$1"
    soon "the process stands" stopped "$1"
    until=$((${EPOCHREALTIME/[.,]/} + $2 * 1000000))
    soon "$2 s have passed" passed
    kill -CONT "$1"
    soon "it is late, and does this: $3" was_late "$3"
}

test_a_process_that_was_stopped_catches_up() {
    serve bus --late catch-up
    local begun=${EPOCHREALTIME/[.,]/}
    exits 0 ctl bus set 'L255 W100 E'
    stop_it "$started" 2 "catch up"
    soon "it is where it would be" has_caught_up
}

has_caught_up() {
    local passed=$((${EPOCHREALTIME/[.,]/} - begun))
    (($(tick) >= passed))
}

# skipped_while PROGRAM WHAT: the time for which it was late is missing in the units' time. A client may wait meanwhile.
skipped_while() {
    serve bus --late skip
    local emulator=$started before after begun late lost
    [[ -z $1 ]] || exits 0 ctl bus set "$1"
    [[ $2 != wait ]] || start waiting "$RKMCTL" --control "$folder/bus.control" wait 'do8=1' --limit 100s
    exits 0 ctl bus version
    begun=${EPOCHREALTIME/[.,]/} late=$(late paused)
    before=$(tick)
    stop_it "$emulator" 2 paused
    after=$(tick)
    lost=$(($(late paused) - late))
    ((after - before <= ${EPOCHREALTIME/[.,]/} - begun - lost + 2000)) ||
        fail "time has gone on by $((after - before)) us; it was late by $lost us"
}

# One that runs; and one that sleeps for long: idle, in a dwell, while a client waits.
test_a_process_that_was_stopped_skips() { skipped_while 'L255 W100 E' ''; }

test_an_idle_process_that_was_stopped_skips() { skipped_while '' ''; }
test_a_process_that_was_stopped_in_a_dwell_skips() { skipped_while W100000 ''; }
test_a_process_that_was_stopped_while_a_client_waits_skips() { skipped_while '' wait; }

run_cases "$@"
