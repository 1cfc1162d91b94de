#!/bin/bash
# SPDX-License-Identifier: MIT
# Host software with pyserial (python3-serial) on each way to the line: pty, socket:// (raw TCP), rfc2217://.

. "$(dirname "$0")/lib.sh"

client=$(dirname "$0")/pyserial_client.py
ways="pty socket rfc2217"

for python in python3 /usr/bin/python3 none; do # a python3 of one's own does not know the packages of the system
    "$python" -c 'import serial.rfc2217' 2>/dev/null && break
done
if [[ $python == none ]]; then
    skip_all "there is no pyserial; apt-get install python3-serial"
fi

# serve_all OPTIONS...: a unit with plain frames, to be reached in every way.
serve_all() {
    serve bus --framing plain --tcp 127.0.0.1:0 --rfc2217 127.0.0.1:0 "$@"
}

# url WAY: where pyserial finds it.
url() {
    case $1 in
        pty) echo "$folder/bus" ;;
        socket) echo "socket://$(ready_value bus tcp)" ;;
        rfc2217) echo "rfc2217://$(ready_value bus rfc2217)?timeout=30" ;; # for its settings
    esac
}

# ready_value NAME KEY: a text of its READY line.
ready_value() {
    sed -n 's/^READY .*"'"$2"'":"\([^"]*\)".*/\1/p' "$folder/$1.out"
}

# py STATUS WHAT WAY
py() {
    exits "$1" "$python" -W ignore "$client" "$2" "$(url "$3")"
    soon "nobody has the line" nobody_has_the_line
}

nobody_has_the_line() {
    local opened closed
    opened=$(grep -c 'has opened the bus' "$folder/bus.err")
    closed=$(grep -c 'has closed the bus' "$folder/bus.err")
    ((opened == closed))
}

test_pyserial_opens_talks_closes_and_opens_again() {
    local way
    serve_all
    for way in $ways; do py 0 talk "$way"; done
}

test_pyserial_forgets_what_has_come_in() {
    local way
    serve_all --baud 0
    for way in $ways; do py 0 reset "$way"; done
}

test_clients_that_keep_others_out_come_and_go_at_once() {
    serve_all --baud 0
    exits 0 "$python" -W ignore "$client" exclusive "$(url pty)"
}

test_rfc2217_acknowledges_every_setting_of_pyserial() {
    serve_all
    py 0 settings rfc2217
    py 0 settings socket # which has none, but takes them
}

test_rfc2217_has_modem_lines_and_break() {
    serve_all
    py 0 lines rfc2217
}

test_a_second_client_is_refused_with_a_reason() {
    local way other
    serve_all
    for way in socket rfc2217; do
        mkfifo "$folder/go-$way"
        "$python" -W ignore "$client" keep "$(url "$way")" <"$folder/go-$way" >"$folder/keep-$way.out" 2>"$folder/keep.err" &
        processes+=("$!")
        exec 3>"$folder/go-$way"
        soon "the first client has the line" grep -qs open "$folder/keep-$way.out"
        other=$(ready_value bus "${way/socket/tcp}")
        exits 0 timeout "$limit" socat -t "$limit" "TCP:$other" -
        holds "$(tr -d '\r' <<<"$said")" "rkm04: refused: the bus is in use by 127.0.0.1:" "what the second client is told"
        exec 3>&-
        status_of "${processes[-1]}"
        same 0 "$status" "the first client goes on undisturbed"
        soon "nobody has the line" nobody_has_the_line
    done
    same 2 "$(grep -c 'was refused: another' "$folder/bus.err")" "lines of the log"
}

test_a_client_of_another_speed_is_reported_once() {
    serve_all
    py 0 slow rfc2217
    same 2 "$(grep -c '^0100' <<<"$said")" "answers in '$said'"
    same 1 "$(grep -c 'client is 9600 8N1, unit is 19200 8N1' "$folder/bus.err")" "reports"
}

test_a_client_of_another_speed_gets_silence_and_garbage_on_a_strict_line() {
    local way
    serve_all --strict-line
    for way in pty rfc2217; do
        py 0 garbled "$way"
        [[ $said != *0100* ]] || fail "$way: an answer at the wrong speed: $said"
        py 0 talk "$way"
    done
    same 2 "$(grep -c 'client is 9600 8N1, unit is 19200 8N1' "$folder/bus.err")" "reports"
}

test_a_client_that_closes_early_still_gets_its_answer() {
    local way
    serve_all
    for way in tcp rfc2217; do
        said=$(printf '\x01\x00\x02\x04\x31' | socat -t "$limit" - "TCP:$(ready_value bus $way)" | od -An -v -tx1 | tr -d ' \n')
        holds "$said" 0100 "the answer"
        holds "$said" 0a20202020202020202030 "the answer"
    done
}

run_cases "$@"
