#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 test: scenarios from files, what is said about them, exit status, records that can be repeated.

. "$(dirname "$0")/lib.sh"
examples=$(cd "$(dirname "$0")/../../examples" && pwd)

# Files of this test: good.yaml passes, bad.yaml fails, wrong.yaml is none.
scenarios() {
    cd "$folder" || exit 1
    printf 'name: Five steps\nsteps:\n  - set: "F5 R"\n  - wait: {motor: 1, position: 5}\n' >good.yaml
    cat >bad.yaml <<'YAML'
name: A <sixth> & "last"
steps:
  - set: "F5 R"
  - label: one more
    wait: {motor: 1, position: 6}
    within: 1s
YAML
    printf 'steps:\n  - wait: {motor: 1, position: 6}\n    withn: 1s\n' >wrong.yaml
}

test_the_manuals_examples_pass() {
    cd "$folder" || exit 1
    local file
    for example in 1 2 3 4 5 6 7 8 9; do
        [[ -f $examples/manual/9-$example.yaml ]] || fail "there is no example 9.$example"
    done
    exits 0 "$RKM04" test "$examples"/manual/*.yaml
    for file in "$examples"/manual/*.yaml; do
        holds "$said" "pass $file: 9." "the lines"
    done
    same "" "$complained" "stderr"
    same "" "$(ls | grep -v complained)" "files made"
}

test_the_set_ups_pass() {
    cd "$folder" || exit 1
    local files
    files=$(grep -l '^steps:' "$examples"/*.yaml)
    [[ -n $files ]] || fail "there are no set-ups in $examples"
    # shellcheck disable=SC2086
    exits 0 "$RKM04" test $files
}

test_a_failure_is_one_line_with_what_was_expected_seen_and_when() {
    scenarios
    exits 3 "$RKM04" test good.yaml bad.yaml
    same 3 "$(wc -l <<<"$said")" "lines"
    same "pass good.yaml: Five steps (0.049423 s)" "$(sed -n 1p <<<"$said")" "the first line"
    local line='FAIL bad.yaml:4:5: A <sixth> & "last": one more: expected motor 1 position == 6 within 1.000000 s; '
    line+='seen motor 1 position 5; at tick 1011980 (1.011980 s); recording bad.record'
    same "$line" "$(sed -n 2p <<<"$said")" "the second line"
    same "2 scenarios: 1 passed, 1 failed" "$(sed -n 3p <<<"$said")" "the third line"
}

test_the_record_of_a_failure_can_be_repeated() {
    scenarios
    mkdir kept other
    cp bad.yaml other/
    exits 3 "$RKM04" test --records kept good.yaml bad.yaml other/bad.yaml
    same "bad-2.record bad.record" "$(cd kept && echo *)" "records kept"
    holds "$said" "recording kept/bad-2.record" "the line"
    exits 0 "$RKM04" replay --trace pulses.csv kept/bad.record
    same 5 "$(grep -c ',step,' pulses.csv)" "pulses in the trace of the replay"
}

test_no_record_is_kept_of_what_passes_or_when_none_is_wanted() {
    scenarios
    exits 0 "$RKM04" test good.yaml
    exits 3 "$RKM04" test --no-records bad.yaml
    same "bad.yaml good.yaml wrong.yaml" "$(echo *.yaml *.record | sed 's/ \*.record//')" "files"
    [[ $said != *record* ]] || fail "a record is mentioned: $said"
}

test_a_record_that_cannot_be_written_is_reported() {
    scenarios
    exits 3 "$RKM04" test --records nowhere bad.yaml
    holds "$complained" "cannot write the recording nowhere/bad.record: No such file or directory" "stderr"
}

test_a_file_that_is_no_scenario_is_refused_and_nothing_is_run() {
    scenarios
    exits 2 "$RKM04" test --junit report.xml good.yaml wrong.yaml
    same "" "$said" "stdout"
    holds "$complained" "wrong.yaml:3:5: error: expected wait, at, label, unit, within or not_before, found \"withn\"" "stderr"
    [[ ! -e report.xml ]] || fail "a report has been begun"
    exits 1 "$RKM04" test good.yaml none.yaml
    holds "$complained" "cannot read none.yaml: No such file or directory" "stderr"
    exits 2 "$RKM04" test none.yaml wrong.yaml
    exits 1 "$RKM04" test "$folder"
    holds "$complained" "Is a directory" "stderr"
}

test_wrong_usage_says_what_was_expected() {
    exits 2 "$RKM04" test
    holds "$complained" "no scenario given" "stderr"
    exits 2 "$RKM04" test - -
    holds "$complained" "only once" "stderr"
    exits 2 "$RKM04" test --junit
    exits 2 "$RKM04" test --records x --no-records -
    holds "$complained" "either --records or --no-records" "stderr"
    exits 0 "$RKM04" test --help
    holds "$said" "rkm04 test homing.yaml" "the help"
    holds "$said" "Exit status: 0 all passed; 3 any failed" "the help"
}

test_a_scenario_may_come_from_standard_input() {
    scenarios
    exits 3 sh -c "'$RKM04' test --records . - <bad.yaml"
    holds "$said" "FAIL <stdin>:4:5: " "the line"
    [[ -s stdin.record ]] || fail "not a recording"
    exits 2 sh -c "echo 'steps: 5' | '$RKM04' test -"
    holds "$complained" "<stdin>:1:8: error: expected steps, a list" "stderr"
}

# Prints: tests failures errors skipped, then a line a case: name|file|message.
read_junit() {
    python3 - "$1" <<'PYTHON'
import sys
import xml.etree.ElementTree as tree

root = tree.parse(sys.argv[1]).getroot()
assert root.tag == "testsuites" and len(root) == 1 and root[0].tag == "testsuite"
print(*(root[0].get(name) for name in ("tests", "failures", "errors", "skipped")))
for case in root[0].findall("testcase"):
    failure = case.find("failure")
    assert float(case.get("time")) >= 0
    print(case.get("name"), case.get("file"), failure.get("message") if failure is not None else "-", sep="|")
PYTHON
}

test_junit_is_well_formed_whatever_the_names_are() {
    scenarios
    printf 'name: "\\x01 ]]> \\u00e9 \\uD7FF \\u2028 <&>"\nsteps:\n  - {message: "01", answer: "07 \\"<&>\\""}\n' >odd.yaml
    cp good.yaml "$(printf 'na\xffme.yaml')"
    exits 3 "$RKM04" test --junit report.xml good.yaml bad.yaml odd.yaml "$(printf 'na\xffme.yaml')"
    local lines
    lines=$(read_junit report.xml) || fail "no well-formed XML: $lines"
    same "4 2 0 0" "$(sed -n 1p <<<"$lines")" "the counts"
    same "Five steps|good.yaml|-" "$(sed -n 2p <<<"$lines")" "the first case"
    local case='A <sixth> & "last"|bad.yaml|expected motor 1 position == 6 within 1.000000 s; '
    case+='seen motor 1 position 5; at tick 1011980'
    same "$case" "$(sed -n 3p <<<"$lines")" "the second case"
    holds "$lines" ' ]]> é ' "the third case"
    holds "$lines" 'expected the answer 07 "<&>"; seen the answer 01' "the third case"
    holds "$lines" "na�me.yaml" "the fourth case"
}

test_a_report_that_cannot_be_written_is_a_failure() {
    scenarios
    exits 1 "$RKM04" test --junit nowhere/report.xml good.yaml
    holds "$complained" "cannot write nowhere/report.xml: No such file or directory" "stderr"
    same "" "$said" "stdout"
    exits 1 sh -c "'$RKM04' test good.yaml >/dev/full"
    holds "$complained" "cannot write the results: No space left on device" "stderr"
    exits 1 "$RKM04" test --junit /dev/full good.yaml
    holds "$complained" "cannot write /dev/full: No space left on device" "stderr"
}

test_results_as_json() {
    scenarios
    exits 3 "$RKM04" test --json good.yaml bad.yaml
    python3 -c 'import json, sys
all = json.load(sys.stdin)
assert (all["scenarios"], all["passed"], all["failed"]) == (2, 1, 1), all
good, bad = all["results"]
assert (good["file"], good["name"], good["result"], good["t_us"]) == ("good.yaml", "Five steps", "pass", 49423), good
assert bad["result"] == "fail" and bad["t_us"] == 1011980, bad
assert bad["failure"] == {"line": 4, "column": 5, "label": "one more", "expected": "motor 1 position == 6 within 1.000000 s",
    "seen": "motor 1 position 5", "record": "bad.record"}, bad' <<<"$said" || fail "the JSON is not as expected: $said"
}

test_the_examples_of_the_document_are_scenarios() {
    cd "$folder" || exit 1
    local file blocks=0
    python3 - "$examples/../docs/SCENARIOS.md" <<'PYTHON'
import re, sys

text = open(sys.argv[1], encoding="utf-8").read()
for number, block in enumerate(re.findall(r"^```yaml\n(.*?)^```$", text, re.M | re.S), 1):
    if not re.search("^steps:", block, re.M): # a part of one
        block = block + "steps: [advance: 1s]\n" if block.startswith("stimuli:") else "steps:\n" + block
    open(f"block-{number}.yaml", "w", encoding="utf-8").write("units: 3\n" * ("unit: 3" in block) + block)
PYTHON
    for file in block-*.yaml; do
        "$RKM04" test --no-records "$file" >"$folder/run.out" 2>"$folder/run.err"
        case $? in
            0) ;;
            3) [[ $file != block-1.yaml ]] || fail "the first one fails: $(<"$folder/run.out")" ;;
            *) fail "$file is refused" ;;
        esac
        blocks=$((blocks + 1))
    done
    ((blocks >= 3)) || fail "only $blocks blocks"
}

endless() {
    printf 'name: For ever\nsteps:\n  - set: "@1 F1000 R B1000 R J1"\n  - advance: 100000000s\n' >endless.yaml
}

test_an_interrupted_run_says_so_and_reports_what_there_is() {
    scenarios
    endless
    start run "$RKM04" test --junit report.xml good.yaml endless.yaml good.yaml
    soon "the first one has passed" grep -qs '^pass good.yaml' "$folder/run.out"
    kill -INT "$started"
    status_of "$started"
    same 1 "$status" "exit status"
    holds "$(<"$folder/run.err")" "rkm04 test: interrupted" "stderr"
    same "not run endless.yaml: For ever" "$(sed -n 2p "$folder/run.out")" "the second line"
    same "3 scenarios: 1 passed, 0 failed, 2 not run" "$(sed -n 3p "$folder/run.out")" "the last line"
    same "3 0 0 2" "$(read_junit report.xml | head -n 1)" "the counts"
}

test_a_person_who_watches_sees_how_far_it_is() {
    scenarios
    endless
    start run script -qfec "'$RKM04' test endless.yaml" /dev/null
    soon "progress is shown" grep -qs '1 of 1: For ever: .* s of the units' "$folder/run.out"
    pkill -INT -P "$started" -x rkm04 || kill -INT "$(pgrep -P "$(pgrep -P "$started")" -x rkm04)" || fail "no process"
    soon "it ends" grep -q 'interrupted' "$folder/run.out"
}

test_two_scenarios_with_one_name_are_two_tests_for_a_CI_server() {
    local file
    for file in one two; do printf 'name: the same\nsteps:\n  - set: F5 R\n' >"$folder/$file.yaml"; done
    exits 0 "$RKM04" test --no-records --junit "$folder/report.xml" "$folder/one.yaml" "$folder/two.yaml"
    for file in one two; do
        grep -qF "<testcase classname=\"$folder/$file.yaml\" name=\"the same\"" "$folder/report.xml" ||
            fail "no class for $file in $(<"$folder/report.xml")"
    done
}

test_what_is_wrong_in_a_program_has_its_place_in_the_report() {
    mkdir "$folder/programs"
    printf 'S100 V1000\nF5000 R X9\n' >"$folder/programs/wrong.rks"
    printf 'steps:\n  - program: programs/wrong.rks\n' >"$folder/file.yaml"
    printf 'steps:\n  - set: "F5 R X9"\n' >"$folder/text.yaml"
    cd "$folder" || exit 1
    exits 3 "$RKM04" test --no-records file.yaml text.yaml
    holds "$said" "programs/wrong.rks:2:9: error: expected a number 1..8 after X, found 9" "the place in the file"
    holds "$said" "TEXT:1:6: error: expected a number 1..8 after X, found 9" "the place in the text"
}

run_cases "$@"
