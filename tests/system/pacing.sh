#!/bin/bash
# SPDX-License-Identifier: MIT
# 19200 baud, 10 bits a byte, in both directions (U7, --baud).

. "$(dirname "$0")/lib.sh"

# A dialogue of a full program memory: about 1400 bytes there and 1400 back; in plain, a byte of text is a byte on the line.
text=$(printf "D%.0s" {1..699}) # and a [ before it
bytes=$((3 + 2 + 700 + 3 + 4 + 3 + 2 + 3 + 2 + 1399)) # request, answer, request, answer

# Microseconds that storing and reading the program takes.
talk() {
    local start=${EPOCHREALTIME/[.,]/}
    exits 0 ctl bus --framing plain --timeout 20000 set "[$text"
    exits 0 ctl bus --framing plain --timeout 20000 command
    took=$((${EPOCHREALTIME/[.,]/} - start))
}

test_U7_bytes_take_their_time_at_19200_baud() {
    serve bus --framing plain
    talk
    local least=$((bytes * 10 * 1000000 / 19200))
    ((took >= least)) || fail "$bytes bytes took $took us, on a line they take $least us"
}

test_U7_the_default_is_19200_baud_and_0_is_as_fast_as_can_be() {
    serve bus --framing plain --baud 0
    talk
    local least=$((bytes * 10 * 1000000 / 19200))
    ((took < least)) || fail "$bytes bytes took $took us without pacing, as long as at 19200 baud"
}

run_cases "$@"
