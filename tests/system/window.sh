#!/bin/bash
# SPDX-License-Identifier: MIT
# The window: who may come in, limits, the port, the program tools, start and end. Its pages are tested by window_browser.sh.

. "$(dirname "$0")/lib.sh"
[[ -n ${RKM04_WINDOW-} ]] || skip_all "built without the window"
client=$(cd "$(dirname "$0")" && pwd)/window_client.py

# open_window OPTION...: starts it; $address is what it prints, $window its process.
open_window() {
    start window "$RKMCTL" window "$@"
    window=$started
    soon "the address of the window" grep -qs '^WINDOW http://' "$folder/window.out"
    address=$(sed -n 's/^WINDOW //p' "$folder/window.out")
}

case_of() { exits 0 python3 "$client" "$@"; }

test_only_who_has_the_token_and_the_own_page_come_in() {
    open_window
    [[ $address =~ ^http://127\.0\.0\.1:[0-9]+/\?token=[0-9a-f]{32}$ ]] || fail "the address is $address"
    case_of doors "$address"
}

test_too_much_ends_one_page_only() {
    open_window
    case_of limits "$address"
}

test_nonsense_is_refused_with_a_reason() {
    open_window
    case_of nonsense "$address"
}

test_a_port_is_opened_asked_and_stopped() {
    serve bus
    open_window
    case_of port "$address" "$folder/bus"
}

test_a_port_over_tcp_is_opened_asked_and_stopped() {
    start bus "$RKM04" serve --tcp 0 --link "$folder/bus"
    soon "the unit is ready" ready bus
    open_window
    case_of port "$address" "tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")"
}

test_files_of_an_emulator_named_by_a_short_path_are_downloaded_and_removed() {
    serve bus
    cd "$folder" || fail "cd"
    open_window -c bus.control
    case_of files "$address"
    kill -TERM $window
    wait $window || fail "exit status $?"
    same "" "$(find "$folder" -name 'rkm04-window-*')" "folders left behind"
}

test_the_program_tools_answer() {
    open_window
    case_of tools "$address"
}

# The best of ten counts: this machine may have other work.
test_sigterm_ends_it_within_a_second() {
    local begun took
    serve bus
    for _ in {1..10}; do
        open_window -p "$folder/bus" -c "$folder/bus.control"
        begun=${EPOCHREALTIME/[.,]/}
        kill -TERM $window
        wait $window || fail "exit status $?"
        took=$((${EPOCHREALTIME/[.,]/} - begun))
        same "" "$(<"$folder/window.err")" "stderr"
        ((took < 1000000)) && return
    done
    fail "it took $took us"
}

test_serve_shows_its_units_and_ends_the_window() {
    start serve "$RKM04" serve --link "$folder/bus" --window
    local emulator=$started
    soon "the address of the window" grep -qs '^WINDOW http://' "$folder/serve.out"
    same "READY WINDOW" "$(sed 's/ .*//' "$folder/serve.out" | xargs)" "lines on stdout"
    address=$(sed -n 's/^WINDOW //p' "$folder/serve.out")
    case_of doors "$address"
    case_of emulator "$address"
    kill -KILL $emulator
    wait $emulator
    soon "the window has ended" refuses "$address"
    exits 2 "$RKM04" serve --link "$folder/other" --window --no-control
}

refuses() { ! python3 "$client" tools "$1" 2>/dev/null; }

test_the_environment_says_how_long_an_answer_is_waited_for() {
    serve bus
    export RKM04_TIMEOUT=203
    open_window -p "$folder/bus"
    case_of timeout "$address"
    exits 2 env RKM04_TIMEOUT=60001 "$RKMCTL" window
    holds "$complained" "RKM04_TIMEOUT: expected a number 1 to 60000" "the message"
}

test_wrong_usage_is_told() {
    exits 1 "$RKMCTL" window --http nonsense
    holds "$complained" "expected ADDRESS:PORT" "the message"
    exits 1 "$RKMCTL" window --http 0.0.0.0:0
    holds "$complained" "one address of this machine" "the message"
    exits 1 "$RKMCTL" window --http 192.0.2.1:0
    holds "$complained" "cannot listen" "the message"
    exits 2 "$RKMCTL" window more
    exits 2 "$RKMCTL" -n 1 window
    holds "$complained" "window is the first word" "the message"
}

run_cases "$@"
