#!/bin/bash
# SPDX-License-Identifier: MIT
# Several units on one line: each has its own address, state and flash; all receive everything (U4, L1, L3).

. "$(dirname "$0")/lib.sh"

version="01.02,06.03.2009"

test_U4_the_ready_line_names_all_units() {
    serve bus --node 1,2,5-8
    local line
    line=$(grep '^READY ' "$folder/bus.out")
    holds "$line" '"nodes":[1,2,5,6,7,8]' "the units"
    holds "$line" '"node":1,' "the first unit"
}

test_U4_every_unit_answers_to_its_own_address_and_nobody_to_others() {
    local node
    serve bus --node 1,2,5-8
    for node in 1 2 5 6 7 8; do
        exits 0 ctl bus -n "$node" version
        same "$version" "$said" "unit $node"
    done
    exits 3 ctl bus -n 3 --timeout 300 version
}

test_U4_sixteen_units_are_polled_in_turn() {
    local node round
    serve bus --node 1-16
    for round in 1 2; do
        for node in {1..16}; do
            exits 0 ctl bus -n "$node" -m 4 position
            same "motor 4: 0" "$said" "round $round, unit $node"
        done
    done
    kill "$started"
    status_of "$started"
    grep -q 'requests 32, answers 32, frames dropped 0, bytes dropped 0, collisions 0, framing errors 0, overruns 0' \
        "$folder/bus.err" || fail "the units were disturbed by one another: $(tail -n 1 "$folder/bus.err")"
}

test_L3_a_broadcast_is_obeyed_by_all_and_answered_by_none() {
    local node
    serve bus --node 1-16 --clock max
    exec 3<>"$folder/bus"
    # Set Command, motor 2, "F70 R", to node 0; then Get Position of unit 9: the first byte that comes is of its answer.
    say_bytes 3 "$(frame 00 00 02 32 46 37 30 20 52)"
    say_bytes 3 "$(frame 09 00 04 32)"
    same 7e0009 "$(hear_bytes 3 3)" "the first answer"
    exec 3>&-
    for node in {1..16}; do
        soon "motor 2 of unit $node has arrived" at_70 "$node"
    done
}

at_70() { [[ $(ctl bus -n "$1" -m 2 position) == "motor 2: 70" ]]; }

