#!/bin/bash
# SPDX-License-Identifier: MIT
# Restoring a file whose recording lasts long delays no client, can be given up, and has a limit.

. "$(dirname "$0")/lib.sh"

ctrl() { "$RKMCTL" --control "$folder/bus.control" "$@"; }

# long.record: four motors that never stop, for a hundred days; replaying it takes minutes.
make_long() {
    cd "$folder" || exit 1
    cat >"$folder/long.record" <<END
{"rkm04_record":1,"program":"x","nodes":[1],"framing":"hdlc","timed":true,"turnaround":521,"seed":"1","outputs":false}
{"t":0,"command":"di.set","params":{"unit":"1","mask":0}}
END
    local frame
    frame=$(python3 - 'S2000 V2000 @1 F9 R B9 R J1' <<'END'
import sys
text = b"\x00\x00\x020" + sys.argv[1].encode()
fcs = 0xffff
for byte in text:
    fcs ^= byte
    for _ in range(8):
        fcs = fcs >> 1 ^ (0x8408 if fcs & 1 else 0)
fcs ^= 0xffff
out = b"\x7e"
for byte in text + bytes([fcs & 255, fcs >> 8]):
    out += bytes([0x7d, byte ^ 0x20]) if byte in (0x7d, 0x7e) else bytes([byte])
print((out + b"\x7e").hex())
END
    )
    printf '{"t":0,"in":"%s"}\n{"t":%s,"end":true}\n' "$frame" 8640000000000 >>"$folder/long.record"
}

restoring() { start restore "$RKMCTL" --control "$folder/bus.control" restore "file=$folder/long.record"; }

# ends_soon PROCESS SIGNAL: the signal ends it before it has worked for five seconds more, whatever else this machine does.
ends_soon() {
    local times most=$(($(ps -o cputimes= -p "$1") + 5))
    kill "-$2" "$1"
    until ended "$1"; do
        times=$(ps -o cputimes= -p "$1")
        ((${times:-0} <= most)) || fail "it took long to end"
        sleep 0.02
    done
    status_of "$1"
}

# It has begun when another client's one has to wait; until then `units` is answered all the same.
test_others_are_served_while_a_file_is_restored() {
    make_long
    serve bus
    local emulator=$started i
    restoring
    for i in {1..20}; do
        exits 0 ctrl call units
        exits 0 ctl bus version
        ended "$started" && fail "the restore is over already: $(<"$folder/restore.err")"
    done
    exits 0 ctl bus set 'F10 R'
    soon "the motor has moved" position_is bus 1 10
    ends_soon "$emulator" TERM
    same 0 "$status" "exit status of serve"
    status_of "$started"
    [[ $status != 0 ]] || fail "rkmctl believes that the file was restored"
}

test_a_client_that_goes_gives_its_restore_up() {
    make_long
    serve bus
    restoring
    exits 0 ctrl call units
    kill "$started"
    exits 0 ctl bus set 'F10 R'
    soon "the motor has moved" position_is bus 1 10
    exits 0 ctrl snapshot "file=$folder/short.record"
    exits 0 ctrl restore "file=$folder/short.record"
}

test_a_restore_has_a_limit_of_real_time() {
    make_long
    serve bus
    exits 1 ctrl call restore file="$folder/long.record" timeout=300ms
    holds "$complained" 'of real time the replay has only reached' "the message"
    holds "$complained" 'us: give a longer timeout' "the message"
    exits 2 ctrl call restore file="$folder/long.record" timeout=soon
    holds "$complained" 'timeout: expected a time' "the message"
}

test_what_is_wrong_at_the_end_of_a_file_is_found_before_it_is_replayed() {
    make_long
    echo '{"t":8640000000001,"inn":"7e"}' >>"$folder/long.record"
    serve bus
    exits 1 ctrl restore "file=$folder/long.record"
    holds "$complained" 'long.record:5:1: expected a line with one of' "the message"
    sed -i 's/"nodes":\[1\]/"nodes":[1,2]/' "$folder/long.record"
    exits 1 ctrl restore "file=$folder/long.record"
    holds "$complained" 'the number of units is different' "the message"
}

test_a_scenario_restores_within_the_limit() {
    make_long
    printf '%s\n' 'steps:' "  - call: restore" "    params: {file: $folder/long.record, timeout: 300ms}" >"$folder/long.yaml"
    exits 3 "$RKM04" test "$folder/long.yaml"
    holds "$said$complained" 'give a longer timeout' "the message"
}

test_a_scenario_can_be_interrupted_while_it_restores() {
    make_long
    printf '%s\n' 'steps:' "  - call: restore" "    params: {file: $folder/long.record}" >"$folder/long.yaml"
    start scenario "$RKM04" test "$folder/long.yaml"
    until [[ $(ps -o cputimes= -p "$started") -ge 1 ]]; do
        ended "$started" && fail "it is over"
        sleep 0.02
    done
    ends_soon "$started" INT
    grep -q interrupted "$folder"/scenario.{out,err} || fail "it does not say so: $(cat "$folder"/scenario.*)"
}

run_cases "$@"
