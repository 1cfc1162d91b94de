#!/bin/bash
# SPDX-License-Identifier: MIT
# A serial device with RS485 (--port, --rts). There is none on a test machine: serial_shim.c makes a pty look like one.

. "$(dirname "$0")/lib.sh"
: "${CC:=cc}"

request="7e 01 00 08 58 10 7e"
answer="7e 00 01 ff 08 00 00 db ff 7e"

# device OPTIONS...: units on one end of a pty pair that looks like a device; the other end is open as 3.
device() {
    $CC -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -shared -fPIC -o "$folder/shim.so" "$(dirname "$0")/serial_shim.c" -ldl ||
        fail "the shim cannot be compiled"
    start bridge socat "pty,rawer,link=$folder/one" "pty,rawer,link=$folder/other"
    soon "the pair is there" test -e "$folder/other"
    exec 3<>"$folder/other"
    : >"$folder/asked"
    SHIM_LOG=$folder/asked LD_PRELOAD=$folder/shim.so ASAN_OPTIONS=verify_asan_link_order=0 \
        start bus "$RKM04" serve --allow-folder "$folder" --port "$folder/one" "$@"
    soon "the unit is ready" ready bus
}

asked() { same "$1" "$(tr '\n' ' ' <"$folder/asked")" "$2"; }

test_the_drivers_own_RS485_mode_is_used_and_given_back() {
    SHIM_RS485=1 device
    asked "rs485_on " "at the start"
    dialogue 3 "$request" "$answer" "a request"
    kill "$started"
    status_of "$started"
    asked "rs485_on rs485_off " "at the end"
}

test_a_driver_without_RS485_mode_is_reported() {
    device
    dialogue 3 "$request" "$answer" "a request"
    holds "$(<"$folder/bus.err")" "no RS485 mode" "the log"
}

test_rts_toggles_around_every_answer() {
    device --rts toggles
    asked "rts_off " "at the start"
    dialogue 3 "$request" "$answer" "a request"
    soon "RTS is off again" is_off 2
    asked "rts_off rts_on rts_off " "after one answer"
    dialogue 3 "$request" "$answer" "one more"
    soon "RTS is off again" is_off 3
    asked "rts_off rts_on rts_off rts_on rts_off " "after two answers"
}

is_off() { [[ $(grep -c rts_off "$folder/asked") == "$1" ]]; }

test_turnaround_is_kept_on_a_device_too() {
    device --turnaround 150000
    local start=${EPOCHREALTIME/[.,]/} took
    dialogue 3 "$request" "$answer" "a request"
    took=$((${EPOCHREALTIME/[.,]/} - start))
    ((took >= 150000)) || fail "an answer after $took us"
}

run_cases "$@"
