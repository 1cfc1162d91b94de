#!/bin/bash
# SPDX-License-Identifier: MIT
# What the window's page costs, in headless Chromium: size, time, memory.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/window/browser.sh"

test_the_page_is_small() { drive size; }
test_the_page_is_quickly_there() { drive load; }
test_stop_all_answers_within_100_ms() { drive stop; }
test_memory_stays_the_same() {
    export ASAN_OPTIONS=${ASAN_OPTIONS+$ASAN_OPTIONS:}quarantine_size_mb=1 # what is freed does not stay
    start bus "$RKM04" serve --link "$folder/bus" --clock x100
    export EMULATOR_PID=$started
    soon "the unit is ready" ready bus
    exits 0 "$RKMCTL" -p "$folder/bus" -n 0 -m 0 set '\ C100 S200 V4000 A8000 @1 F9000 R W100 B9000 R J1'
    drive_with memory "$folder/bus.control"
}
test_curves_of_sixteen_units_are_drawn_smoothly() {
    serve bus --node 1-16
    exits 0 "$RKMCTL" -p "$folder/bus" -n 0 -m 0 set '\ C100 S200 V4000 A8000 L20 F90000 R B90000 R E'
    drive_with frames "$folder/bus.control"
}

run_cases "$@"
