#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 fmt: files changed in place, what is shown instead, what stays as it is.

. "$(dirname "$0")/lib.sh"

test_a_file_is_changed_in_place_and_only_once() {
    local first
    cd "$folder" || exit 1
    printf 'F 0100 R {go} W5' >p.rks
    chmod 640 p.rks
    ln -s p.rks link.rks
    exits 0 "$RKM04" fmt link.rks
    same "" "$said$complained" "silence"
    same $'F100 R {go}\nW5' "$(<p.rks)" "the text"
    same 640 "$(stat -c %a p.rks)" "the mode"
    [[ -L link.rks ]] || fail "the link has become a file"
    first=$(stat -c %i p.rks)
    exits 0 "$RKM04" fmt p.rks
    same "$first" "$(stat -c %i p.rks)" "a file that is laid out already"
    same "complained link.rks p.rks" "$(echo *)" "files left"
}

test_check_and_diff_change_nothing() {
    cd "$folder" || exit 1
    printf 'F100 R\n' >good.rks
    printf 'F 100 R' >bad.rks
    exits 1 "$RKM04" fmt --check good.rks bad.rks
    same "bad.rks would change" "$said" "--check"
    exits 0 "$RKM04" fmt --check good.rks
    exits 0 "$RKM04" fmt --diff good.rks bad.rks
    holds "$said" $'--- bad.rks\n+++ bad.rks (formatted)' "the names"
    holds "$said" $'-F 100 R' "the line before"
    holds "$said" $'\n+F100 R' "the line behind"
    same 'F 100 R' "$(<bad.rks)" "the file"
}

test_standard_input_goes_to_standard_output() {
    same $'L2\n    F5 R\nE' "$(printf 'L2 F5 R E' | "$RKM04" fmt -)" "the text"
    same "1" "$(printf 'L2 F5 R E' | "$RKM04" fmt --json - | python3 -c 'import json,sys; print(len(json.load(sys.stdin)))')" JSON
}

test_a_text_with_an_error_stays() {
    cd "$folder" || exit 1
    printf 'F100 r' >p.rks
    exits 1 "$RKM04" fmt p.rks
    holds "$complained" "p.rks:1:6: error: expected a command, found 'r'; commands are capital letters: R" "the error"
    same 'F100 r' "$(<p.rks)" "the file"
}

test_what_cannot_be_written_is_a_failure() {
    exits 1 "$RKM04" fmt "$folder"
    exits 1 "$RKM04" fmt /dev/null/p.rks
    printf 'F 5 R' | "$RKM04" fmt - >/dev/full 2>"$folder/complained"
    same 1 "${PIPESTATUS[1]}" "exit status"
}

run_cases "$@"
