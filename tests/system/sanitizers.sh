#!/bin/bash
# SPDX-License-Identifier: MIT
# What a sanitizer finds in a program fails its test, also where the test expects a program that fails, or does not look at it.
. "${0%/*}/lib.sh"

: "${SANITIZED:?}"
[[ -n ${SANITIZE-} ]] || skip_all "a build without sanitizers"

test_no_status_of_a_program_is_that_of_a_sanitizer() {
    local fault
    for fault in overflow shift leak; do
        exits 99 "$SANITIZED" "$fault"
    done
    exits 0 "$SANITIZED" nothing
}

test_options_in_the_environment_keep_the_status() {
    exits 99 env ASAN_OPTIONS=quarantine_size_mb=1 UBSAN_OPTIONS=print_summary=1 "$SANITIZED" overflow
    exits 99 env ASAN_OPTIONS=quarantine_size_mb=1 UBSAN_OPTIONS=print_summary=1 "$SANITIZED" shift
}

test_programs_and_tests_have_it() {
    local program
    for program in "$RKM04" "$RKMCTL" "$RKM04_FAKE" "$BUILD"/tests/test_parse; do
        nm -D "$program" >"$folder/names"
        grep -q ' T __asan_default_options$' "$folder/names" || fail "$program: sanitizers have their own status, 1"
    done
}

test_a_process_that_no_case_looks_at_fails_its_test() {
    local cases=$folder/cases.sh
    {
        printf '. %q/lib.sh\n' "$(cd "${0%/*}" && pwd)"
        for fault in leak nothing; do
            printf 'test_%s() { start it "$SANITIZED" %s; soon "it ends" ended "$started"; }\n' "$fault" "$fault"
        done
        echo 'run_cases "$@"'
    } >"$cases"
    exits 0 bash "$cases" test_nothing
    exits 1 bash "$cases" test_leak
    holds "$said" "a sanitizer has ended" "of a leak"
    holds "$said" "LeakSanitizer" "of a leak"
}

run_cases "$@"
