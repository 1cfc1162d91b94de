#!/bin/bash
# SPDX-License-Identifier: MIT
# A second kind of device, tests/device, in a build of rkm04 that has it: pty, control socket, recording, traces, scenarios.
. "${0%/*}/lib.sh"
: "${RKM04_FAKE:=}"
[[ -n $RKM04_FAKE ]] || skip_all "RKM04_FAKE does not name a build with the fake device"
PRODUCT=$RKM04
RKM04=$RKM04_FAKE

# emulator OPTIONS...: units 5 and 100 whose time is advanced through the control socket; the bus is file descriptor 9.
emulator() {
    serve bus --device fake --node 5,100 --clock stepped "$@"
    exec 9<>"$folder/bus"
    export RKM04_CONTROL=$folder/bus.control
}

# value EXPRESSION: of `state` of unit 5, as Python writes it.
value() {
    call state '{"unit": "5"}'
    python3 -c "import json, sys; state = json.load(sys.stdin)['result']; print($1)" <<<"$said"
}

# call METHOD PARAMS: a request on the control socket; the answer is in $said.
call() {
    said=$(python3 - "$RKM04_CONTROL" "$1" "$2" <<'END'
import json, socket, sys
control = socket.socket(socket.AF_UNIX)
control.connect(sys.argv[1])
request = {"jsonrpc": "2.0", "id": 1, "method": sys.argv[2], "params": json.loads(sys.argv[3])}
control.sendall((json.dumps(request) + "\n").encode())
for line in control.makefile():
    answer = json.loads(line)
    print(line.strip())
    if answer.get("id") == 1:
        break
END
    )
}

test_devices_are_listed_with_a_line_each() {
    exits 0 "$RKM04" devices
    same "rkm04    unit for four stepper motors on RS485 (SofCon RKM04)" "$(head -n 1 <<<"$said")" "rkm04 devices: the default"
    same "fake     one axis at constant speed, twenty inputs, one output (example)" "$(grep ^fake <<<"$said")" "the fake one"
    exits 0 "$RKM04" devices --json
    same "rkm04 fake 1 20 1 100" \
        "$(python3 -c 'import json, sys; all = json.load(sys.stdin); fake = all[-2]; print(all[0]["name"], fake["name"],
fake["axes"], fake["inputs"], fake["outputs"], fake["addresses"])' <<<"$said")" "rkm04 devices --json"
    exits 0 "$PRODUCT" devices
    same "rkm04
cib" "$(cut -d ' ' -f 1 <<<"$said" | head -n 2)" "rkm04 devices of the product"
    same 0 "$(grep -c fake <<<"$said")" "fake devices of the product"
    exits 2 "$RKM04" devices x
}

test_an_unknown_device_and_options_of_another_one_are_refused() {
    exits 2 "$PRODUCT" serve --device fake
    holds "$complained" "--device: \`fake' is unknown: expected one that \`rkm04 devices' lists" "stderr"
    exits 2 "$RKM04" serve --device fake --framing plain
    holds "$complained" "--framing: the device fake has no such option: expected rate, start-file, end" "stderr"
    exits 2 "$RKM04" serve --device fuke
    holds "$complained" "did you mean \`fake'?" "stderr"
    exits 2 "$RKM04" serve --device-option rote=20 --device fake
    holds "$complained" "did you mean \`rate'?" "stderr"
    exits 2 "$RKM04" serve --device fake --device-option rate=0
    holds "$complained" "--device-option rate: \`0' is wrong: expected steps/s from 1 to 10000" "stderr"
    exits 2 "$RKM04" serve --device fake --device-option rate
    holds "$complained" "--device-option: \`rate' is wrong: expected NAME=VALUE" "stderr"
    echo "MOVE 1000000000000" >"$folder/start.txt"
    exits 2 "$RKM04" serve --device fake --device-option "start-file=$folder/start.txt"
    holds "$complained" "start.txt:1:17: error: expected a request of at most 16 bytes" "stderr"
    exits 1 "$RKM04" serve --device fake --device-option "start-file=$folder/none.txt"
    holds "$complained" "cannot read $folder/none.txt: No such file or directory" "stderr"
    exits 2 "$RKM04" serve --device fake --node 101
    holds "$complained" "expected addresses from 1 to 100" "stderr"
    exits 2 "$RKM04" serve --device rkm04 --node 17
    holds "$complained" "expected addresses from 1 to 16, as set with switch S1" "stderr"
}

