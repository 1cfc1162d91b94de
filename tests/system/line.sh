#!/bin/bash
# SPDX-License-Identifier: MIT
# The line as clients meet it: their settings, several ways in, the end when no client is there, coverage, load.

. "$(dirname "$0")/lib.sh"

request="7e 01 00 08 58 10 7e" # message 8 to unit 1, which does not know it
answer="7e 00 01 ff 08 00 00 db ff 7e"

# said NAME TEXT: so often the log has the text.
said() { grep -c -F "$2" "$folder/$1.err"; }

# ---- Settings of the client

test_U7_a_client_with_another_speed_is_reported_once() {
    serve bus
    exec 3<>"$folder/bus"
    stty 9600 <"$folder/bus"
    dialogue 3 "$request" "$answer" "without --strict-line it is served all the same"
    dialogue 3 "$request" "$answer" "a second time"
    same 1 "$(said bus 'client is 9600 8N1, unit is 19200 8N1')" "reports"
    exec 3>&-
}

test_U7_a_client_as_the_unit_is_not_reported() {
    serve bus
    exits 0 ctl bus version
    same 0 "$(said bus 'client is')" "reports"
}

test_U7_on_a_strict_line_a_client_with_another_speed_is_not_understood() {
    serve bus --strict-line
    exec 3<>"$folder/bus"
    stty 9600 <"$folder/bus"
    say_bytes 3 "$request"
    soon "the speed is reported" reported
    stty 19200 <"$folder/bus"
    dialogue 3 "$request" "$answer" "at the speed of the unit"
    exec 3>&-
    kill "$started"
    status_of "$started"
    same 1 "$(said bus 'requests 1, answers 1')" "the unit has understood one request"
}

reported() { [[ $(said bus 'client is 9600 8N1, unit is 19200 8N1') == 1 ]]; }

test_U7_on_a_strict_line_a_faster_listener_receives_garbage() {
    serve bus --strict-line --turnaround 1000000 --clock x0.02 # the turnaround takes 50 s of real time
    exec 3<>"$folder/bus"
    say_bytes 3 "$request"
    soon "the request has passed" passed 7
    stty 38400 <"$folder/bus"
    exits 0 "$RKMCTL" --control "$folder/bus.control" clock x10
    soon "the answer has passed" passed 17
    local heard
    heard=$(hear_bytes 3 1)$(timeout 0.5 head -c 9 <&3 | od -An -v -tx1 | tr -d ' \n')
    exec 3>&-
    [[ -n $heard && $heard != "${answer// /}" ]] || fail "heard '$heard'"
}

# passed BYTES: so many have been on the line.
passed() { "$RKMCTL" --control "$folder/bus.control" --json state | grep -q "\"line\":{\"bytes\":$1,"; }

test_strict_line_needs_a_line() {
    exits 2 "$RKM04" serve --strict-line --baud 0
    exits 2 "$RKM04" serve --turnaround 5 --baud 0
    exits 2 "$RKM04" serve --turnaround 1000001
}

# ---- Ways in

# address KEY: what the READY line of `bus` says.
address() { sed 's/.*"'"$1"'":"\([^"]*\)".*/\1/' "$folder/bus.out"; }

test_with_tcp_alone_there_is_no_pty() {
    start bus "$RKM04" serve --tcp 0
    soon "the unit is ready" ready bus
    holds "$(<"$folder/bus.out")" '"pty":null' "the READY line"
    exits 0 "$RKMCTL" -p "tcp:$(address tcp)" version
}

test_with_a_link_there_is_a_pty_beside_tcp() {
    serve bus --tcp 0 --clock max
    exits 0 ctl bus set 'F25 R'
    soon "the motor has arrived" position_is bus 1 25
    exits 0 "$RKMCTL" -p "tcp:$(address tcp)" position
    holds "$said" "motor 1: 25" "over TCP the same unit"
}

# sent_away KEY: a client that comes by this way gets the message that the line is in use.
sent_away() {
    exec 4<>"/dev/tcp/127.0.0.1/$(address "$1" | sed 's/.*://')"
    holds "$(timeout "$limit" cat <&4)" "refused: the bus is in use by $2" "what a second client by $1 is told"
    exec 4>&-
}

test_one_client_has_the_line_whatever_way_it_came() {
    serve bus --tcp 0 --rfc2217 0
    exec 3<>"$folder/bus"
    sent_away tcp "a client of the pty"
    sent_away rfc2217 "a client of the pty"
    exec 3>&-
    exec 3<>"/dev/tcp/127.0.0.1/$(address tcp | sed 's/.*://')"
    dialogue 3 "$request" "$answer" "the client over TCP has the line"
    sent_away rfc2217 127.0.0.1
    sent_away tcp 127.0.0.1
    dialogue 3 "$request" "$answer" "the client over TCP still has the line"
    exec 3>&-
}

test_each_line_has_a_tcp_port_of_its_own() {
    start bus "$RKM04" serve --tcp 0 --lines 2 --clock max
    soon "the lines are ready" ready bus
    local ports
    ports=$(grep -o '"tcp":"[^"]*"' "$folder/bus.out" | tail -n 2 | sed 's/.*:"\(.*\)"/\1/')
    same 2 "$(sort -u <<<"$ports" | wc -l)" "ports of two lines"
    for port in $ports; do
        exits 0 "$RKMCTL" -p "tcp:$port" version
    done
}

