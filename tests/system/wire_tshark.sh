#!/bin/bash
# SPDX-License-Identifier: MIT
# --wire FILE.pcapng: what stock Wireshark makes of it.

. "$(dirname "$0")/lib.sh"

if ! command -v tshark >/dev/null; then
    skip_all "there is no tshark; apt-get install tshark"
fi

# look OPTIONS...: tshark on the capture file. It complains of a file that is not as it should be.
look() {
    tshark -r "$folder/bus.pcapng" "$@" 2>"$folder/tshark.err" || fail "tshark cannot read the file"
    ! grep -E -i 'cut short|malformed|corrupt|not a capture' "$folder/tshark.err" || fail "tshark complains"
}

fields() { look -T fields "${@/#/-e}"; }

# A session in both formats: a good dialogue, a refusal, a wrong FCS, a frame for no unit.
session() {
    serve bus --node 3,5 --wire "$folder/bus.pcapng" --wire "$folder/bus.log" "$@"
    exec 3<>"$folder/bus"
    dialogue 3 "7E 03 00 04 31 79 9E 7E" "7e 00 03 04 31 0a 20 20 20 20 20 20 20 20 20 30 64 f0 7e" "Get Position"
    dialogue 3 "7E 03 00 02 31 66 35 5D 49 7E" "7e 00 03 02 31 02 66 c7 3a 7e" "a wrong command"
    say_bytes 3 "7E 03 00 01 12 34 7E"
    say_bytes 3 "7E 07 00 04 31 95 EC 7E"
    soon "all has passed" grep -q 'there is no unit 7' "$folder/bus.log"
}

finish() {
    exec 3>&-
    kill "$started"
    status_of "$started"
    same 0 "$status" "exit status"
}

test_every_frame_is_a_packet_of_RTAC_serial() {
    session
    finish
    same rtacser "$(look -T fields -e frame.protocols | cut -d: -f1 | sort -u)" "the protocol"
    same "0x01 0x02 0x01 0x02 0x01 0x01" "$(echo $(fields rtacser.eventtype))" "directions"
    same "2 1 2 1 2 2" "$(echo $(fields frame.packet_flags_direction | sed 's/0x0*//'))" "directions in the flags of the packets"
    same "0 0 0 0 1 0" "$(echo $(fields frame.packet_flags_crc_error | sed 's/True/1/; s/False/0/'))" "wrong check sums"
    same "7e03000431799e7e" "$(fields data.data | head -n 1 | tr -d ':')" "bytes of the first packet"
}

# The packets have the words, bytes and times of the log.
compare_with_log() {
    # direction: message
    sed '/^#/d; s/^ *[0-9]* *[0-9]*  //; s/ | .*//; s/   */: /' "$folder/bus.log" >"$folder/log.words"
    fields frame.comment >"$folder/packet.words"
    diff "$folder/log.words" "$folder/packet.words" || fail "words differ"
    sed '/^#/d; s/.* | //; s/ //g' "$folder/bus.log" >"$folder/log.bytes"
    fields data.data | tr -d ':' | tr 'a-f' 'A-F' >"$folder/packet.bytes"
    diff "$folder/log.bytes" "$folder/packet.bytes" || fail "bytes differ"
    awk '!/^#/ { printf "%d.%06d000\n", int($1 / 1000000), $1 % 1000000 }' "$folder/bus.log" >"$folder/log.times"
    fields frame.time_epoch >"$folder/packet.times"
    diff "$folder/log.times" "$folder/packet.times" || fail "times differ"
    fields rtacser.timestamp >"$folder/rtac.times"
    diff "$folder/log.times" "$folder/rtac.times" || fail "times in the packets differ"
}

test_packets_and_lines_of_the_log_say_the_same() {
    session
    finish
    compare_with_log
}

# Frames of Modbus RTU end with a silence, not with a byte.
test_frames_that_end_with_a_silence_are_packets() {
    serve bus --device pmc-2hs --device-option face=modbus --wire "$folder/bus.pcapng" --wire "$folder/bus.log"
    exec 3<>"$folder/bus"
    dialogue 3 "01 03 04 4E 00 08 25 2B" "01 03 10 00 0a 01 90 01 90 00 32 00 0a 00 64 03 e8 1f 40 b0 16" "parameters"
    say_bytes 3 "01 03 04 4E 00 08 25 2C" # a wrong check value
    soon "the frame is logged" grep -q 'dropped' "$folder/bus.log"
    dialogue 3 "01 05 00 00 FF 00 8C 3A" "01 85 01 83 50" "an unknown function"
    finish
    same "0x01 0x02 0x01 0x01 0x02" "$(echo $(fields rtacser.eventtype))" "directions"
    same "0 0 1 0 0" "$(echo $(fields frame.packet_flags_crc_error | sed 's/True/1/; s/False/0/'))" "wrong check values"
    same "0103044e0008252b 010310000a01900190… 0103044e0008252c 01050000ff008c3a 0185018350" \
        "$(echo $(fields data.data | tr -d ':' | sed 's/^\(010310.\{12\}\).*/\1…/'))" "bytes"
    compare_with_log
}

test_a_display_filter_finds_what_was_refused_or_dropped() {
    session
    finish
    same 3 "$(look -Y 'frame.comment contains "refused" || frame.comment contains "dropped" || frame.comment contains "ignored"' |
        wc -l)" "packets found"
}

test_what_is_not_finished_at_the_end_is_a_packet_too() {
    serve bus --baud 0 --wire "$folder/bus.pcapng"
    exec 3<>"$folder/bus"
    say_bytes 3 "7E 01 00 01 99 8D 7E 7E 01 00"
    soon "the frame before has passed" captured 0x02
    finish
    same "master: unfinished" "$(fields frame.comment | tail -n 1)" "the last packet"
    same 7e0100 "$(fields data.data | tail -n 1 | tr -d ':')" "its bytes"
}

test_a_break_is_one_of_RTAC_serial_too() {
    "$RKM04" serve --link "$folder/bus" --rfc2217 127.0.0.1:0 --wire "$folder/bus.pcapng" >"$folder/bus.out" 2>"$folder/bus.err" \
        </dev/null &
    started=$!
    processes+=("$started")
    soon "unit bus is ready" ready bus
    local port
    port=$(sed -n 's/.*"rfc2217":"[^"]*:\([0-9]*\)".*/\1/p' "$folder/bus.out")
    exec 5<>"/dev/tcp/127.0.0.1/$port"
    say_bytes 5 "FF FB 2C"       # WILL COM-PORT-OPTION
    say_bytes 5 "FF FA 2C 05 05 FF F0" # SET-CONTROL: break on
    soon "the break is told" captured 0x09
    say_bytes 5 "FF FA 2C 05 06 FF F0" # off
    finish
}
captured() { look -T fields -e rtacser.eventtype | grep -qx "$1"; }

test_what_was_written_before_a_kill_can_be_read() {
    session
    kill -9 "$started"
    wait "$started" 2>/dev/null
    same 6 "$(look | wc -l)" "packets"
}

run_cases "$@"
