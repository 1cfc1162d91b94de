#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 lsp with a real client, pygls, from the virtual environment of the Python tests; and what it does without one.

. "$(dirname "$0")/lib.sh"

root=$(cd "$(dirname "$0")/../.." && pwd)
build=${BUILD-${TMPDIR-/tmp}}
python=$(sed -n 's/^Python_EXECUTABLE:.*=\|^_Python_EXECUTABLE:.*=//p' "$build/CMakeCache.txt" 2>/dev/null | head -n 1)
reason=$("$root/tools/python-env" "$build/python-env" "${python:-python3}")
status=$?
((status == 0 || status == 77)) || { echo "$reason"; exit 1; }
"$build/python-env/bin/python" -c 'import pygls' 2>/dev/null || reason="skipped: pygls needs Python 3.10 or later"

# with_pygls CASE: a case of the client.
with_pygls() {
    [[ -z $reason ]] || skip_case "${reason#skipped: }"
    exits 0 "$build/python-env/bin/python" -B "$root/tests/system/lsp_client.py" "$1" "$RKM04"
}

test_diagnostics_follow_edits() { with_pygls diagnostics_follow_edits; }
test_labels() { with_pygls labels; }
test_hover_lens_and_layout() { with_pygls hover_lens_and_layout; }
test_completion_has_ranges() { with_pygls completion_has_ranges; }
test_a_fast_typist() { with_pygls a_fast_typist; }
test_czech() { with_pygls czech; }

# message TEXT: a frame.
message() {
    printf 'Content-Length: %d\r\n\r\n%s' "${#1}" "$1"
}

test_an_editor_that_is_gone_ends_the_server() {
    exits 1 "$RKM04" lsp
    same "" "$said$complained" "silence"
    status=$({ message '{"id":1,"method":"initialize"}'; message '{"id":2,"method":"shutdown"}'; message '{"method":"exit"}'; } |
        "$RKM04" lsp >/dev/null; echo $?)
    same 0 "$status" "an orderly end"
    status=$({ message '{"id":1,"method":"initialize"}'; message '{"method":"exit"}'; } | "$RKM04" lsp >/dev/null; echo $?)
    same 1 "$status" "an end without shutdown"
}

test_what_is_no_message_is_said() {
    exits 1 bash -c 'echo hello | "$1" lsp' - "$RKM04"
    exits 1 bash -c 'printf "hello\r\n\r\n" | "$1" lsp' - "$RKM04"
    holds "$complained" "rkm04 lsp: expected a message with a header Content-Length on standard input" "the reason"
}

test_an_answer_that_cannot_be_written_is_said() {
    status=$(message '{"id":1,"method":"initialize"}' | "$RKM04" lsp 2>"$folder/complained" >/dev/full; echo $?)
    same 1 "$status" "exit status"
    holds "$(<"$folder/complained")" "cannot write to standard output" "the reason"
}

test_sigterm_ends_it() {
    mkfifo "$folder/in"
    start lsp bash -c 'exec "$1" lsp <"$2"' - "$RKM04" "$folder/in"
    exec 7>"$folder/in"
    kill -TERM "$started"
    soon "the end" ended "$started"
    exec 7>&-
}

test_wrong_usage_is_said() {
    exits 2 "$RKM04" lsp file.rks
    holds "$complained" "expected no argument, found \`file.rks'" "an argument"
    exits 2 "$RKM04" lsp --lang de
    exits 2 "$RKM04" lsp --no-warn unused-labels
    holds "$complained" "did you mean \`unused-label'?" "a slip"
}

run_cases "$@"
