#!/bin/bash
# SPDX-License-Identifier: MIT
# `rkm04.exe serve' under Wine: units for clients on Linux and for a Windows program.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}" "${PORT_CLIENT=}"
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"
tests=$(cd "$(dirname "$0")" && pwd)

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

exe() { wine_in "$prefix" "$RKM04_EXE" "$@"; }

# serve_exe NAME OPTIONS...: a unit in Wine that is ready; $started is the process that waits for it.
serve_exe() {
    cd "$folder" || fail "cd"
    start "$1" wine_in "$prefix" "$RKM04_EXE" serve --verbose "${@:2}"
    soon "unit $1 is ready" ready "$1"
}

# part NAME KEY: what READY says of the key, a text.
part() { sed -n 's/^READY .*"'"$2"'":"\([^"]*\)".*/\1/p' "$folder/$1.out"; }

# end_exe NAME: Ctrl-C ends it within a second; its exit status is in $status.
end_exe() {
    local begun=$EPOCHREALTIME took
    pkill -INT -P "$started" || fail "$1 has ended before"
    status_of "$started"
    took=$(((${EPOCHREALTIME/./} - ${begun/./}) / 1000))
    ((took < 1000)) || fail "$1 took $took ms to end"
    holds "$(<"$folder/$1.err")" "ended by Ctrl-C" "the log of $1"
}

# at PORT ARGUMENTS...: the client of this system.
at() { "$RKMCTL" -p "$1" "${@:2}"; }

is_at() { [[ $(at "$1" position 2>"$folder/ctl.err") == "motor 1: $2" ]]; }

test_clients_here_use_a_unit_there_to_the_last_step() {
    serve_exe bus --tcp 0 --rfc2217 0 --record there.record --trace there.csv --wire there.log
    port=tcp:$(part bus tcp)
    same "01.02,06.03.2009" "$(at "$port" version 2>ctl.err)" "the version"
    same "motor 1: ok" "$(at "$port" set '\C100 S100 V1000 A2000 F500 R' 2>ctl.err)" "a program"
    soon "the last step" is_at "$port" 500
    exits 0 timeout "$limit" python3 "$tests/tcp_client.py" again "${port##*:}"
    end_exe bus
    same 0 "$status" "exit status"
    exits 0 "$RKM04" replay --trace here.csv --wire here.log there.record
    holds "$said" "the same" "the recording replayed here"
    cmp here.csv there.csv || fail "the trace"
    cmp here.log there.log || fail "the log of the wires"
}

test_a_Windows_program_uses_a_unit_there() {
    [[ -f $PORT_CLIENT ]] || skip_case "the programs for Windows are not built"
    serve_exe bus --tcp 0
    port=tcp:$(part bus tcp)
    wine_in "$prefix" "$PORT_CLIENT" "$port" version motion version 2>wine.err | tr -d '\r' >checks.err
    same "2 1" "$(grep -cx 'ok version' checks.err) $(grep -cx 'ok motion' checks.err)" "its checks at $port"
    same "01.02,06.03.2009" "$(wine_in "$prefix" "${RKM04_EXE%/*}/rkmctl.exe" -p "$port" version 2>ctl.err)" "rkmctl.exe"
    end_exe bus
}

test_settings_of_an_RFC_2217_client_count() {
    serve_exe bus --rfc2217 0 --strict-line
    exec 3<>"/dev/tcp/127.0.0.1/$(part bus rfc2217 | sed 's/.*://')" || fail "connect"
    soon "the client is there" grep -q "has opened the bus" bus.err
    say_bytes 3 "fffb2c fffa2c0100002580fff0 7e01000858107e" # WILL COM-PORT, 9600 baud, a request
    soon "the log says so" grep -q "client is 9600 8N1, unit is 19200 8N1" bus.err
    exec 3>&-
    end_exe bus
}

test_all_clocks_run() {
    serve_exe fast --tcp 0 --clock max
    at "tcp:$(part fast tcp)" set '\C100 S100 V1000 A2000 F50000 R' >ctl.out 2>ctl.err || fail "set"
    soon "50000 steps" is_at "tcp:$(part fast tcp)" 50000
    end_exe fast
    serve_exe scaled --tcp 0 --clock x20
    at "tcp:$(part scaled tcp)" set '\C100 S100 V1000 A2000 F5000 R' >ctl.out 2>ctl.err || fail "set"
    soon "5000 steps" is_at "tcp:$(part scaled tcp)" 5000
    end_exe scaled
}

test_several_buses_and_servers_of_a_device() {
    serve_exe buses --tcp 0 --lines 2 --node 1,2
    for port in $(grep -o '"tcp":"[^"]*"' buses.out | sed 's/.*:"//; s/"//' | sort -u); do
        same "01.02,06.03.2009" "$(at "tcp:$port" -n 2 version 2>ctl.err)" "unit 2 at $port"
    done
    end_exe buses
    serve_exe cib --device cib --tcp 0 --service modbus-tcp=0
    exec 3<>"/dev/tcp/127.0.0.1/$(part cib modbus-tcp | sed 's/.*://')" || fail "connect"
    dialogue 3 "0001 0000 0006 01 01 0000 0001" "0001 0000 0004 01 01 01 00" "a coil"
    exec 3>&-
    end_exe cib
}

test_what_Windows_does_not_have_is_refused() {
    cd "$folder" || fail "cd"
    for option in "--link bus" "--wine x:COM1" "--ready-fd 3" "--window" "--allow-folder ." "--no-sandbox"; do
        # shellcheck disable=SC2086
        exits 2 exe serve --tcp 0 $option
        holds "$complained" "${option%% *}: not in the program for Windows" "the message about $option"
    done
    exits 2 exe serve
    holds "$complained" "expected --tcp, --rfc2217 or --port" "the message without a port"
    exits 1 exe serve --tcp 192.0.2.1:4001
    holds "$complained" "cannot listen at 192.0.2.1:4001" "the message about a strange address"
}

run_cases "$@"
