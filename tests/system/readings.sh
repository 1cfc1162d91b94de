#!/bin/bash
# SPDX-License-Identifier: MIT
# Readings (specification section 9): the option --readings of rkm04 serve, exec and test, and where they are shown.

. "$(dirname "$0")/lib.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)

# speed.yaml depends on speed-change, still.yaml on nothing.
scenarios() {
    cd "$folder" || exit 1
    cat >speed.yaml <<'YAML'
name: Slower at once
baud: 0
steps:
  - set: 'S100 V1000 A2000 F10000 R'
  - set: 'V500'
    at: 1.5s
  - advance: 1s
  - expect: {motor: 1, position: {"<=": 2000}}
YAML
    printf 'baud: 0\nsteps:\n  - {message: "01", answer: any}\n' >still.yaml
}

test_what_is_wrong_is_answered_with_what_is_legal() {
    scenarios
    local command
    for command in "serve --no-control" exec "test speed.yaml"; do
        # shellcheck disable=SC2086
        exits 2 "$RKM04" $command --readings hold-exti=latch
        holds "$complained" "--readings: unknown reading \`hold-exti'; did you mean \`hold-exit'?" "$command"
        # shellcheck disable=SC2086
        exits 2 "$RKM04" $command --readings hold-exit=yes
        holds "$complained" "hold-exit: expected new or latch, found \`yes'" "$command"
        # shellcheck disable=SC2086
        exits 2 "$RKM04" $command --readings planning=1 --readings label=fault,planning=2
        holds "$complained" "planning is given twice" "$command"
    done
    exits 2 "$RKM04" serve --speed-change-latency 5 --readings speed-change=6
    holds "$complained" "speed-change is given twice" "stderr"
    exits 2 "$RKM04" test --strict speed.yaml
    holds "$complained" "--strict: expected --readings all or pairs with it" "stderr"
    exits 2 "$RKM04" test --readings all --readings pairs speed.yaml
    holds "$complained" "expected all or pairs once" "stderr"
}

# The rows of a table of documents: NAME|VALUES.
rows() {
    sed -n 's/^| `\([a-z0-9-]*\)` | \(`[a-z]*`, `[a-z]*`\|0 to [0-9]* ms\).*|.*/\1|\2/p' "$1" | tr -d '`'
}

test_the_documents_have_the_table_that_list_prints() {
    exits 0 "$RKM04" test --readings list
    local list
    list=$(sed -E 's/^([a-z0-9-]+) +([a-z]+, [a-z]+|0 to [0-9]+ ms) .*/\1|\2/' <<<"$said")
    same 13 "$(wc -l <<<"$list")" "readings"
    same "$list" "$(rows "$root/docs/READINGS.md")" "docs/READINGS.md"
    same "$list" "$(rows "$root/docs/SPEC.md")" "docs/SPEC.md"
    same "$list" "$(sed -n 's/\\//g; /^\.SH READINGS/,/^\.SH "EXIT/p' "$root/docs/man/rkm04.1" |
        sed -n 's/^\([a-z0-9-]*\)  *\([a-z]*, [a-z]*\|0 to [0-9]* ms\) .*/\1|\2/p')" "rkm04(1)"
}

test_serve_shows_and_records_them_and_a_replay_uses_them() {
    serve bus --readings hold-exit=latch --speed-change-latency 300 --record "$folder/bus.record" --baud 0
    holds "$(<"$folder/bus.out")" '"readings":{"hold-exit":"latch","speed-change":300}' "the READY line"
    holds "$(<"$folder/bus.err")" "readings hold-exit=latch,speed-change=300ms" "the log"
    ctl bus -m 1 set 'F10 R' >"$folder/ctl.out" 2>"$folder/ctl.err" || fail "a program is refused"
    soon "motor 1 has moved" position_is bus 1 10
    exits 0 "$RKMCTL" --control "$folder/bus.control" state
    same "readings  hold-exit=latch  speed-change=300" "$(sed -n 1p <<<"$said")" "what rkmctl state shows"
    exits 0 "$RKMCTL" --control "$folder/bus.control" call units
    holds "$(tr -d ' \n' <<<"$said")" '"readings":{"hold-exit":"latch","speed-change":300}' "units"
    kill -TERM "$started"
    status_of "$started"
    holds "$(head -n 1 "$folder/bus.record")" '"readings":{"hold-exit":"latch","speed-change":300}' "the head of the recording"
    exits 0 "$RKM04" replay "$folder/bus.record"
}

