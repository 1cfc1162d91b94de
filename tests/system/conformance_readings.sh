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

test_no_motor_turns_with_no_motion() {
    serve bus --trace "$folder/trace.jsonl"
    finds --has control --no-motion
    holds "$said" "planning           not known: moves motor 1, 2" "what is not known"
    stop
    same 0 "$(grep -c '"kind": *"step"' "$folder/trace.jsonl")" "pulses"
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
