#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 serve --plant: counter and true position side by side, what is wrong with a plant file, what happens to a plant in
# traces, records and snapshots.

. "$(dirname "$0")/lib.sh"
examples=$(cd "$(dirname "$0")/../../examples" && pwd)

# emulator PLANT OPTIONS...: a unit with a stepped clock and that plant of the examples.
emulator() {
    serve bus --clock stepped --plant "$examples/$1.plant.yaml" "${@:2}"
    export RKM04_CONTROL=$folder/bus.control
}

# `told`: position and true position of motor 1 as the control socket has them.
told() {
    exits 0 "$RKMCTL" --json state
    python3 -c 'import json, sys; motor = json.load(sys.stdin)["motors"][0]; print(motor["position"], motor["true_position"])' \
        <<<"$said"
}

# homed: the linear axis has homed at its switch; counter and true position agree.
homed() {
    exits 0 ctl bus set '\ S800 (01 F40 R S100 (01 C100'
    exits 0 "$RKMCTL" advance 15s
    same "0 0" "$(told)" "counter and true position at home"
}

test_state_shows_counter_and_true_position_side_by_side() {
    emulator linear-axis
    same "0 7345" "$(told)" "counter and true position at power-up"
    homed
    exits 0 "$RKMCTL" state
    holds "$said" "true" "the state for people"
}

test_a_plant_is_off_unless_asked_for() {
    serve bus --clock stepped
    export RKM04_CONTROL=$folder/bus.control
    same "0 None" "$(told)" "counter and true position"
}

test_a_plant_file_that_is_wrong_is_refused_with_line_and_column() {
    printf 'motors:\n  1: {offset: 5}\nswitches:\n  - {input: 9, motor: 1, at_most: 0}\n' >"$folder/wrong.yaml"
    exits 1 "$RKM04" serve --link "$folder/bus" --plant "$folder/wrong.yaml"
    holds "$complained" "$folder/wrong.yaml:4:13: error: expected an input, a whole number 1..8, found 9" "stderr"
    exits 1 "$RKM04" serve --link "$folder/bus" --plant "$folder/none.yaml"
    holds "$complained" "none.yaml: No such file or directory" "stderr"
    printf 'motors: {1: \xff}\n' >"$folder/wrong.yaml"
    exits 1 "$RKM04" serve --link "$folder/bus" --plant "$folder/wrong.yaml"
    holds "$complained" "expected text in UTF-8" "stderr"
}

test_a_trace_tells_of_lost_steps() {
    emulator linear-axis --trace "$folder/events.jsonl"
    homed
    exits 0 ctl bus set 'V3000 A8000 F22000 R'
    exits 0 "$RKMCTL" advance 15s
    same "22000 21500" "$(told)" "counter and true position at the end stop"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    same 0 "$status" "exit status"
    holds "$(grep '"kind":"plant"' "$folder/events.jsonl")" "motor 1 runs against its end stop at 21500" "the trace"
}

test_a_record_with_a_plant_can_be_repeated() {
    emulator turntable --record "$folder/session.record"
    exits 0 ctl bus set 'S300 )03 F5 R C100'
    exits 0 "$RKMCTL" advance 7s
    same "0 3200" "$(told)" "counter and true position at the index mark"
    exits 0 "$RKMCTL" plant motor=1 position=70
    exits 0 "$RKMCTL" plant motor=1 jammed=true
    exits 0 ctl bus set 'F10 R'
    exits 0 "$RKMCTL" advance 1s
    same "10 70" "$(told)" "counter and true position after a hand was there"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/session.record"
}

test_a_snapshot_has_the_plant_in_it() {
    emulator linear-axis
    exits 0 ctl bus set 'S800 (01 F40 R S100 (01 C100'
    exits 0 "$RKMCTL" advance 2s
    local then
    then=$(told)
    exits 0 "$RKMCTL" snapshot before
    exits 0 "$RKMCTL" advance 15s
    same "0 0" "$(told)" "counter and true position at home"
    exits 0 "$RKMCTL" restore before
    same "$then" "$(told)" "counter and true position when it is back"
    exits 0 "$RKMCTL" advance 15s
    same "0 0" "$(told)" "counter and true position at home again"
    exits 0 "$RKMCTL" snapshot "file=$folder/home.snapshot"
    exits 0 "$RKMCTL" plant none
    same "0 None" "$(told)" "counter and true position without a plant"
    exits 0 "$RKMCTL" restore "file=$folder/home.snapshot"
    same "0 0" "$(told)" "counter and true position when it is back from the file"
    exits 0 ctl bus set 'F5 R'
    exits 0 "$RKMCTL" advance 1s
    same "5 5" "$(told)" "counter and true position after five more steps"
}

test_the_examples_of_the_document_are_plants() {
    cd "$folder" || exit 1
    local file blocks=0
    python3 - "$examples/../docs/PLANT.md" <<'PYTHON'
import re, sys

text = open(sys.argv[1], encoding="utf-8").read()
for number, block in enumerate(re.findall(r"^```yaml\n(.*?)^```$", text, re.M | re.S), 1):
    open(f"block-{number}.yaml", "w", encoding="utf-8").write(block)
    units = "units: 3,5\n" if "units:" in block else ""
    open(f"run-{number}.yaml", "w", encoding="utf-8").write(f"{units}plant: block-{number}.yaml\nsteps: [advance: 1s]\n")
PYTHON
    for file in run-*.yaml; do
        exits 0 "$RKM04" test "$file"
        blocks=$((blocks + 1))
    done
    same 3 "$blocks" "plants in the document"
}

run_cases "$@"
