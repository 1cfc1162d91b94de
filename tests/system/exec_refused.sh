#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 exec: wrong texts, files and options, each with its place and what was expected; nothing is run then.

. "$(dirname "$0")/lib.sh"

# refused STATUS COMPLAINT ARGUMENTS...: the run does not begin; stderr has the complaint in it, stdout is empty.
refused() {
    cd "$folder" || exit 1
    exits "$1" "$RKM04" exec "${@:3}"
    holds "$complained" "$2" "stderr of '${*:3}'"
    same "" "$said" "stdout of '${*:3}'"
}

test_P1_every_error_of_a_text_is_a_line_with_its_place() {
    printf 'F1000 R\nV16001 { too fast } R\nI01X5 q\n' >"$folder/bad.rks"
    refused 1 "" --json --trace run.csv bad.rks
    same 3 "$(grep -c '^bad.rks:[0-9]*:[0-9]*: error: ' <<<"$complained")" "lines of errors in '$complained'"
    holds "$complained" "bad.rks:2:" "the speed"
    holds "$complained" "16000" "what was expected"
    holds "$complained" "bad.rks:3:" "the jump"
    holds "$complained" "bad.rks:3:7: error: " "the unknown command"
    [[ ! -e $folder/run.csv ]] || fail "a trace has been begun"
}

test_every_refused_file_is_reported() {
    printf 'x' >"$folder/a.rks"
    printf '\n  y' >"$folder/b.rks"
    printf '1s di 9 1\n2s set 1 F1 R z\n' >"$folder/in.txt"
    refused 1 "a.rks:1:1: error: " a.rks 2=b.rks none.rks --stimulus in.txt
    holds "$complained" "b.rks:2:3: error: " "the second file"
    holds "$complained" "cannot read none.rks: No such file or directory" "the missing file"
    holds "$complained" "in.txt:1:7: error: expected an input 01 to 08, found '9'" "the stimulus"
    holds "$complained" "in.txt:2:15: error: " "the text in the stimulus"
}

test_a_text_in_the_stimulus_is_reported_at_its_place() {
    printf '# first\n\n5ms   set 2   F1000 R V0\n' >"$folder/in.txt"
    refused 1 "in.txt:3:23: error: " --stimulus in.txt
    same 1 "$(grep -c error: <<<"$complained")" "lines of errors in '$complained'"
}

test_what_cannot_be_read_is_a_failure() {
    refused 1 "cannot read $folder: Is a directory" "$folder"
    refused 1 "cannot read none.rks: No such file" none.rks
    refused 1 "cannot read none.txt: No such file" --stimulus none.txt
}

test_a_text_from_standard_input_is_named_so() {
    exits 1 sh -c "printf 'R ?' | '$RKM04' exec -"
    holds "$complained" "<stdin>:1:3: error: " "stderr"
}

test_wrong_usage_says_what_was_expected() {
    printf 'R' >"$folder/run.rks"
    refused 2 "no program given"
    refused 2 "expected a motor 1 to 4, or 0 for all" 5=run.rks
    refused 2 "expected a time with its unit" --until 5 run.rks
    refused 2 "at most 3 digits" --until 0.0001ms run.rks
    refused 2 "standard output" --json --trace - run.rks
    refused 2 "only once" - 2=-
    refused 2 "only once" --stimulus - -
    refused 2 "unrecognized option" --frobnicate run.rks
    refused 2 "requires an argument" run.rks --until
}

test_help_shows_the_stimulus_the_trace_and_the_exit_status() {
    exits 0 "$RKM04" exec --help
    holds "$said" "TIME message HEX" "the stimulus"
    holds "$said" "t_us,source,event,value" "the trace"
    holds "$said" "--until was reached with a motor still running" "the exit status"
    holds "$said" "rkm04 exec 1=x.rks 2=y.rks --until 10s --trace run.csv" "an example"
}

run_cases "$@"
