#!/bin/bash
# SPDX-License-Identifier: MIT
# The conformance kit finds out which readings a unit has, with a control socket, over the wire alone, and with a hand's help.

. "$(dirname "$0")/lib.sh"

kit=$(cd "$(dirname "$0")/../.." && pwd)/tools/conformance
for python in python3 /usr/bin/python3 none; do # a python3 of one's own does not know the packages of the system
    "$python" -c 'import serial' 2>/dev/null && break
done
if [[ $python == none ]]; then
    skip_all "there is no pyserial; apt-get install python3-serial"
fi

# finds OPTIONS...: what the kit says of the unit on $folder/bus.
finds() {
    exits 0 "$python" "$kit" --port "$folder/bus" --timeout 10000 --readings "$@"
}

stop() {
    kill "$started"
    status_of "$started"
}

# every_other_value SET...: each set of readings is found out, through the control socket.
every_set() {
    local set
    for set in "$@"; do
        serve bus --readings "$set"
        finds --has control
        same "--readings $set" "$(tail -n 1 <<<"$said")" "the last line"
        [[ $said != *"not known"* ]] || fail "something is not known: $said"
        stop
    done
}

test_each_name_is_found_out() {
    every_set label=fault fault-exit=new hold-exit=latch x-after=once guard-start=step v-alone=first y-eleventh=y \
        reset-t41=clear negative-position=no
}

test_each_time_is_found_out_to_the_ms() {
    every_set speed-change=1ms speed-change=2000ms planning=1ms planning=2000ms input-filter=1ms input-filter=100ms \
        store-time=1ms store-time=1000ms
}

test_all_of_them_at_once_are_found_out() {
    local set=label=fault,fault-exit=new,hold-exit=latch,x-after=once,guard-start=step,v-alone=first,y-eleventh=y
    set+=,reset-t41=clear,negative-position=no,speed-change=700ms,planning=33ms,input-filter=12ms,store-time=150ms
    every_set "$set"
    serve bus --readings "$set" --framing plain
    finds --has control --framing plain
    same "--readings $set" "$(tail -n 1 <<<"$said")" "the last line, with framing plain"
}

test_a_unit_with_the_defaults_has_no_option() {
    serve bus
    finds --has control
    same "all that could be found out are at their defaults" "$(tail -n 1 <<<"$said")" "the last line"
    same 13 "$(grep -cE '^[a-z0-9-]+ +[a-z0-9]+$' <<<"$said")" "readings"
}

test_over_the_wire_alone_what_it_cannot_know_is_said() {
    local set=label=fault,fault-exit=new,hold-exit=latch,guard-start=step,v-alone=first,y-eleventh=y,negative-position=no
    set+=,speed-change=2000ms,planning=33ms
    serve bus --no-control --clock x3 --readings "$set,x-after=once,reset-t41=clear,input-filter=5"
    finds --speed 3
    same "--readings $set" "$(tail -n 1 <<<"$said")" "the last line"
    holds "$said" "x-after            not known: needs an input that is 1" "what is not known"
    holds "$said" "reset-t41          not known: needs somebody who looks at output 01" "what is not known"
    holds "$said" "input-filter       not known: needs inputs that are set at a known time" "what is not known"
    holds "$said" "store-time         not known: stored programs are lost" "what is not known"
}

test_no_motor_turns_with_no_motion() {
    serve bus --trace "$folder/trace.jsonl"
    finds --has control --no-motion
    holds "$said" "planning           not known: moves motor 1, 2" "what is not known"
    stop
    same 0 "$(grep -c '"kind": *"step"' "$folder/trace.jsonl")" "pulses"
}

# A hand that sets inputs and looks at outputs when it is asked to.
hand() {
    local line
    while read -r -d : line; do
        line=${line##*>>> }
        if [[ $line =~ set\ input\ ([0-9]+)\ to\ ([01]) ]]; then
            "$RKMCTL" --control "$folder/bus.control" di "${BASH_REMATCH[1]}=${BASH_REMATCH[2]}" >>"$folder/hand.out"
            echo
        elif [[ $line == *"is output DO 01 on"* ]]; then
            if "$RKMCTL" --json --control "$folder/bus.control" state | grep -q '"do": *1[,}]'; then echo y; else echo n; fi
        fi 2>>"$folder/hand.err"
    done
}

test_a_hand_helps_with_inputs_and_outputs() {
    serve bus --clock x3 --readings x-after=once,reset-t41=clear
    mkfifo "$folder/asked" "$folder/done"
    hand <"$folder/asked" >"$folder/done" &
    processes+=("$!")
    "$python" "$kit" --port "$folder/bus" --timeout 10000 --speed 3 --has inputs,outputs --readings \
        >"$folder/kit.out" 2>"$folder/asked" <"$folder/done"
    same 0 "$?" "status of the kit, which said $(<"$folder/kit.out")"
    same "--readings x-after=once,reset-t41=clear" "$(tail -n 1 "$folder/kit.out")" "the last line"
}

test_wrong_usage_is_status_2() {
    exits 2 "$python" "$kit" --port x --readings --only M9
    holds "$complained" "--readings runs no case" "what is told"
    exits 2 "$python" "$kit" --port x --readings --has wings
    holds "$complained" "expected control, inputs, outputs, power, flash" "what is told"
}

test_the_kit_knows_the_readings_that_the_emulator_knows() {
    exits 0 "$RKM04" test --readings list
    same "$(sed 's/ .*//' <<<"$said")" "$(cd "$(dirname "$kit")/../tests/conformance" &&
        "$python" -B -c 'import readings; print(*readings.DEFAULTS, sep="\n")')" "the names"
}

run_cases "$@"