test_the_options_of_a_device_are_named_where_one_is_refused() {
    echo 'steps: [{advance: 1s}]' >"$folder/a.yaml"
    exits 2 "$RKM04" test --device-option framing=plain "$folder/a.yaml"
    holds "$complained" "expected " "stderr"
    holds "$complained" "readings" "an option that has a switch of its own in this command"
}

# The settings of a device are in --help with its name, and units begin with them.
test_options_of_a_device() {
    exits 0 "$RKM04" serve --help
    holds "$said" "Options of the device fake (--device-option NAME=VALUE):" "--help"
    holds "$said" "rate=N" "--help"
    [[ $said != *--rate* ]] || fail "--help: expected no --rate"
    printf 'ZERO\nMOVE 7\n' >"$folder/start.txt"
    emulator --device-option rate=20 --device-option "start-file=$folder/start.txt" --record "$folder/options.record"
    exits 0 "$RKMCTL" advance 210ms
    same "4" "$(value 'state["motors"][0]["position"]')" "position after 210 ms at 20 steps/s"
    same "20" "$(value 'state["rate"]')" "rate"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/options.record"
    rm "$folder/start.txt"
    exits 0 "$RKM04" replay "$folder/options.record"
}

test_exec_runs_texts_of_the_device() {
    printf 'RATE 50\nMOVE 7\n' >"$folder/move.txt"
    exits 0 "$RKM04" exec --device fake --json "$folder/move.txt"
    holds "$said" '"t_us":140000,"motors":[{"motor":1,"position":7,"state":"idle"' "the final state"
    echo "MOVE 2" >"$folder/two.txt"
    echo "MOVE x" >"$folder/wrong.txt"
    echo "MOVE 1000000000000" >"$folder/long.txt"
    exits 0 "$RKM04" exec --device fake --device-option rate=20 --json "$folder/two.txt"
    holds "$said" '"t_us":100000' "two steps at 20 steps/s"
    printf '1ms di 20 1\n2ms message 494e3f\n3ms set 1 MOVE -2\n' >"$folder/stimulus.txt"
    exits 0 "$RKM04" exec --device fake --json --stimulus "$folder/stimulus.txt"
    holds "$said" '"message":"494E3F","answer":"353234323838"' "the answer"
    holds "$said" '"position":-2' "the position"
    exits 1 "$RKM04" exec --device fake "$folder/wrong.txt"
    holds "$complained" "wrong.txt: error: the unit answers E2" "stderr"
    exits 1 "$RKM04" exec --device fake "$folder/long.txt"
    holds "$complained" "long.txt:1:17: error: expected a request of at most 16 bytes" "stderr"
    exits 2 "$RKM04" exec --device fake 2="$folder/move.txt"
    holds "$complained" "expected a motor 1 to 1, or 0 for all, before '='" "stderr"
    exits 2 "$RKM04" exec --device fuke "$folder/move.txt"
    holds "$complained" "did you mean \`fake'?" "stderr"
    exits 2 "$RKM04" exec --device fake --readings planning=20ms "$folder/move.txt"
    holds "$complained" "--readings: the device fake has no such option" "stderr"
    exits 2 "$RKM04" exec --framing plain "$folder/move.txt"
}

test_ready_names_the_device_also_if_it_is_the_rkm04() {
    serve bus
    holds "$(<"$folder/bus.out")" '"device":"rkm04"' READY
    holds "$(<"$folder/bus.out")" '"readings":{}' READY
}

test_units_answer_over_a_pty() {
    emulator
    holds "$(<"$folder/bus.out")" '"nodes":[5,100]' READY
    holds "$(<"$folder/bus.out")" '"device":"fake"' READY
    dialogue 9 "85 50 4f 53 3f 0d" "30 0d" "POS? of unit 5"
    dialogue 9 "e4 4d 4f 56 45 20 33 0d" "4f 4b 0d" "MOVE 3 of unit 100"
    exits 0 "$RKMCTL" advance 1s
    dialogue 9 "e4 50 4f 53 3f 0d" "33 0d" "POS? of unit 100"
    dialogue 9 "85 50 4f 53 3f 0d" "30 0d" "POS? of unit 5"
}

