#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 check: what is reported, in which form, with which exit status; every program of docs/CHECK.md.

. "$(dirname "$0")/lib.sh"
here=$(cd "$(dirname "$0")" && pwd)

test_every_program_of_the_pages() {
    local told
    told=$(python3 "$here/check_pages.py" "$RKM04" "$here/../../docs/CHECK.md" "$folder") || fail "$told"
}

# checked STATUS TEXT OPTIONS...: the check of a program text ends with this status; what it printed is in $said.
checked() {
    printf '%s' "$2" >"$folder/p.rks"
    cd "$folder" || exit 1
    exits "$1" "$RKM04" check "${@:3}" p.rks
}

# python CODE: what it prints about the JSON in $said.
python() {
    python3 -c "import json, sys; a = json.load(sys.stdin); $1" <<<"$said"
}

test_an_error_has_its_line_a_caret_and_a_hint() {
    checked 1 $'S100\n\tF1O0 R' --no-warn all
    same "p.rks:2:4: error: expected a number 1..8 or 80..95 after O, found 0 [bad-value]
   F1O0 R
     ^~
  hint: O is a letter; did you mean the digit 0?" "$said" "the error"
}

test_warnings_are_no_failure_unless_they_are_asked_to_be() {
    checked 0 'R'
    holds "$said" '[no-steps]' "the warning"
    checked 1 'R' --werror
    checked 0 'R' --werror --no-warn no-steps
    same "" "$said" "nothing"
    checked 0 'R J5' --werror --no-warn missing-label,no-steps
    checked 0 'R {nolint no-steps}' --werror
}

test_all_formats() {
    checked 1 'R q' --format json
    same "1 1 no-steps unknown-command" \
        "$(python 'print(a["errors"], a["warnings"], *[d["name"] for d in a["diagnostics"]])')" JSON
    checked 1 'R q' --format sarif
    same "2.1.0 no-steps warning p.rks 1 unknown-command error" "$(python '
one, two = a["runs"][0]["results"]
where = one["locations"][0]["physicalLocation"]
print(a["version"], one["ruleId"], one["level"], where["artifactLocation"]["uri"], where["region"]["startLine"],
      two["ruleId"], two["level"])')" SARIF
    checked 1 'R q' --format gcc
    same "p.rks:1:1: warning: R without steps does nothing: no F, B or G before it; F1000 R moves 1000 steps forward [-Wno-steps]
p.rks:1:3: error: expected a command, found 'q' [unknown-command]" "$said" "gcc"
    checked 1 'R q' --format github
    holds "$said" "::error file=p.rks,line=1,col=3,title=unknown-command::expected a command, found 'q'" "github"
}

test_files_with_a_motor_belong_together_others_do_not() {
    cd "$folder" || exit 1
    printf 'O80 F9999 R T81' >x.rks
    printf 'O81 F9999 R T80' >y.rks
    exits 0 "$RKM04" check x.rks y.rks
    same "" "$said" "each by itself"
    exits 0 "$RKM04" check 1=x.rks 2=y.rks
    holds "$said" "x.rks:1:1: warning: motor 1 waits for VAR 80, which motor 2 sets only after its wait for VAR 81" "together"
}

test_wrong_usage_says_what_was_expected() {
    checked 2 'R' --no-warn no-step
    holds "$complained" "unknown warning \`no-step'" "the name"
    holds "$complained" "did you mean \`no-steps'?" "the nearest"
    checked 2 'R' --format jsn
    holds "$complained" "expected text, json, sarif, github or gcc, found 'jsn'; did you mean \`json'?" "the format"
    exits 2 "$RKM04" check
    holds "$complained" "no program given" "nothing to check"
    exits 1 "$RKM04" check "$folder/none.rks"
    holds "$complained" "cannot read $folder/none.rks: No such file or directory" "a missing file"
    checked 1 'F9999 R' none.rks
    same "" "$said" "the file that is there"
}

test_a_full_disk_is_a_failure() {
    printf 'q' >"$folder/p.rks"
    "$RKM04" check "$folder/p.rks" >/dev/full 2>"$folder/complained"
    same 1 $? "exit status"
    holds "$(<"$folder/complained")" "cannot write to standard output" "the reason"
}

run_cases "$@"
