#!/bin/bash
# SPDX-License-Identifier: MIT
# `rkmctl.exe window' under Wine, with emulators there and here: its pages in headless Chromium, and who may come in.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/window/browser.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}"
RKMCTL_EXE=${RKM04_EXE%/*}/rkmctl.exe
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"
client=$(cd "$(dirname "$0")" && pwd)/window_client.py

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

exe() { wine_in "$prefix" "$RKMCTL_EXE" window "$@"; }

# open_window OPTION...: as in browser.sh, under Wine; $window is the process that waits for it.
open_window() {
    cd "$folder" || fail "cd"
    start window wine_in "$prefix" "$RKMCTL_EXE" window "$@"
    window=$started
    soon "the address of the window" grep -qs '^WINDOW http://' window.out
    address=$(sed -n 's/^WINDOW //p' window.out)
}

# end_window: Ctrl-C ends it within a second, without a word.
end_window() {
    local begun=${EPOCHREALTIME/./}
    pkill -INT -P "$window" || fail "the window has ended before"
    wait "$window" || fail "exit status $?"
    ((${EPOCHREALTIME/./} - begun < 1000000)) || fail "it took $((${EPOCHREALTIME/./} - begun)) us"
    same "" "$(<"$folder/window.err")" "stderr"
}

# serve_exe OPTION...: an emulator under Wine with the control file $folder/bus.control, at $port.
serve_exe() {
    cd "$folder" || fail "cd"
    start bus wine_in "$prefix" "$RKM04_EXE" serve --tcp 0 --control tcp:0 --control-file bus.control "$@"
    soon "the unit is ready" ready bus
    port=tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' bus.out)
    export WINDOW_PORT=$port
}

case_of() { exits 0 python3 "$client" "$@"; }

test_the_service_view_sends_each_message_to_a_unit_there() {
    serve_exe
    open_window -c bus.control
    browse service
    end_window
}

test_the_editor_marks_explains_formats_opens_and_saves() {
    serve_exe
    open_window
    browse editor
}

test_each_control_of_the_panel_acts_on_an_emulator_there() {
    serve_exe
    open_window -c bus.control
    browse panel
    same "" "$(find "$folder" -name 'rkm04-window-*' -empty)" "folders without files"
    end_window
    same "" "$(find "$folder" -name 'rkm04-window-*')" "folders left behind"
}

test_keys_of_a_CNC872_there_are_let_go_when_the_window_ends() {
    cd "$folder" || fail "cd"
    start bus wine_in "$prefix" "$RKM04_EXE" serve --device cnc872 --control tcp:0 --control-file bus.control
    soon "the unit is ready" ready bus
    open_window -c bus.control
    WINDOW_PID=$(pgrep -P "$window") WINDOW_SIGNAL=SIGINT browse cncend
    soon "the axis has stopped" stands
}
stands() { [[ $("$RKMCTL" -c "$folder/bus.control" call cnc.state) == *'"state":"idle"'* ]]; }

test_a_COM_port_leads_to_a_unit_here() {
    serve bus
    ln -sfn "$folder/bus" "$prefix/dosdevices/com41"
    export WINDOW_PORT=COM41
    open_window
    browse service
    case_of port "$address" COM41
    end_window
}

test_an_emulator_here_is_shown_over_TCP() {
    start bus "$RKM04" serve --tcp 0 --link "$folder/bus" --control tcp:0
    soon "the unit is ready" ready bus
    open_window -c bus.control -p "tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")"
    case_of emulator "$address"
    case_of port "$address" "tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")"
}

test_only_who_has_the_token_and_the_own_page_come_in() {
    open_window
    case_of doors "$address"
    case_of nonsense "$address" "there is no such port"
    case_of tools "$address"
    case_of limits "$address"
    end_window
}

test_the_browser_is_started_or_it_is_said_that_it_cannot_be() {
    local key='HKCR\http\shell\open\command' before
    before=$(wine_in "$prefix" reg query "$key" /ve 2>/dev/null | tr -d '\r' | sed -n 's/.*REG_SZ *//p')
    wine_in "$prefix" reg add "$key" /ve /d "cmd /c echo %1>Z:${folder//\//\\}\\opened.txt" /f >/dev/null 2>&1 || fail "reg add"
    open_window --open
    soon "the browser is started" test -s opened.txt
    same "$address" "$(tr -d '\r' <opened.txt)" "what it opens"
    end_window
    wine_in "$prefix" reg delete "$key" /f >/dev/null 2>&1 || fail "reg delete"
    open_window --open
    soon "a message" grep -q "cannot start a browser: open the address yourself" window.err
    case_of tools "$address"
    wine_in "$prefix" reg add "$key" /ve /d "$before" /f >/dev/null 2>&1 || fail "reg add"
}

test_the_COM_ports_are_listed() {
    local key='HKLM\HARDWARE\DEVICEMAP\SERIALCOMM' name
    for name in COM132 COM45 CNCB7; do
        wine_in "$prefix" reg add "$key" /v "\\Device\\$name" /d $name /f >/dev/null 2>&1 || fail "reg add"
    done
    wine_in "$prefix" reg add "$key" /v odd /t REG_DWORD /d 7 /f >/dev/null 2>&1 || fail "reg add"
    open_window
    case_of ports "$address" CNCB7 COM45 COM132
    for name in CNCB7 COM45 COM132; do wine_in "$prefix" reg delete "$key" /v "\\Device\\$name" /f >/dev/null 2>&1; done
    wine_in "$prefix" reg delete "$key" /f >/dev/null 2>&1
    case_of ports "$address"
}

test_it_ends_at_once_while_a_unit_is_awaited() {
    serve_exe
    open_window -p "$port" -c bus.control
    case_of awaits "$address"
    end_window
}

test_wrong_usage_is_refused() {
    exits 1 exe --http nonsense
    holds "$complained" "expected ADDRESS:PORT" "the message"
    exits 1 exe --http 0.0.0.0:0
    holds "$complained" "one address of this machine" "the message"
    exits 1 exe --http 192.0.2.1:0
    holds "$complained" "cannot listen at 192.0.2.1:0: address not available" "the message"
    open_window --http '[::1]:0'
    case_of tools "$address"
    exits 1 exe --http "$(sed 's|.*//||; s|/.*||' <<<"$address")"
    holds "$complained" "address already in use" "the message"
    exits 2 exe more
    holds "$complained" "rkmctl window: expected no argument, found 'more'" "the message"
    exits 2 exe --bound
    exits 2 exe --nope
    exits 2 wine_in "$prefix" "$RKMCTL_EXE" -n 1 window
    holds "$complained" "window is the first word" "the message"
}

test_help_shows_what_Windows_has() {
    local word
    exits 0 exe --help
    holds "$said" "rkmctl window -p COM3" "the examples"
    holds "$said" "ended by Ctrl-C" "the exit status"
    for word in pseudo pty /dev/ '$XDG' SIGTERM --bound socket; do
        [[ $said != *"$word"* ]] || fail "the help knows $word"
    done
}

run_cases "$@"
