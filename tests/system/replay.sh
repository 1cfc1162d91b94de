#!/bin/bash
# SPDX-License-Identifier: MIT
# replay.sh: records of `rkm04 serve' and what `rkm04 replay' makes of them.
. "$(dirname "$0")/lib.sh"

# control NAME ARGUMENTS...: the client of the control socket.
control() {
    "$RKMCTL" --control "$folder/$1.control" "${@:2}" >"$folder/control.out" 2>"$folder/control.err" ||
        fail "rkmctl ${*:2}: $(<"$folder/control.err")"
}

stop() {
    kill -INT "$1"
    status_of "$1"
    same 0 "$status" "exit status of serve"
}

# A session with two units, a request in the middle of a motion, inputs and a snapshot.
session() {
    ctl bus -n 1 set 'F200 R T03' >/dev/null
    control bus snapshot before
    ctl bus -n 2 -m 4 set 'B100 R' >/dev/null
    control bus call di.set unit=1 'di={"3":1}'
    ctl bus -n 1 position >/dev/null
    soon "the motor moves" moves bus
    control bus restore before
    soon "the motor has arrived" position_is bus 1 200
}

moves() {
    [[ $(ctl "$1" position) != 'motor 1: 0' ]]
}

test_what_is_replayed_gives_the_same_traces() {
    serve bus --node 1,2 --record "$folder/a.record" --trace "$folder/a.csv" --wire "$folder/a.log" --clock x5
    session
    stop "$started"
    exits 0 "$RKM04" replay --trace "$folder/b.csv" --wire "$folder/b.log" --trace "$folder/b.vcd" "$folder/a.record"
    holds "$said" "/a.record: the same: " "the result"
    same "" "$complained" "complaints"
    cmp "$folder/a.csv" "$folder/b.csv" || fail "the traces differ"
    cmp "$folder/a.log" "$folder/b.log" || fail "the logs of the wires differ"
    [[ -s $folder/b.vcd ]] || fail "there is no VCD"
    "$RKM04" replay - <"$folder/a.record" >"$folder/said" || fail "from standard input: $(<"$folder/said")"
}

test_a_killed_process_leaves_a_usable_record() {
    serve bus --node 1,2 --record "$folder/a.record" --clock x5
    session
    kill -KILL "$started"
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/a.record"
    holds "$complained" 'no "end" line: the recording process was killed or is still running' "the note"
    head -c -5 "$folder/a.record" >"$folder/b.record"
    exits 0 "$RKM04" replay "$folder/b.record"
    holds "$complained" "the last one, is incomplete: the lines before it were replayed" "the note"
}

test_a_difference_is_named_and_the_exit_status_is_1() {
    serve bus --record "$folder/a.record" --clock x5
    ctl bus set 'F20 R' >/dev/null
    soon "the motor has arrived" position_is bus 1 20
    stop "$started"
    sed 's/"position":20,/"position":21,/' "$folder/a.record" >"$folder/b.record"
    exits 1 "$RKM04" replay "$folder/b.record"
    holds "$said" "different: unit 1, motor 1, ticks " "the result"
    holds "$said" "the last one to 21; came " "the result"
    exits 1 "$RKM04" replay --json "$folder/b.record"
    holds "$said" '"result":"different"' "the result"
    holds "$said" '"difference":{"what":"motor","unit":"1","motor":1,"from_us":' "the difference"
}

test_a_snapshot_in_a_file_goes_on_in_another_process() {
    serve bus --clock stepped --flash "$folder/a.flash"
    ctl bus set 'F500 R' >/dev/null
    ctl bus store >/dev/null
    control bus advance 400ms
    control bus snapshot file="$folder/half.record"
    local there
    there=$(ctl bus position)
    stop "$started"
    [[ $there != 'motor 1: 0' && $there != 'motor 1: 500' ]] || fail "it is not in the middle: $there"

    serve other --clock stepped --flash "$folder/b.flash" --record "$folder/other.record"
    control other restore file="$folder/half.record"
    same "$there" "$(ctl other position)" "the position"
    control other advance 10s
    same 'motor 1: 500' "$(ctl other position)" "the position at the end"
    stop "$started"
    cmp "$folder/a.flash" "$folder/b.flash" || fail "the flash has not come along"
    rm "$folder/half.record"
    exits 0 "$RKM04" replay "$folder/other.record"
    [[ ! -e $folder/half.record ]] || fail "a replay has written a file"

    serve third # with a clock that goes: time leaps to that of the file
    "$RKMCTL" --control "$folder/third.control" clock stepped >/dev/null 2>"$folder/control.err" || fail "clock"
    exits 1 "$RKMCTL" --control "$folder/third.control" restore file="$folder/half.record"
    holds "$complained" "cannot read $folder/half.record: No such file" "the refusal"
}

