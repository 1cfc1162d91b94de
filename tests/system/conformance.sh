#!/bin/bash
# SPDX-License-Identifier: MIT
# The conformance kit on units that conform, with and without a control socket, and on some that do not.

. "$(dirname "$0")/lib.sh"

kit=$(cd "$(dirname "$0")/../.." && pwd)/tools/conformance
for python in python3 /usr/bin/python3 none; do # a python3 of one's own does not know the packages of the system
    "$python" -c 'import serial' 2>/dev/null && break
done
if [[ $python == none ]]; then
    skip_all "there is no pyserial; apt-get install python3-serial"
fi

# conforms STATUS OPTIONS...: what the kit says of the unit on $folder/bus. A busy machine may be late by seconds.
conforms() {
    exits "$1" "$python" "$kit" --port "$folder/bus" --timeout 10000 --latency 5000 "${@:2}"
}

last_line() {
    grep -E '^[0-9]+ passed' <<<"$said"
}

# pulses_are NUMBER: so many have left the unit until its end, by its trace.
pulses_are() {
    status_of_serve
    same "$1" "$(grep -c '"kind": *"step"' "$folder/trace.jsonl")" "pulses"
}

status_of_serve() {
    kill "$started"
    status_of "$started"
    same 0 "$status" "the emulator ends"
}

test_every_case_passes_with_a_control_socket() {
    local framing
    for framing in hdlc plain; do
        serve bus --framing "$framing"
        conforms 0 --has control --framing "$framing" --junit "$folder/report.xml"
        holds "$(last_line)" " passed, 0 failed" "the summary"
        grep 'needs ' <<<"$said" && fail "a case lacks something"
        same "$(grep -c '^ok\|^skipped' <<<"$said")" "$(xml_count testcase)" "cases in the report"
        status_of_serve
    done
}

xml_count() {
    "$python" -c 'import sys, xml.etree.ElementTree as tree; print(len(list(tree.parse(sys.argv[1]).iter(sys.argv[2]))))' \
        "$folder/report.xml" "$1"
}

# failures: the names of the cases that failed, as options.
failures() { sed -n 's/^FAILED .* \([^ ]*\)$/--only \1/p' <<<"$said"; }

