#!/bin/bash
# SPDX-License-Identifier: MIT
# Other ways to a unit: a serial device that exists already (--port), and TCP through socat.

. "$(dirname "$0")/lib.sh"

version="01.02,06.03.2009"

# A pair of ptys, as if two adapters were wired together: $folder/near and $folder/far; $pair is its process.
wire() {
    start socat socat "PTY,raw,echo=0,link=$folder/near" "PTY,raw,echo=0,link=$folder/far"
    pair=$started
    soon "the pty pair is there" test -L "$folder/near" -a -L "$folder/far"
}

serve_on_port() {
    start unit "$RKM04" serve --port "$folder/far" "$@"
    soon "the unit is ready" ready unit
}

test_a_unit_on_an_existing_pty_answers_at_its_other_end() {
    wire
    serve_on_port --clock max
    exits 0 ctl near version
    holds "$said" "$version" "over the wire"
    exits 0 ctl near -m 3 set 'F1234 R'
    soon "motor 3 has arrived" position_is near 3 1234
}

test_frames_on_an_existing_pty_are_the_same_byte_for_byte() {
    wire
    serve_on_port --framing plain
    exec 3<>"$folder/near"
    dialogue 3 "01 00 02 04 31" "01 00 0d 04 31 0a 20 20 20 20 20 20 20 20 20 30" "Get Position"
    exec 3>&-
}

test_a_unit_whose_device_goes_away_ends_with_a_message() {
    wire
    serve_on_port
    kill "$pair"
    status_of "$started"
    same 1 "$status" "exit status"
    [[ -s $folder/unit.err ]] || fail "no message"
}

test_a_device_that_does_not_exist_is_an_error() {
    exits 1 "$RKM04" serve --port "$folder/nothing"
    holds "$complained" "$folder/nothing" "the message names the device"
}

# The port that a process listens at, as /proc shows it; 0A is "listening".
listening_port() {
    local inode hex
    for inode in $(ls -l "/proc/$1/fd" 2>/dev/null | sed -n 's/.*socket:\[\([0-9]*\)\]$/\1/p'); do
        hex=$(awk -v inode="$inode" '$4 == "0A" && $10 == inode { split($2, at, ":"); print at[2] }' /proc/net/tcp)
        [[ -n $hex ]] && port=$((16#$hex)) && return
    done
    return 1
}

bridge() {
    start bridge socat -t0 TCP-LISTEN:0,bind=127.0.0.1,reuseaddr,fork "FILE:$folder/bus,raw,echo=0"
    soon "the bridge listens" listening_port "$started"
}

# by_tcp NUMBER HOST ARGUMENTS...: the client through the bridge, once for the NUMBERth time; each connection opens the pty
# anew, so wait until the one before has let go of it.
by_tcp() {
    exits 0 "$RKMCTL" -p "tcp:$2:$port" "${@:3}"
    soon "the bridge has closed the pty" closed "$1"
}

closed() {
    [[ $(grep -c 'has closed the bus' "$folder/bus.err") == "$1" ]]
}

test_the_client_reaches_a_unit_over_tcp() {
    serve bus --clock max
    bridge
    by_tcp 1 127.0.0.1 version
    holds "$said" "$version" "over TCP"
    by_tcp 2 localhost -m 4 set 'B321 R'
    soon "motor 4 has arrived" position_is bus 4 -321
}

test_a_tcp_port_where_nobody_listens_is_an_error() {
    start holder python3 -c 'import signal, socket
holder = socket.socket()
holder.bind(("127.0.0.1", 0)) # no other program gets it
print(holder.getsockname()[1], flush=True)
signal.pause()'
    soon "there is a port" test -s "$folder/holder.out"
    port=$(<"$folder/holder.out")
    exits 1 "$RKMCTL" -p "tcp:127.0.0.1:$port" version
    holds "$complained" "$port" "the message names the port"
}

run_cases "$@"
