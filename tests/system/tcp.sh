#!/bin/bash
# SPDX-License-Identifier: MIT
# The line over TCP: where it listens, who gets in, what is left when one ends.

. "$(dirname "$0")/lib.sh"

version="01.02,06.03.2009"

# serve_tcp OPTIONS...: a unit that is reached over TCP alone; $address is where.
serve_tcp() {
    start bus "$RKM04" serve --verbose "$@"
    soon "the unit is ready" ready bus
    address=$(sed -n 's/^READY .*"\(tcp\|rfc2217\)":"\([^"]*\)".*/\2/p' "$folder/bus.out")
}

# connect: descriptor 3 is a connection to the unit.
connect() {
    exec 3<>"/dev/tcp/${address%:*}/${address##*:}" || fail "cannot connect to $address"
}

logged() {
    [[ $(grep -c "$1" "$folder/bus.err") == "$2" ]]
}

test_port_0_is_a_free_one_of_this_machine() {
    serve_tcp --tcp 0
    [[ $address =~ ^127\.0\.0\.1:[1-9][0-9]*$ ]] || fail "the address: '$address'"
    holds "$(<"$folder/bus.out")" '"pty":null' "there is no pty"
    exits 0 "$RKMCTL" -p "tcp:$address" version
    holds "$said" "$version" "over TCP"
}

test_the_client_may_close_and_connect_again_at_will() {
    local i
    serve_tcp --tcp localhost:0
    for i in 1 2 3 4 5; do
        exits 0 "$RKMCTL" -p "tcp:$address" version
        holds "$said" "$version" "time $i"
    done
}

test_an_IPv6_address_is_in_brackets() {
    [[ -e /proc/net/if_inet6 ]] && grep -q '^0*1 ' /proc/net/if_inet6 || return 0 # this machine has none
    serve_tcp --tcp '[::1]:0'
    [[ $address =~ ^\[::1\]:[1-9][0-9]*$ ]] || fail "the address: '$address'"
    exits 0 "$RKMCTL" -p "tcp:$address" version
    holds "$said" "$version" "over IPv6"
}

test_pty_and_TCP_reach_the_same_unit() {
    serve bus --tcp 127.0.0.1:0 --clock max
    address=$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    exits 0 ctl bus -m 2 set 'F500 R'
    soon "the motor has arrived" position_is bus 2 500
    exits 0 "$RKMCTL" -p "tcp:$address" -m 2 position
    same "motor 2: 500" "$said" "over TCP"
}

# under_silent_resolver COMMAND...: on a system whose name server never answers; $folder/asked is there once it has been asked.
under_silent_resolver() {
    [[ -e $folder/shim.so ]] || ${CC:-cc} -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -shared -fPIC -o "$folder/shim.so" \
        "$(dirname "$0")/resolver_shim.c" -ldl || fail "the shim cannot be compiled"
    exec env --default-signal RESOLVER_SHIM="$folder/asked" LD_PRELOAD="$folder/shim.so" \
        ASAN_OPTIONS=verify_asan_link_order=0 "$@"
}

test_a_signal_ends_the_emulator_while_the_name_server_is_silent() {
    local option signal
    for option in tcp rfc2217; do
        for signal in TERM INT HUP; do
            start bus under_silent_resolver "$RKM04" serve --link "$folder/link" --$option unit.example:0
            soon "the name server is asked" test -e "$folder/asked"
            kill -$signal "$started"
            status_of "$started"
            same $((128 + $(kill -l "$signal"))) "$status" "--$option: exit status after SIG$signal"
            same "" "$(find "$folder" -name 'link*')" "what --$option leaves behind"
            rm "$folder/asked"
        done
    done
}

test_the_client_waits_for_a_name_server_as_long_as_for_an_answer() {
    exits 1 under_silent_resolver timeout "$limit" "$RKMCTL" --timeout 200 -p tcp:unit.example:4000 version
    holds "$complained" "cannot find tcp:unit.example:4000: the name server does not answer" "the message"
    [[ -e $folder/asked ]] || fail "the name server was not asked"
}

test_digits_need_no_name_server() {
    start bus under_silent_resolver "$RKM04" serve --tcp 127.0.0.1:0 --rfc2217 0
    soon "the unit is ready" ready bus
    address=$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    exits 0 "$RKMCTL" -p "tcp:$address" version
    [[ ! -e $folder/asked ]] || fail "the name server was asked"
}