# Where a motion takes a tenth of a second, this machine may be too late to ask about it: such a case is done again with a unit
# that is not so fast.
test_every_case_that_needs_no_hands_passes_without_a_control_socket() {
    local speed only=()
    for speed in 30 10 3 1; do
        serve bus --clock "x$speed" --no-control
        said=$("$python" "$kit" --port "$folder/bus" --timeout 10000 --latency 5000 --speed "$speed" "${only[@]}" \
            2>"$folder/kit.err")
        if [[ $speed == 30 ]]; then
            holds "$said" "needs inputs" "what was left out"
            holds "$said" "need a control socket" "what was left out"
        fi
        read -ra only < <(failures | xargs)
        ((${#only[@]} > 0)) || break
        status_of_serve
    done
    holds "$(last_line)" " passed, 0 failed" "the summary"
}

test_units_with_other_addresses_and_over_tcp() {
    serve bus --node 2,9 --tcp 127.0.0.1:0 --control "$folder/socket" --framing plain
    local where
    where=$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    exits 0 "$python" "$kit" --port "tcp:$where" --control "$folder/socket" --framing plain --node 9 --only M5.3 --only M9
    holds "$(last_line)" " passed, 0 failed, 0 skipped" "the summary"
}

# A device server that passes bytes on a while later, by a thread of each direction. Says its port.
late_bridge() {
    "$python" - "$1" <<'END_OF_BRIDGE'
import socket, sys, threading, time

def pass_on(source, sink):
    while data := source.recv(4096):
        time.sleep(0.05)
        sink.sendall(data)
    sink.shutdown(socket.SHUT_WR)

listener = socket.create_server(("127.0.0.1", 0))
print(listener.getsockname()[1], flush=True)
client, unit = listener.accept()[0], socket.create_connection(("127.0.0.1", int(sys.argv[1])))
threading.Thread(target=pass_on, args=(unit, client), daemon=True).start()
pass_on(client, unit)
END_OF_BRIDGE
}

test_time_does_not_pass_before_what_was_said_is_there() {
    serve bus --tcp 127.0.0.1:0 --control "$folder/socket" --framing plain
    start bridge late_bridge "$(sed -n 's/^READY .*"tcp":"[^"]*:\([0-9]*\)".*/\1/p' "$folder/bus.out")"
    soon "the bridge is there" test -s "$folder/bridge.out"
    exits 0 "$python" "$kit" --port "tcp:127.0.0.1:$(<"$folder/bridge.out")" --control "$folder/socket" --framing plain --only L2
    holds "$(last_line)" " passed, 0 failed, 0 skipped" "the summary"
}

test_what_differs_is_told_with_clause_expectation_and_observation() {
    serve bus --version-text 'other' --clock stepped
    conforms 1 --has control --only M5.3.1 --junit "$folder/report.xml"
    holds "$said" "FAILED  M5.3.1" "the case"
    holds "$said" 'expected: 30 31 2e 30 32 2c 30 36 2e 30 33 2e 32 30 30 39 "01.02,06.03.2009"' "the expectation"
    holds "$said" 'observed: 6f 74 68 65 72 "other"' "the observation"
    holds "$(last_line)" "1 passed, 1 failed" "the summary"
    same 1 "$(xml_count failure)" "failures in the report"
    holds "$(<"$folder/report.xml")" "expected: 30 31" "the report"
}

test_the_report_replaces_reports_only() {
    printf 'steps: []\n' >"$folder/scenario.yaml"
    cp "$folder/scenario.yaml" "$folder/kept"
    cat >"$folder/unit" <<<'not run'
    ln -s unit "$folder/link"
    conforms 2 --junit "$folder/scenario.yaml"
    holds "$complained" "scenario.yaml exists and is no JUnit report: --force replaces it" "a file of another kind"
    exits 2 "$python" "$kit" --port "in:$folder/unit" --junit "$folder/link" --force
    holds "$complained" "link is also read" "the unit's program"
    cmp -s "$folder/scenario.yaml" "$folder/kept" || fail "the scenario has changed"
    serve bus --clock stepped
    conforms 0 --has control --only M5.3.1 --junit "$folder/scenario.yaml" --force
    conforms 0 --has control --only M5.3.1 --junit "$folder/scenario.yaml"
    holds "$(<"$folder/scenario.yaml")" "<testsuite" "the report"
}

# A unit that goes wrong in one place is found by the cases of that place: every answer of one kind is damaged.
test_wrong_frames_and_silence_are_told() {
    serve bus
    exits 0 "$RKMCTL" --control "$folder/bus.control" fault inject wrong_fcs skip=4 count=1
    conforms 1 --has control --only M5.3.8
    holds "$said" "the check value of the frame is wrong" "the observation"
    exits 0 "$RKMCTL" --control "$folder/bus.control" fault inject no_answer skip=4 count=1
    conforms 1 --has control --only M5.3.8 --timeout 300
    holds "$said" "observed: silence" "the observation"
}

test_no_motor_turns_with_no_motion() {
    serve bus --trace "$folder/trace.jsonl"
    conforms 0 --has control --no-motion
    holds "$said" "moves motor 1" "what was left out"
    pulses_are 0
    serve bus --trace "$folder/trace.jsonl"
    conforms 0 --has control --only all_four_motors_move_at_once
    pulses_are 8000
}

test_no_pulse_leaves_a_unit_that_is_held_still() {
    serve bus --trace "$folder/trace.jsonl"
    conforms 0 --has control --still --only M9 --only R1
    holds "$(last_line)" " passed, 0 failed" "the summary"
    pulses_are 0
}

test_somebody_sets_the_inputs_when_asked() {
    serve bus
    exits 3 "$python" "$kit" --port "$folder/bus" --has inputs --only M7.32 # there is none: standard input is empty
    holds "$complained" "set input 03 to 0, then press Enter" "what is asked"
    holds "$complained" "nobody is there" "what is told"
}

# A hand that does what it is asked: it reads the kit's questions and works the emulator behind its back.
hand() {
    local line
    while read -r -d : line; do
        line=${line##*>>> }
        if [[ $line =~ set\ input\ ([0-9]+)\ to\ ([01]) ]]; then
            "$RKMCTL" --control "$folder/bus.control" di "${BASH_REMATCH[1]}=${BASH_REMATCH[2]}"
        elif [[ $line == *"switch the unit off and on"* ]]; then
            "$RKMCTL" --control "$folder/bus.control" reset
        fi >>"$folder/hand.out" 2>>"$folder/hand.err"
        echo
    done
}

test_a_hand_does_what_a_control_socket_does() {
    serve bus --clock x10
    mkfifo "$folder/asked" "$folder/done"
    hand <"$folder/asked" >"$folder/done" &
    processes+=("$!")
    "$python" "$kit" --port "$folder/bus" --timeout 10000 --latency 5000 --speed 10 --has inputs,power,flash \
        --only M7.32 --only a_jump_asks_an_input --only P6 >"$folder/kit.out" 2>"$folder/asked" <"$folder/done"
    same 0 "$?" "status of the kit, which said $(<"$folder/kit.out")"
    holds "$(<"$folder/kit.out")" "4 passed, 0 failed, 0 skipped" "the summary"
}

test_nobody_there_is_status_3() {
    serve bus
    exits 3 "$python" "$kit" --port "$folder/bus" --node 2 --timeout 300
    holds "$complained" "node 2 does not answer" "what is told"
    exits 3 "$python" "$kit" --port "$folder/none"
    holds "$complained" "cannot open $folder/none" "what is told"
    exits 3 "$python" "$kit" --port tcp:127.0.0.1:x
    exits 3 "$python" "$kit" --port "$folder/bus" --control "$folder/none"
    holds "$complained" "cannot connect to the control socket $folder/none" "what is told"
    exits 3 "$python" "$kit" --port "$folder/bus" --framing plain --timeout 300
}

test_wrong_usage_is_status_2() {
    exits 2 "$python" "$kit"
    holds "$complained" "--port is missing" "what is told"
    exits 2 "$python" "$kit" --port x --has wings
    holds "$complained" "expected control, inputs, outputs, power, flash" "what is told"
    exits 2 "$python" "$kit" --port x --node 17
    exits 2 "$python" "$kit" --port x --only Q77
    holds "$complained" "no case of clause or name \`Q77'" "what is told"
    exits 2 "$python" "$kit" --port tcp:localhost:1 --has control
    exits 0 "$python" "$kit" --help
    holds "$said" "--has control" "the help"
    exits 0 "$python" "$kit" --list
    holds "$said" "moves 1" "the list"
}

test_a_python_without_pyserial_is_told_what_to_install() {
    echo 'raise ImportError' >"$folder/serial.py"
    exits 3 env PYTHONPATH="$folder" "$python" "$kit" --port "$folder/none"
    holds "$complained" "apt-get install python3-serial" "what is told"
}

run_cases "$@"