# frame BYTE...: an hdlc frame (hex) of bytes that need no escape.
frame() {
    local crc=65535 byte bit
    for byte in "$@"; do
        ((crc ^= 16#$byte))
        for bit in 1 2 3 4 5 6 7 8; do
            ((crc = crc & 1 ? (crc >> 1) ^ 16#8408 : crc >> 1))
        done
    done
    ((crc ^= 65535))
    printf '7e%s%02x%02x7e' "$(printf %s "$@")" $((crc & 255)) $((crc >> 8))
}

test_each_unit_has_its_own_motors_and_program() {
    serve bus --node 3,4 --clock max
    exits 0 ctl bus -n 3 set 'F500 R'
    exits 0 ctl bus -n 4 set 'B20 R'
    soon "unit 3 has arrived" stands 3 500
    soon "unit 4 has arrived" stands 4 -20
    exits 0 ctl bus -n 4 command
    holds "$said" "B20 R" "the program of unit 4"
}

stands() { [[ $(ctl bus -n "$1" -m 1 position) == "motor 1: $2" ]]; }

test_U5_each_unit_has_its_own_flash_image() {
    serve bus --node 3,4,4 --clock max --flash "$folder/unit%n.flash"
    exits 0 ctl bus -n 3 set '\ C100 F30 R'
    exits 0 ctl bus -n 3 store
    kill "$started"
    status_of "$started"
    [[ -s $folder/unit3.flash && -s $folder/unit4.flash && -s $folder/unit4-2.flash ]] || fail "images: $(ls "$folder")"
    serve alone --node 3 --clock max --flash "$folder/unit3.flash"
    soon "the stored program has run by itself" position_is_of_3
}

position_is_of_3() { [[ $(ctl alone -n 3 -m 1 position) == "motor 1: 30" ]]; }

test_each_unit_has_its_own_power_switch() {
    local control=(--control "$folder/bus.control")
    serve bus --node 1,2 --clock max
    exits 0 ctl bus -n 1 set '\ C100 F10 R'
    exits 0 ctl bus -n 1 store
    exits 0 ctl bus -n 1 set '=5000'
    exits 0 "$RKMCTL" "${control[@]}" --unit 1 power off
    soon "unit 1 is off" told "unit 1: power off"
    exits 3 ctl bus -n 1 --timeout 300 version
    exits 0 ctl bus -n 2 version
    exits 0 "$RKMCTL" "${control[@]}" --unit 1 power on
    soon "unit 1 has run what its flash holds" stands 1 10
    exits 2 "$RKMCTL" "${control[@]}" --unit 9 power off
    holds "$complained" "expected one of 1, 2" "the message"
    exits 0 ctl bus -n 2 version
}

told() { grep -q -F "$1" "$folder/bus.err"; }

test_two_units_with_the_same_address_answer_at_once_and_spoil_it() {
    # Two images make the two differ: the first one has gone 111 steps, the second 22222.
    serve bus --node 5 --clock max --flash "$folder/unit5.flash"
    exits 0 ctl bus -n 5 set '\ C100 F111 R'
    exits 0 ctl bus -n 5 store
    kill "$started"
    status_of "$started"
    serve bus --node 5 --clock max --flash "$folder/unit5-2.flash"
    exits 0 ctl bus -n 5 set '\ C100 F22222 R'
    exits 0 ctl bus -n 5 store
    kill "$started"
    status_of "$started"
    serve bus --node 5,5 --clock x20 --flash "$folder/unit%n.flash"
    exits 0 "$RKMCTL" -c "$folder/bus.control" -u 5 wait m1.position=111
    exits 0 "$RKMCTL" -c "$folder/bus.control" -u 5-2 wait m1.position=22222
    exec 3<>"$folder/bus"
    say_bytes 3 "$(frame 05 00 04 31)"
    # The answer is received as the AND of both: 111 is blanks (20) where 22222 has 2 (32), so 20; 1 (31) AND 2 (32) is 0 (30).
    holds "$(hear_bytes 3 18)" 7e000504310a20202020202020303030 "the two positions collide"
    exec 3>&-
    exits 3 ctl bus -n 5 -m 1 --timeout 500 position
    kill "$started"
    status_of "$started"
    ! grep -q 'collisions 0,' "$folder/bus.err" || fail "no collision counted: $(tail -n 1 "$folder/bus.err")"
}

test_a_request_into_an_answer_spoils_both() {
    serve bus --node 1,2 --clock x0.05 # the answer takes half a second: time enough, however busy the machine is
    exec 3<>"$folder/bus"
    # Get Position of all motors of unit 1, then, while its 52 bytes go out, Version of unit 2.
    say_bytes 3 "$(frame 01 00 04 30)"
    hear_bytes 3 4 >"$folder/begin"
    say_bytes 3 "$(frame 02 00 01)"
    exec 3>&-
    soon "the line is as before" answers 1
    kill "$started"
    status_of "$started"
    ! grep -q 'collisions 0,' "$folder/bus.err" || fail "no collision counted: $(tail -n 1 "$folder/bus.err")"
}

answers() { [[ $(ctl bus -n "$1" version 2>&1) == "$version" ]]; }

test_turnaround_delays_every_answer() {
    local start took
    serve bus --turnaround 200000
    start=${EPOCHREALTIME/[.,]/}
    exits 0 ctl bus version
    took=$((${EPOCHREALTIME/[.,]/} - start))
    ((took >= 200000)) || fail "an answer after $took us"
}

test_many_lines_have_their_own_links_units_and_images() {
    start many "$RKM04" serve --lines 3 --node 1,2 --link "$folder/bus%l" --flash "$folder/line%l-unit%n" --clock max
    soon "the lines are ready" ready many
    exits 0 ctl bus2 -n 2 set 'F40 R'
    soon "unit 2 of line 2 has arrived" on_line 2 40
    on_line 1 0 || fail "unit 2 of line 1 has moved: $(ctl bus1 -n 2 -m 1 position)"
    same 6 "$(ls "$folder" | grep -c '^line[012]-unit[12]$')" "flash images"
    holds "$(grep '^READY ' "$folder/many.out")" "\"link\":\"$folder/bus2\"" "the links in the READY line"
    kill "$started"
    status_of "$started"
    same "" "$(ls "$folder" | grep '^bus')" "links left behind"
}

on_line() { [[ $(ctl "bus$1" -n 2 -m 1 position) == "motor 1: $2" ]]; }

test_many_lines_by_default_are_bus0_bus1_and_so_on() {
    XDG_RUNTIME_DIR=$folder start many "$RKM04" serve --lines 200 --node 1-16
    soon "the lines are ready" ready many
    exits 0 "$RKMCTL" -p "$folder/rkm04/bus199" -n 16 version
}

run_cases "$@"
