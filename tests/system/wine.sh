#!/bin/bash
# SPDX-License-Identifier: MIT
# A COM port of Wine that leads to a unit (--wine), and a Windows program that uses it.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${PORT_CLIENT=}" "${MODEM_LINES=}"

# A folder that looks like a Wine prefix.
make_prefix() {
    mkdir -p "$folder/prefix/dosdevices"
}

com() { readlink "$folder/prefix/dosdevices/com$1"; }

test_the_port_leads_to_the_link_while_the_unit_is_there() {
    make_prefix
    serve bus --wine "$folder/prefix:COM5"
    same "$folder/bus" "$(com 5)" "COM5"
    holds "$(<"$folder/bus.err")" "dosdevices/com5 leads to the link" "the log"
    kill "$started"
    status_of "$started"
    [[ ! -L $folder/prefix/dosdevices/com5 ]] || fail "the port is still there"
}

test_further_buses_have_further_ports() {
    make_prefix
    start bus "$RKM04" serve --link "$folder/bus%l" --lines 3 --wine "$folder/prefix:com9"
    soon "the buses are ready" ready bus
    same "$folder/bus0 $folder/bus1 $folder/bus2" "$(com 9) $(com 10) $(com 11)" "the ports"
    kill "$started"
    status_of "$started"
    same "" "$(ls "$folder/prefix/dosdevices")" "ports at the end"
}

test_a_killed_unit_leaves_a_port_that_the_next_one_replaces() {
    make_prefix
    serve one --wine "$folder/prefix:COM5"
    kill -9 "$started"
    soon "the unit is dead" ended "$started"
    rm "$folder/one"
    serve two --wine "$folder/prefix:COM5"
    same "$folder/two" "$(com 5)" "COM5"
}

test_a_port_of_a_device_or_of_another_unit_is_left_alone() {
    make_prefix
    ln -s /dev/ttyNONE "$folder/prefix/dosdevices/com1"
    exits 1 "$RKM04" serve --link "$folder/bus" --wine "$folder/prefix:COM1"
    holds "$complained" "com1 leads to /dev/ttyNONE already" "the message"
    same /dev/ttyNONE "$(com 1)" "COM1"
    serve one --wine "$folder/prefix:COM5"
    exits 1 "$RKM04" serve --link "$folder/two" --wine "$folder/prefix:COM5"
    same "$folder/one" "$(com 5)" "COM5"
    echo precious >"$folder/prefix/dosdevices/com7"
    exits 1 "$RKM04" serve --link "$folder/two" --wine "$folder/prefix:COM7"
    same precious "$(<"$folder/prefix/dosdevices/com7")" "a file in the place of the port"
    [[ ! -L $folder/two ]] || fail "the refused unit has left a link"
}

test_a_port_that_is_somebody_else_s_by_now_is_not_removed() {
    make_prefix
    serve bus --wine "$folder/prefix:COM5"
    ln -sfn /dev/ttyNONE "$folder/prefix/dosdevices/com5"
    kill "$started"
    status_of "$started"
    same /dev/ttyNONE "$(com 5)" "COM5"
}

test_what_is_no_port_of_a_prefix_is_refused() {
    local wrong
    make_prefix
    for wrong in '' COM1 :COM1 "$folder/prefix:" "$folder/prefix:COM0" "$folder/prefix:COM257" "$folder/prefix:LPT1" \
        "$folder/prefix:COM1x"; do
        exits 2 "$RKM04" serve --wine "$wrong"
        holds "$complained" "--wine" "the message about '$wrong'"
    done
    exits 2 "$RKM04" serve --wine "$folder/prefix:COM1" --port /dev/null
    exits 1 "$RKM04" serve --link "$folder/bus" --wine "$folder/none:COM1"
    holds "$complained" "there is no folder $folder/none/dosdevices" "the message"
    exits 1 "$RKM04" serve --link "$folder/bus%l" --lines 2 --wine "$folder/prefix:COM256"
    holds "$complained" "no port for bus 1" "the message"
    same "" "$(ls "$folder/prefix/dosdevices")" "what is left"
}

# ---- With Wine ---------------------------------------------------------------------------------------------------------

in_wine() { wine_in "$folder/prefix" "$@" 2>"$folder/wine.err"; }

leave_wine() {
    end_wine "$folder/prefix"
    leave
}

begin_wine() {
    [[ -f $PORT_CLIENT ]] || skip_case "the programs for Windows are not built; apt-get install gcc-mingw-w64-x86-64-win32"
    has_wine || skip_case "there is no Wine; apt-get install wine64"
    trap leave_wine EXIT
    make_wine "$folder/prefix" || fail "Wine makes no prefix"
}

# passes CHECK...: all checks of the Windows program pass at the port; at once, so that Wine is started once.
passes() {
    local check
    in_wine "$PORT_CLIENT" "$port" "$@" | tr -d '\r' >"$folder/checks.err"
    for check in "$@"; do
        grep -qx "ok $check" "$folder/checks.err" || fail "$check at $port"
    done
}

# A pty carries these; what it does not carry, docs/WINDOWS.md says. One case: a prefix takes its time.
test_a_Windows_program_uses_a_unit_through_a_COM_port_of_Wine_and_over_TCP() {
    port=COM33
    begin_wine
    serve bus --tcp 0 --strict-line --wine "$folder/prefix:$port"
    passes version motion version settings other-speed timeouts gap overlapped queue break setup
    holds "$(<"$folder/checks.err")" "01.02,06.03.2009" "the version"
    [[ -n $MODEM_LINES ]] || fail "where is the library that knows modem lines?"
    export LD_PRELOAD=$MODEM_LINES
    passes lines events version
    unset LD_PRELOAD
    in_wine reg add 'HKLM\Software\Wine\Ports' /v COM1 /d "$folder/bus" /f >/dev/null || fail "reg add"
    end_wine "$folder/prefix"
    port=COM1
    passes version # Wine has made the link itself
    same "$folder/bus" "$(com 1)" "COM1"
    port=tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    passes version motion version
}

run_cases "$@"
