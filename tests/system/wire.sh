#!/bin/bash
# SPDX-License-Identifier: MIT
# --wire FILE.log: what passes on the wires, for people, while it passes.

. "$(dirname "$0")/lib.sh"

# A request or an answer stands in the log of the unit, with everything before the bytes.
logged() { grep -qF "$1 | " "$folder/bus.log"; }

# The lines of the log without times and heads.
told() { sed '/^#/d; s/^ *[0-9]* *[0-9]*  //; s/ | .*//' "$folder/bus.log"; }

test_a_dialogue_can_be_followed_while_it_lasts() {
    serve bus --wire "$folder/bus.log"
    exits 0 ctl bus -m 1 set '\C100 F50 R'
    soon "the answer is in the log" logged "1 > master      2 Set Command m1 -> flag 0"
    soon "the motor has arrived" position_is bus 1 50
    same 'master > 1      2 Set Command m1 "\C100 F50 R"
1 > master      2 Set Command m1 -> flag 0' "$(told | head -n 2)" "the log"
    holds "$(head -n 1 "$folder/bus.log")" "hdlc, 19200 baud, unit 1" "the first line"
    holds "$(told)" "4 Get Position m1 -> 50" "the log"
}

test_refusals_and_what_was_dropped_are_in_it_with_the_reason() {
    serve bus --node 3,5 --wire "$folder/bus.log"
    exec 3<>"$folder/bus"
    say_bytes 3 "7E 03 00 02 31 66 35 5D 49 7E" # f5
    same 7e000302310266c73a7e "$(hear_bytes 3 10)" "the answer"
    say_bytes 3 "7E 03 00 01 12 34 7E"
    say_bytes 3 "7E 07 00 04 31 95 EC 7E"
    say_bytes 3 "7E 03 00 7D 7E"
    soon "the last frame is in the log" logged "dropped: aborted"
    same 'master > 3      2 Set Command m1 "f5"
3 > master      2 Set Command m1 -> flag 2 '\''f'\''; refused: unknown command '\''f'\''
master          dropped: wrong FCS
master > 7      4 Get Position m1; ignored: there is no unit 7
master          dropped: aborted' "$(told)" "the log"
}

test_the_times_are_those_of_the_line() {
    serve bus --wire "$folder/bus.log"
    exits 0 ctl bus version
    # Seven bytes of ten bits, a turnaround of 521 us, 24 bytes; the start of an answer is rounded down to a microsecond.
    awk '/1 Version \|/ { from = $1; to = $2 }
        /1 Version ->/ { print (to - from >= 3645 && to - from <= 3647), ($1 - to >= 519 && $1 - to <= 522),
            ($2 - $1 >= 12500 && $2 - $1 <= 12502) }' "$folder/bus.log" >"$folder/times"
    same "1 1 1" "$(<"$folder/times")" "lengths of request, turnaround and answer"
}

test_power_of_the_units_is_told() {
    serve bus --node 3 --wire "$folder/bus.log"
    exits 0 "$RKMCTL" --control "$folder/bus.control" power off
    soon "the power is in the log" grep -q -- '-- unit 3: power off$' "$folder/bus.log"
}

test_faults_that_have_acted_explain_what_is_seen() {
    serve bus --node 3 --wire "$folder/bus.log"
    exits 0 "$RKMCTL" --control "$folder/bus.control" fault inject wrong_fcs count=1
    until grep -q 'dropped: wrong FCS' "$folder/bus.log"; do # a busy machine may let it wait until its client has given up
        exits 3 ctl bus -n 3 --timeout 200 position
    done
    told >"$folder/told"
    holds "$(<"$folder/told")" "
-- fault 1: wrong_fcs: " "the log, before the answer"
    same "3               dropped: wrong FCS" "$(tail -n 1 "$folder/told")" "the answer"
}

test_K1_a_replay_writes_the_same_files() {
    serve bus --node 3,5 --record "$folder/bus.record" --wire "$folder/bus.log" --wire "$folder/bus.pcapng"
    exits 0 ctl bus -n 3 set 'F500 R'
    exits 1 ctl bus -n 5 set 'F500 x'
    exits 0 ctl bus -n 3 position
    kill "$started"
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/bus.record" --wire "$folder/again.log" --wire "$folder/again.pcapng"
    cmp "$folder/bus.log" "$folder/again.log" || fail "logs differ"
    cmp "$folder/bus.pcapng" "$folder/again.pcapng" || fail "capture files differ"
    same 6 "$(told | wc -l)" "frames"
}

test_the_framing_plain_is_told_too() {
    serve bus --framing plain --node 2 --wire "$folder/bus.log"
    exec 3<>"$folder/bus"
    dialogue 3 "02 00 02 04 31" "02 00 0d 04 31 0a 20 20 20 20 20 20 20 20 20 30" "Get Position"
    say_bytes 3 "02 00 00"
    soon "the wrong length is in the log" logged "dropped: impossible length"
    holds "$(told)" "2 > master      4 Get Position m1 -> 0" "the log"
}

test_every_line_has_its_own_file() {
    serve bus%l --lines 2 --wire "$folder/bus%l.log"
    exits 0 ctl bus1 version
    soon "the answer is in the log of line 1" grep -q '1 Version -> ' "$folder/bus1.log"
    same 2 "$(wc -l <"$folder/bus0.log")" "lines of the log of line 0, the head"
}

test_a_wrong_name_is_a_usage_error_and_a_wrong_folder_a_failure() {
    exits 2 "$RKM04" serve --link "$folder/bus" --wire "$folder/bus.txt"
    holds "$complained" ".log or .pcapng" "what was expected"
    exits 1 "$RKM04" serve --link "$folder/bus" --wire "$folder/none/bus.log"
    holds "$complained" "cannot write $folder/none/bus.log" "the reason"
}

test_a_full_disk_is_told_and_the_unit_goes_on() {
    ln -s /dev/full "$folder/bus.log"
    serve bus --wire "$folder/bus.log"
    exits 0 ctl bus version
    soon "the full disk is told" grep -q "cannot write $folder/bus.log: No space left" "$folder/bus.err"
    exits 0 ctl bus version
    kill "$started"
    status_of "$started"
    same 1 "$status" "exit status"
}

run_cases "$@"