test_the_control_socket_sees_and_sets() {
    emulator
    call di.set '{"unit": "5", "di": {"02": 1}}'
    holds "$said" '"di":2' "di.set"
    call di.set '{"unit": "5", "di": {"21": 1}}'
    holds "$said" "expected 1 to 20" "di.set of input 21"
    dialogue 9 "85 4d 4f 56 45 20 33 0d" "4f 4b 0d" "MOVE 3"
    call advance '{"until": {"unit": "5", "motor": 1, "position": 2}, "limit": "1s"}'
    holds "$said" '"t_us":20001' "advance to the second step"
    same "2 moving None" "$(value 'state["motors"][0]["position"], state["motors"][0]["state"], state["motors"][0]["fault"]' |
        tr -d "(),'")" "state"
    call subscribe '{"kinds": ["step"], "motor": 2}'
    holds "$said" "expected a number from 1 to 1" "subscribe to motor 2"
    call state '{"unit": 100}'
    holds "$said" '"node":100' "state of unit 100"
}

test_a_session_with_plant_faults_and_traces_replays() {
    printf 'units: {5: {switches: [{input: 1, motor: 1, at_least: 4}]}}\n' >"$folder/plant.yaml"
    emulator --plant "$folder/plant.yaml" --record "$folder/a.record" --trace "$folder/a.csv" \
        --trace "$folder/a.vcd" --trace "$folder/a.jsonl"
    dialogue 9 "85 4d 4f 56 45 20 39 0d" "4f 4b 0d" "MOVE 9"
    call fault.inject '{"kind": "no_answer", "count": 1}'
    holds "$said" '"id":1,"t_us":0' "fault.inject"
    exits 0 "$RKMCTL" advance 1s
    same "4 limit" "$(value 'state["motors"][0]["position"], state["motors"][0]["fault"]' | tr -d "(),'")" "at the switch"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    same 0 "$status" "exit status"
    holds "$(<"$folder/a.csv")" "$(printf '\n40000.000,5.m1,step,4\n40001.000,5.unit,di,1\n')" "the trace"
    exits 0 "$RKM04" replay --trace "$folder/b.csv" "$folder/a.record"
    cmp -s "$folder/a.csv" "$folder/b.csv" || fail "the trace of the replay is another"
    exits 2 "$PRODUCT" replay "$folder/a.record"
    holds "$complained" "expected \"device\"" "the product"
}

test_flash_image_outlives_the_emulator() {
    emulator --flash "$folder/%n.flash"
    dialogue 9 "85 52 41 54 45 20 37 0d" "4f 4b 0d" "RATE 7"
    dialogue 9 "85 53 41 56 45 0d" "4f 4b 0d" "SAVE"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    exec 9>&-
    emulator --flash "$folder/%n.flash"
    same 7 "$(value 'state["rate"]')" "rate"
}

test_a_scenario_names_its_device() {
    cat >"$folder/a.yaml" <<'END'
device: fake
steps:
  - {message: '"MOVE 2"', answer: '"OK"'}
  - wait: {idle: true}
  - expect: {motor: 1, position: 2}
END
    exits 0 "$RKM04" test "$folder/a.yaml"
    exits 2 "$PRODUCT" test "$folder/a.yaml"
    holds "$complained" "expected a device, one that \`rkm04 devices' lists, found \"fake\"" "the product"
}