test_options_that_do_not_go_together_are_usage_errors() {
    local together
    for together in "--lines 2 --port /dev/null" "--rts toggles" "--lines 0" "--lines 257" "--node 1,2 --flash image" \
        "--lines 2 --flash image" "--lines 2 --link bus" "--link bus%n" "--link bus%x" "--tcp nowhere" "--tcp :65536" \
        "--rts sometimes --port /dev/null" "--node 1-17" "--node 5-3" "--node 1," "--node ,1" "--node 1-16,1" \
        "--min-coverage 101" "--min-coverage 5.55" "--min-coverage much" "--exit-when-idle=-1" "--ready-fd 77"; do
        # shellcheck disable=SC2086
        exits 2 "$RKM04" serve $together
    done
}

test_a_serial_device_without_RTS_is_refused_with_rts_toggles() {
    start bridge socat "pty,rawer,link=$folder/one" "pty,rawer,link=$folder/other"
    soon "the pair is there" test -e "$folder/other"
    exits 1 "$RKM04" serve --port "$folder/one" --rts toggles
    holds "$complained" "RTS" "the message"
}

# ---- Begin and end

# held OPTIONS...: a unit that ends when it is idle for a second, with a client, descriptor 3, that `enter' connects. A machine
# may be so busy that it ends before; then it is started again.
held() {
    until
        start bus "$RKM04" serve --exit-when-idle=1 --verbose "$@"
        soon "the unit is ready" ready bus
        { enter; } 2>/dev/null && soon "a client or the end of the unit" entered && ! ended "$started"
    do
        exec 3>&-
    done
}

entered() { grep -q 'has opened the bus' "$folder/bus.err" || ended "$started"; }

test_exit_when_idle_waits_for_the_last_client() {
    enter() { exec 3<"$folder/bus"; }
    held --link "$folder/bus"
    sleep 1.5 # a silent client holds the line for longer than the limit
    ended "$started" && fail "it has ended under a client"
    exec 3>&-
    status_of "$started"
    same 0 "$status" "exit status"
    [[ ! -L $folder/bus ]] || fail "the link is still there"
}

test_exit_when_idle_ends_an_emulator_that_nobody_uses() {
    serve bus --exit-when-idle=0
    status_of "$started"
    same 0 "$status" "exit status"
}

test_exit_when_idle_knows_tcp_clients() {
    enter() { exec 3<>"/dev/tcp/127.0.0.1/$(address tcp | sed 's/.*://')"; }
    held --tcp 0
    sleep 1.5 # longer than the limit
    ended "$started" && fail "it has ended under a client"
    exec 3>&-
    status_of "$started"
    same 0 "$status" "exit status"
}

test_ready_fd_gets_the_ready_line_and_its_end() {
    mkfifo "$folder/ready"
    "$RKM04" serve --link "$folder/bus" --ready-fd 5 5>"$folder/ready" >"$folder/bus.out" 2>"$folder/bus.err" &
    started=$!
    processes+=("$started")
    same "$(timeout "$limit" cat "$folder/ready")" "$(cat "$folder/bus.out")" "the line on the descriptor"
    holds "$(<"$folder/bus.out")" READY "the line"
}

# ---- Coverage

test_coverage_is_written_at_the_end_as_text_and_json() {
    serve bus --node 1,2 --coverage "$folder/covered"
    exits 0 ctl bus -n 2 version
    exits 1 ctl bus -n 1 set 'F0'
    exits 3 ctl bus -n 9 --timeout 200 store
    kill "$started"
    status_of "$started"
    same 0 "$status" "exit status"
    python3 - "$folder/covered.json" <<'END' || fail "the JSON is not as expected: $(head -c 300 "$folder/covered.json")"
import json, sys
report = json.load(open(sys.argv[1]))
counts = {item["name"]: item["count"] for group in report["groups"] for item in group["items"]}
assert [count for name, count in counts.items() if name.startswith("1 Version") and count == 1]
assert not any(count for name, count in counts.items() if name.startswith("3 Store"))
assert 0 < report["covered"] < report["total"]
END
    grep -q missing "$folder/covered" || fail "the text does not say what is missing"
}

test_less_than_min_coverage_is_exit_status_4() {
    serve bus --min-coverage 50
    exits 0 ctl bus version
    kill "$started"
    status_of "$started"
    same 4 "$status" "exit status"
    holds "$(<"$folder/bus.err")" "expected at least 50.0 %" "the message"
}

test_enough_coverage_is_exit_status_0() {
    serve bus --min-coverage 0.5
    exits 0 ctl bus version
    kill "$started"
    status_of "$started"
    same 0 "$status" "exit status"
}

test_a_coverage_file_that_cannot_be_written_is_an_error_at_once() {
    exits 1 "$RKM04" serve --link "$folder/bus" --coverage "$folder/no/such/file"
    holds "$complained" "$folder/no/such/file" "the message"
}

# ---- Load

test_sixteen_units_at_full_speed_for_ten_minutes_lose_nothing() {
    serve bus --node 1-16 --clock max
    exits 0 "$POLL_MASTER" "$folder/bus" 16 9600000 200
    holds "$said" '"wrong":0,"arrived":64' "the master's report"
    kill "$started"
    status_of "$started"
    holds "$(<"$folder/bus.err")" "frames dropped 0, bytes dropped 0, collisions 0, framing errors 0, overruns 0" "the line"
    local seconds
    seconds=$(tail -n 1 "$folder/bus.err" | sed 's/^\[ *\([0-9]*\).*/\1/')
    ((seconds >= 600)) || fail "only $seconds s of virtual time"
}

run_cases "$@"