test_an_address_that_is_none_is_wrong_usage() {
    local wrong
    for wrong in '' 4000x 65536 ::1 localhost '[::1]' 1:2:3; do
        exits 2 "$RKM04" serve --tcp "$wrong"
        holds "$complained" "HOST:PORT" "what was expected instead of '$wrong'"
        exits 2 "$RKM04" serve --rfc2217 "$wrong"
    done
}

test_an_address_in_use_is_a_failure() {
    serve_tcp --tcp 0
    exits 1 "$RKM04" serve --tcp "$address"
    holds "$complained" "$address" "the message"
    holds "$complained" "another program listens there" "the message"
    exits 0 "$RKMCTL" -p "tcp:$address" version
}

test_a_host_that_is_not_here_is_a_failure() {
    exits 1 "$RKM04" serve --tcp 192.0.2.1:0
    holds "$complained" 192.0.2.1 "the message"
}

test_a_client_that_is_killed_leaves_the_line_to_the_next() {
    local kind
    for kind in tcp rfc2217; do
        serve_tcp --$kind 0
        start client bash -c "exec 3<>/dev/tcp/127.0.0.1/${address##*:}; read -rd '' <&3"
        soon "the client is there" logged 'has opened the bus' 1
        kill -KILL "$started"
        status_of "$started" 2>/dev/null
        soon "the client has gone" logged 'has closed the bus' 1
        connect
        soon "the next is there" logged 'has opened the bus' 2
        exec 3>&-
    done
}

test_a_client_is_told_that_the_emulator_has_ended() {
    local unit
    serve_tcp --tcp 0
    unit=$started
    connect
    soon "the client is there" logged 'has opened the bus' 1
    kill "$unit"
    same "" "$(hear_bytes 3 1)" "the end of the connection"
    exec 3>&-
}

test_frames_over_TCP_are_the_same_byte_for_byte() {
    serve_tcp --tcp 0
    connect
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "an unknown message"
    exec 3>&-
}

test_RFC_2217_doubles_FF_and_acknowledges_settings() {
    serve_tcp --rfc2217 0
    connect
    dialogue 3 "" "fffb00 fffd00 fffb03 fffd2c" "what the server wants"
    dialogue 3 "fffb2c" "fffa2c6bb0fff0" "COM-PORT-OPTION is agreed"
    dialogue 3 "fffa2c 01 00004b00 fff0" "fffa2c 65 00004b00 fff0" "19200 baud"
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff ff 08 00 00 db ff ff 7e" "an unknown message"
    exec 3>&-
}

test_random_bytes_do_no_harm() {
    local kind
    for kind in tcp rfc2217; do
        serve_tcp --$kind 0 --baud 0
        head -c 300000 /dev/urandom | timeout "$limit" socat -u - "TCP:$address" || fail "$kind: cannot send"
        soon "the client has gone" logged 'has closed the bus' 1
        connect
        soon "the next is there" logged 'has opened the bus' 2
        exec 3>&-
    done
}

# A broadcast, or so much that the units have not received half of it; then the same client comes again at once.
test_a_client_that_comes_again_at_once_is_served() {
    serve_tcp --tcp 0
    exits 0 timeout 200 python3 "$(dirname "$0")/tcp_client.py" again "${address##*:}"
    holds "$(<"$folder/bus.err")" "bytes that it had sent were dropped" "the log"
    same 0 "$(grep -c 'was refused: another' "$folder/bus.err")" "clients sent away"
}

# serve_occupied: a unit with pty and TCP whose pty has a client, as descriptor 3.
serve_occupied() {
    serve bus --tcp 127.0.0.1:0
    address=$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    exec 3<>"$folder/bus"
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "the client of the pty"
}

test_a_refused_client_reads_why() {
    local node
    serve_occupied
    for node in 1 0; do
        exits 1 "$RKMCTL" -p "tcp:$address" -n "$node" set 'F1 R'
        holds "$complained" "refused: the bus is in use by a client of the pty" "the message, unit $node"
    done
}

test_clients_without_number_do_not_fill_the_log() {
    serve_occupied
    exits 0 timeout 200 python3 "$(dirname "$0")/tcp_client.py" refused "${address##*:}"
    same 100 "$(grep -c 'was refused: another' "$folder/bus.err")" "lines of the log"
}

run_cases "$@"