test_a_snapshot_of_later_takes_a_clock_that_goes_along() {
    serve bus
    ctl bus set 'F100 R' >/dev/null
    soon "the motor has arrived" position_is bus 1 100
    control bus snapshot file="$folder/later.record"
    stop "$started"
    serve other
    control other restore file="$folder/later.record"
    same 'motor 1: 100' "$(ctl other position)" "the position"
    ctl other set 'F50 R' >/dev/null
    soon "time goes on" position_is other 1 150
    stop "$started"
}

test_what_is_no_record_is_named_with_its_place() {
    printf 'hello\n' >"$folder/x.record"
    exits 2 "$RKM04" replay "$folder/x.record"
    holds "$complained" "$folder/x.record:1:1: expected a recording, which begins with" "the complaint"
    holds "$complained" "\`rkm04 serve --record FILE' makes one" "the complaint"
    exits 1 "$RKM04" replay "$folder"
    holds "$complained" "cannot read $folder: Is a directory" "the complaint"
    : >"$folder/empty.record"
    exits 2 "$RKM04" replay "$folder/empty.record"
    holds "$complained" "$folder/empty.record:1:1: expected a record" "the complaint"
    exits 1 "$RKM04" replay "$folder/nowhere.record"
    holds "$complained" "cannot read $folder/nowhere.record: No such file" "the complaint"
    exits 2 "$RKM04" replay
    exits 2 "$RKM04" replay --trace x.txt "$folder/x.record"
    holds "$complained" "expected a name that ends with .vcd, .csv or .jsonl" "the complaint"
    exits 0 "$RKM04" replay --help
    holds "$said" "Examples:" "help"
}

# A long motion, without a process that serves it so long.
long_record() {
    serve bus --clock stepped --record "$folder/long.record"
    ctl bus -m 0 set 'V16000 A60000 G+' >/dev/null
    control bus advance 60s
    stop "$started"
}

test_an_interrupt_ends_a_replay_with_whole_traces() {
    long_record
    start replay "$RKM04" replay --trace "$folder/b.csv" "$folder/long.record"
    soon "the trace grows" test -s "$folder/b.csv"
    kill -INT "$started"
    status_of "$started"
    same 1 "$status" "exit status"
    holds "$(<"$folder/replay.err")" "interrupted at tick " "what it says"
    same "" "$(tail -c 1 "$folder/b.csv")" "the end of the trace"
    exits 0 "$RKM04" replay --until 1.5s "$folder/long.record"
    holds "$said" "the same: 1.500000 s" "the result"
}

test_a_trace_that_cannot_be_written_is_a_failure() {
    serve bus --record "$folder/a.record"
    stop "$started"
    exits 1 "$RKM04" replay --trace "$folder/nowhere/x.csv" "$folder/a.record"
    holds "$complained" "cannot write $folder/nowhere/x.csv: No such file" "the complaint"
}

test_a_record_that_cannot_grow_is_reported_and_the_units_go_on() {
    start bus bash -c 'ulimit -f 4; exec "$@"' - "$RKM04" serve --link "$folder/bus" --clock max --record "$folder/bus.record"
    soon "the unit is ready" ready bus
    exits 0 ctl bus set 'L255 F10 R H E'
    soon "the full file is reported" grep -q 'cannot write .*bus.record: File too large' "$folder/bus.err"
    exits 0 ctl bus version
    kill "$started"
    status_of "$started"
    same 1 "$status" "exit status"
    same 1 "$(grep -c 'cannot write' "$folder/bus.err")" "reports"
}

run_cases "$@"
