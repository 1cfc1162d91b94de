#!/bin/bash
# SPDX-License-Identifier: MIT
# A reader of the log, or of READY, that is slow, stopped or gone: the cases are in unread.py.

. "$(dirname "$0")/lib.sh"

for case in $(python3 "$(dirname "$0")/unread.py" --list); do
    eval "test_$case() { python3 '$(dirname "$0")/unread.py' $case >\"\$folder/case.err\" 2>&1 || fail $case; }"
done

run_cases "$@"