test_without_the_option_nothing_is_shown() {
    serve bus
    holds "$(<"$folder/bus.out")" '"readings":{}' "the READY line"
    [[ $(<"$folder/bus.err") != *readings* ]] || fail "the log has readings"
    exits 0 "$RKMCTL" --control "$folder/bus.control" state
    [[ $said != *readings* ]] || fail "rkmctl state has readings"
}

test_exec_runs_under_them() {
    cd "$folder" || exit 1
    printf '0s set 1 S100 V1000 A2000 F10000 R\n1500ms set 1 V500\n' >slower.stimulus
    "$RKM04" exec --stimulus slower.stimulus --trace at-once.csv >/dev/null || fail "exec fails"
    "$RKM04" exec --readings speed-change=500 --stimulus slower.stimulus --trace later.csv >/dev/null || fail "exec fails"
    local before after
    before=$(awk -F, '$1 < 2500000 && $3 == "step"' at-once.csv | wc -l)
    after=$(awk -F, '$1 < 2500000 && $3 == "step"' later.csv | wc -l)
    ((after > before + 100)) || fail "steps before 2.5 s: $before at once, $after with a delay of 500 ms"
}

test_exec_refuses_what_a_unit_with_these_readings_refuses() {
    cd "$folder" || exit 1
    printf 'F5 R\n T01 =-5 =5\n' >back.rks
    printf '0s set 1 F5 R\n1s set 1 T01 =-7\n' >back.stimulus
    exits 0 "$RKM04" exec --stimulus back.stimulus back.rks
    exits 1 "$RKM04" exec --readings negative-position=no --stimulus back.stimulus back.rks
    same "back.rks:2:6: error: expected a number from 0 on after =, found -5 (--readings negative-position=no)
back.stimulus:2:14: error: expected a number from 0 on after =, found -7 (--readings negative-position=no)" "$complained" "stderr"
}

failure() {
    echo "FAIL speed.yaml:8:5: Slower at once: expected motor 1 position <= 2000; seen motor 1 position $1; at tick 2500000" \
        "(2.500000 s)"
}

test_all_tells_on_which_readings_a_result_depends() {
    scenarios
    exits 0 "$RKM04" test --readings all speed.yaml still.yaml
    same "pass speed.yaml: Slower at once (2.500000 s)
speed.yaml: passes under 21 of 23; depends on speed-change
  speed-change=500ms: $(failure 2104)
  speed-change=2000ms: $(failure 2292)
pass still.yaml ($(sed -n 's/^pass still.yaml (\(.*\))$/\1/p' <<<"$said"))
still.yaml: passes under 23 of 23
2 scenarios: 2 passed, 0 failed; 1 depends on readings" "$said" "the report"
    same "speed.yaml still.yaml" "$(echo *.yaml *.record | sed 's/ \*.record//')" "files"
}

test_strict_makes_a_dependence_a_failure_unless_the_scenario_names_the_reading() {
    scenarios
    exits 3 "$RKM04" test --readings all --strict speed.yaml
    exits 0 "$RKM04" test --readings all --strict still.yaml
    sed -i '1a readings: {speed-change: 0}' speed.yaml
    exits 0 "$RKM04" test --readings all --strict speed.yaml
    holds "$said" "speed.yaml: passes under 20 of 20" "the report"
}

test_what_is_named_is_kept() {
    scenarios
    exits 3 "$RKM04" test --no-records --readings speed-change=500 speed.yaml
    exits 0 "$RKM04" test --readings speed-change=1,hold-exit=latch --readings all speed.yaml
    holds "$said" "speed.yaml: passes under 19 of 19" "the report"
    exits 3 "$RKM04" test --no-records --readings speed-change=500,planning=0 --readings all speed.yaml
    holds "$said" "speed.yaml: passes under 0 of 16" "the report"
    sed -i '1a readings: {speed-change: 0}' speed.yaml
    exits 0 "$RKM04" test --readings speed-change=500 speed.yaml
}