# A device without a bus has a control socket alone.
test_a_device_without_a_bus_is_served() {
    exits 2 "$RKM04" serve --device alone --tcp 0
    holds "$complained" "--tcp: the device alone has no bus" "stderr"
    exits 2 "$RKM04" serve --device alone --link "$folder/bus"
    holds "$complained" "--link: the device alone has no bus" "stderr"
    start alone "$RKM04" serve --device alone --clock stepped --control "$folder/alone.control"
    soon "the device is ready" ready alone
    same "None None" "$(sed -n 's/^READY //p' "$folder/alone.out" | python3 -c 'import json, sys; ready = json.load(sys.stdin)
print(ready["pty"], ready["tcp"])')" "READY"
    export RKM04_CONTROL=$folder/alone.control
    exits 0 "$RKMCTL" di near=1 3=1
    same "lmt+=0 near=1 DI3=1" "$said" "di near=1 3=1"
    exits 2 "$RKMCTL" di far=1
    holds "$complained" "unknown input \`far': expected 1 to 3 or lmt+, near, DI3" "di far=1"
    exits 0 "$RKMCTL" call alone.obey text="MOVE 3"
    exits 0 "$RKMCTL" wait di.near=1
    exits 0 "$RKMCTL" advance 1s
    exits 0 "$RKMCTL" --json state
    holds "$said" '"position":3' "state"
    exits 0 "$RKMCTL" shutdown
    status_of "$started"
    XDG_RUNTIME_DIR=$folder exits 0 timeout "$limit" "$RKM04" serve --device alone --exit-when-idle=0
    holds "$said" 'rkm04/alone.control' "READY without --control"
    [[ $complained != *"frames dropped"* ]] || fail "the log has counters of a bus that is not there"
}

test_exec_advances_a_device_without_a_bus() {
    printf '1ms di near 1\n2ms di 3 1\n' >"$folder/inputs.txt"
    exits 0 "$RKM04" exec --device alone --stimulus "$folder/inputs.txt"
    holds "$said" "inputs on: near DI3; outputs on: none" "the report"
    echo '1ms di far 1' >"$folder/inputs.txt"
    exits 1 "$RKM04" exec --device alone --stimulus "$folder/inputs.txt"
    holds "$complained" "inputs.txt:1:8: error: expected an input 1 to 3 or lmt+, near, DI3, found 'far'" "stderr"
}

# A server of the device's own: many clients, of which none delays another one.
test_clients_of_a_server() {
    local wrong
    for wrong in lines line=0 lines=x =0; do
        exits 2 "$RKM04" serve --device alone --service "$wrong"
        holds "$complained" "--service:" "--service $wrong"
    done
    exits 2 "$RKM04" serve --device alone --service lines=0 --service lines=0
    holds "$complained" "expected lines once" "stderr"
    exits 2 "$RKM04" serve --service lines=0
    holds "$complained" "--service: the device rkm04 has no servers" "stderr"
    start alone "$RKM04" serve --device alone --service lines=localhost:0 --control "$folder/alone.control" \
        --record "$folder/alone.record"
    soon "the device is ready" ready alone
    exits 0 python3 - "$folder/alone.out" <<'END'
import json, re, socket, sys

ready = json.loads(re.search("^READY (.*)", open(sys.argv[1]).read(), re.M)[1])
host, port = ready["services"]["lines"].rsplit(":", 1)


def connect(room=None):
    client = socket.socket()
    if room:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
    client.settimeout(60)
    client.connect((host, int(port)))
    return client, client.makefile("rb")


def line(reader, wanted):
    came = reader.readline()
    assert came == wanted + b"\r\n", (came, wanted)


first, first_reads = connect()
line(first_reads, b"HELLO 1")
flood, flood_reads = connect(4096)
line(flood_reads, b"HELLO 2")
flood.setblocking(False)
try:
    for _ in range(100000):
        flood.send(b"IN?\n" * 200)
except BlockingIOError:
    pass
else:
    raise SystemExit("a client that does not read is read without end")
first.sendall(b"TELL\nMOVE 15\n")
for wanted in b"OK", b"POS":
    assert first_reads.readline().startswith(wanted)
others = [connect() for _ in range(7)]
for number, (client, reads) in enumerate(others[:6]):
    line(reads, b"HELLO %d" % (3 + number))
line(others[6][1], b"FULL")
assert others[6][1].read() == b""
others[0][0].sendall(b"BYE\n")
assert others[0][1].read() == b""
others[1][0].close()
flood.close()
last, last_reads = connect()
assert last_reads.readline().startswith(b"HELLO")
last.sendall(b"WHO\n")
line(last_reads, b"%s:%d" % first.getsockname())
END
    exits 0 "$RKMCTL" --control "$folder/alone.control" shutdown
    status_of "$started"
    exits 0 "$RKM04" replay "$folder/alone.record"
}

run_cases "$@"