test_a_scenario_that_fails_may_pass_under_another_reading() {
    scenarios
    sed -i 's/"<=": 2000/">=": 2200/' speed.yaml
    exits 3 "$RKM04" test --no-records --readings all speed.yaml
    holds "$said" "speed.yaml: passes under 1 of 23; depends on speed-change
  speed-change=2000ms: pass speed.yaml (2.500000 s)" "the report"
}

test_pairs_are_tried_without_those_that_change_the_result_alone() {
    scenarios
    exits 0 "$RKM04" test --readings pairs speed.yaml
    holds "$said" "speed.yaml: passes under 199 of 201; depends on speed-change" "the report"
    same 4 "$(wc -l <<<"$said")" "lines"
}

test_dependences_in_json() {
    scenarios
    exits 0 "$RKM04" test --json --readings all speed.yaml still.yaml
    python3 -c 'import json, sys
all = json.load(sys.stdin)
assert (all["passed"], all["failed"], all["dependent"]) == (2, 0, 1), all
speed, still = (result["readings"] for result in all["results"])
assert (speed["runs"], speed["passed"], speed["depends_on"]) == (23, 21, ["speed-change"]), speed
first = speed["otherwise"][0]
assert (first["readings"], first["result"], first["t_us"]) == ("speed-change=500ms", "fail", 2500000), first
assert first["failure"]["line"] == 8 and "2104" in first["failure"]["seen"], first
assert still == {"runs": 23, "passed": 23, "depends_on": [], "otherwise": []}, still' <<<"$said" ||
        fail "the JSON is not as expected: $said"
    exits 0 "$RKM04" test --json still.yaml
    [[ $said != *readings* ]] || fail "readings are there that nobody asked for: $said"
}

# junit FILE: failures of the suite, then NAME|TYPE OF FAILURE|MESSAGE, and the output, of each case.
junit() {
    python3 - "$1" <<'PYTHON'
import sys
import xml.etree.ElementTree as tree

suite = tree.parse(sys.argv[1]).getroot()[0]
print(suite.get("failures"))
for case in suite.findall("testcase"):
    failure = case.find("failure")
    print(case.get("name"), failure.get("type") if failure is not None else "-",
          failure.get("message") if failure is not None else "-", sep="|")
    print(case.find("system-out").text)
PYTHON
}

test_dependences_in_junit() {
    scenarios
    exits 0 "$RKM04" test --junit report.xml --readings all speed.yaml still.yaml
    local report
    report=$(junit report.xml) || fail "no well-formed XML"
    same 0 "$(sed -n 1p <<<"$report")" "failures"
    holds "$report" "Slower at once|-|-" "the case"
    holds "$report" "readings: passes under 21 of 23; depends on speed-change
speed-change=500ms: speed.yaml:8:5: expected motor 1 position <= 2000; seen motor 1 position 2104; at tick 2500000" "the output"
    exits 3 "$RKM04" test --junit report.xml --readings all --strict speed.yaml still.yaml
    report=$(junit report.xml) || fail "no well-formed XML"
    same 1 "$(sed -n 1p <<<"$report")" "failures"
    holds "$report" "Slower at once|readings|passes under 21 of 23; depends on speed-change" "the case"
}

test_an_interrupted_run_says_how_many_runs_are_missing() {
    scenarios
    printf 'name: For ever\nsteps:\n  - set: "@1 F1000 R B1000 R J1"\n  - advance: 3000s\n' >long.yaml
    start run "$RKM04" test --readings all long.yaml
    soon "the first run is over" grep -qs '^pass long.yaml' "$folder/run.out"
    kill -INT "$started"
    status_of "$started"
    same 1 "$status" "exit status"
    holds "$(<"$folder/run.out")" " not run" "the line"
}

run_cases "$@"
