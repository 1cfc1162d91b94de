#!/bin/bash
# SPDX-License-Identifier: MIT
# CIB modules with real clients: rkmctl, pymodbus (python3-pymodbus), mbpoll, a program with libmodbus.

. "$(dirname "$0")/lib.sh"
here=$(cd "$(dirname "$0")" && pwd)

# The python that knows pymodbus; "none".
for python in python3 /usr/bin/python3 none; do
    "$python" -c 'import pymodbus, serial' 2>/dev/null && break
done

needs_pymodbus() {
    [[ $python != none ]] || skip_case "there is no pymodbus; apt-get install python3-pymodbus"
}

# serve_cib OPTIONS...: a module on $folder/bus
serve_cib() {
    serve bus --device cib "$@"
}

cib() {
    "$RKMCTL" -c "$folder/bus.control" "$@"
}

test_rkmctl_gives_commands_and_shows_drives() {
    serve_cib --clock stepped
    exits 0 cib cib command A 102 3000 500
    exits 0 cib advance m1.idle
    same "7.334335 s" "$said" "advance"
    exits 0 cib cib status A
    same "drive A  position 3000  speed 0  row 4  mcstat trg ramp" "$said" "status"
    exits 0 cib cib status B --json
    holds "$said" '"position":0' "--json"
    exits 0 cib cib command B 101 -- -5 1001
    holds "$said" "mcerr 4 (maximum)" "a refused command"
    exits 2 cib cib command C 101 5 100
    exits 2 cib cib command A
    holds "$complained" "expected A or B, a number" "no command"
    exits 2 cib cib frob
    holds "$complained" "expected status, command, di, do, pwm or config" "an unknown part"
}

test_rkmctl_shows_inputs_and_sets_outputs() {
    serve_cib --clock stepped
    printf 'do5-8: {use: do}\ndo1-2: {use: pwm, period: 100}\ndo3-4: {use: do}\n' >"$folder/setup.yaml"
    exits 0 cib cib config put "$folder/setup.yaml"
    exits 0 cib cib config apply
    exits 0 cib cib do 5=1 7=1
    exits 0 cib di button6=1
    exits 0 cib cib do 7=0
    holds "$said" "on 1=0 2=0 3=0 4=0 5=1 6=1 7=0 8=0" "what is on"
    exits 0 cib cib pwm 2 10000
    holds "$said" "pwm 1=0 2=10000" "the duty"
    exits 0 cib advance 1ms
    exits 0 cib di di1=1
    exits 0 cib cib di
    holds "$said" "di 1=0" "too early"
    exits 0 cib advance 5ms
    exits 0 cib cib di
    holds "$said" "di 1=1" "5 ms later"
    holds "$said" "buttons 1=0 2=0 3=0 4=0 5=0 6=1" "buttons"
    exits 2 cib cib do 9=1
    exits 2 cib cib pwm 1 10001
}
test_conditions_have_the_words_of_the_module() {
    serve_cib --clock stepped
    exits 0 cib cib command B 101 -- -5 1001
    exits 0 cib wait m2.fault=maximum --limit 1ms
    exits 3 cib advance 'm2.fault!=maximum' --limit 1ms
    holds "$complained" "motor 2 fault != maximum (is maximum)" "another word"
    exits 0 cib cib command A 102 300 100
    exits 0 cib advance m1.state=moving var1=1 --limit 10ms
    exits 0 cib advance 'm1.state!=moving' var1=0 var4=1 --limit 60s
    exits 2 cib wait m1.fault=no_label --limit 1ms
    holds "$complained" 'fault: expected one of none, ' "the words"
    holds "$complained" 'maximum' "the words"
    exits 2 cib wait m1.state=asleep --limit 1ms
    holds "$complained" 'expected one of idle, moving, stopping, turning, found "asleep"' "the words"
    exits 2 cib wait var13=1 --limit 1ms
    holds "$complained" "expected a number 01 to 12" "the variables"
}

test_rkmctl_puts_back_the_configuration_that_it_got() {
    serve_cib --clock stepped
    exits 0 cib cib config get
    sed 's/mode: 20/mode: 18/' <<<"$said" >"$folder/wrong.yaml"
    printf '%s\n' "$said" >"$folder/right.yaml"
    exits 0 cib cib config put "$folder/wrong.yaml"
    exits 1 cib cib config apply
    holds "$complained" "drive_a.mode (register 110H)" "what is wrong"
    exits 0 cib cib config put "$folder/right.yaml"
    exits 0 cib cib config apply
    printf 'do1-2: {use: relay}\n' >"$folder/no.yaml"
    exits 2 cib cib config put "$folder/no.yaml"
    holds "$complained" "do1-2.use: wrong value" "an unknown use"
}

test_the_configuration_at_power_up_comes_from_a_file() {
    printf 'do1-2: {use: do}\ndo3-4: {use: pwm, period: 9}\n' >"$folder/setup.yaml"
    exits 2 "$RKM04" serve --device cib --device-option "setup=$folder/setup.yaml"
    holds "$complained" "setup.yaml:1:1: error: expected a configuration that the module takes: do3-4.period" "stderr"
    printf 'do1-2: {use: do}\ndo3-4: {use: pwm, perod: 9}\n' >"$folder/setup.yaml"
    exits 2 "$RKM04" serve --device cib --device-option "setup=$folder/setup.yaml"
    holds "$complained" "setup.yaml:2:" "stderr"
    printf 'do1-2: {use: do}\ndo3-4: {use: do}\ndrive_b: {mode: 33}\n' >"$folder/setup.yaml"
    serve_cib --clock stepped --device-option "setup=$folder/setup.yaml" --device-option comm-timeout=100
    exits 0 cib cib do 1=1
    holds "$said" "on 1=1" "DO1"
    exits 0 cib cib command B 105 500
    exits 0 cib advance 3s
    exits 0 cib cib status B
    holds "$said" "speed 0" "the watchdog has stopped the drive"
    exits 2 "$RKM04" serve --device cib --device-option acc-unit=5
    holds "$complained" "expected 1, 10 or 100" "stderr"
    exits 2 "$RKM04" serve --device cib --device-option firmware=2
    holds "$complained" "expected 1.1 or 1.2" "stderr"
}

test_traces_have_levels_and_duties_of_pwm() {
    serve_cib --clock stepped --trace "$folder/a.csv" --trace "$folder/a.vcd" --trace "$folder/a.jsonl"
    printf 'do1-2: {use: pwm, period: 100}\ndo3-4: {use: do}\n' >"$folder/setup.yaml"
    exits 0 cib cib config put "$folder/setup.yaml"
    exits 0 cib cib config apply
    exits 0 cib cib pwm 2 2500
    exits 0 cib advance 1ms
    exits 0 cib shutdown
    status_of "$started"
    holds "$(<"$folder/a.csv")" $'\n0,unit,pwm2,2500\n' "CSV: the duty"
    holds "$(<"$folder/a.csv")" $'\n100,unit,do,2\n125,unit,do,0\n' "CSV: the levels"
    holds "$(<"$folder/a.jsonl")" '"kind":"value","unit":"1","name":"pwm2","value":2500}' "JSON lines"
    grep -q '^\$var real 64 [^ ]* pwm2 \$end' "$folder/a.vcd" || fail "VCD has no signal pwm2"
    grep -q '^r2500 ' "$folder/a.vcd" || fail "VCD has no duty"
}

test_a_plot_has_the_speeds_of_a_drive() {
    printf '%s\n' 'device: cib' 'steps:' '  - {call: cib.command, params: {drive: A, command: 102, p1: 3000, p2: 500}}' \
        '  - wait: {motor: 1, position: 3000}' >"$folder/a.yaml"
    exits 0 "$RKM04" plot --format csv "$folder/a.yaml"
    holds "$said" ",500.000," "the speed of the command"
    same 3000.000 "$(tail -n 1 <<<"$said" | cut -d, -f4)" "position at the end"
}

test_the_panel_has_two_motors_and_all_inputs() {
    serve_cib --clock stepped
    exits 0 cib cib command A 105 500
    exits 0 cib di di2=1
    exits 0 cib advance 10ms
    exits 0 cib watch --once
    holds "$said" "cib unit 1" "the title"
    holds "$said" " 1   .   moving             0     102" "motor 1"
    [[ $said != *" 3   "* ]] || fail "a third motor: $said"
    holds "$said" "DI    .  *  .  .  .  .  .  .  .  .  .  .  .  .  .  ." "inputs"
}

test_pymodbus_reads_writes_and_gets_every_exception() {
    needs_pymodbus
    serve_cib --node 1,17 --baud 0
    exits 0 "$python" -W ignore "$here/cib_client.py" registers "$folder/bus"
}

test_pymodbus_moves_a_drive_in_real_time() {
    needs_pymodbus
    serve_cib
    exits 0 "$python" -W ignore "$here/cib_client.py" motion "$folder/bus"
}

test_bytes_are_gathered_and_dropped_by_silence() {
    needs_pymodbus
    serve_cib --clock stepped --device-option silence=100000
    exits 0 "$python" -W ignore "$here/cib_client.py" silence "$folder/bus"
}

# address NAME: where a server listens.
address() {
    sed -n "s/.*: $1 on //p" "$folder/bus.err"
}

test_pymodbus_over_tcp() {
    needs_pymodbus
    serve_cib --node 1,17 --service modbus-tcp=127.0.0.1:0
    exits 0 "$python" -W ignore "$here/cib_client.py" tcp "$(address modbus-tcp)"
}

test_a_plccoms_client_at_a_stopped_clock() {
    needs_pymodbus
    serve_cib --clock stepped --service plccoms=127.0.0.1:0
    exits 0 "$python" -W ignore "$here/cib_client.py" lines "$(address plccoms)" "$folder/bus.control"
}

test_mbpoll_over_tcp() {
    local at
    command -v mbpoll >/dev/null || skip_case "there is no mbpoll; apt-get install mbpoll"
    serve_cib --service modbus-tcp=127.0.0.1:0
    at=$(address modbus-tcp)
    exits 0 mbpoll -o 10 -m tcp -a 1 -p "${at##*:}" -0 -1 -q -t 3:hex -r 48 -c 1 "${at%:*}"
    holds "$said" "0x0808" "the type"
}

test_mbpoll_reads_and_writes() {
    command -v mbpoll >/dev/null || skip_case "there is no mbpoll; apt-get install mbpoll"
    local poll=(mbpoll -o 10 -m rtu -a 1 -b 19200 -P none -0 -1 -q)
    serve_cib --baud 0
    exits 0 "${poll[@]}" -t 3:hex -r 48 -c 2 "$folder/bus"
    holds "$said" "0x0808" "the type"
    holds "$said" "0x0102" "the firmware"
    exits 0 "${poll[@]}" -t 4 -r 16 "$folder/bus" 1 102 0 3 100
    exits 0 "${poll[@]}" -t 3 -r 16 -c 1 "$folder/bus"
    holds "$said" "[16]: 	1" "ACK"
    exits 0 "${poll[@]}" -t 0 -r 5 "$folder/bus" 1
    exits 0 "${poll[@]}" -t 0 -r 0 -c 8 "$folder/bus"
    holds "$said" "[5]: 	1" "the coil"
    exits 0 "${poll[@]}" -t 1 -r 0 -c 16 "$folder/bus"
    exits 1 "${poll[@]}" -t 4 -r 9 -c 1 "$folder/bus"
    holds "$complained" "Illegal data address" "an exception"
}

test_a_program_with_libmodbus() {
    pkg-config --exists libmodbus || skip_case "there is no libmodbus; apt-get install libmodbus-dev"
    # shellcheck disable=SC2046
    "${CC:-cc}" -o "$folder/client" "$here/cib_libmodbus.c" $(pkg-config --cflags --libs libmodbus) || fail "it cannot be built"
    serve_cib --baud 0
    exits 0 "$folder/client" "$folder/bus"
}

test_the_example_of_a_scenario_passes() {
    exits 0 "$RKM04" test "$here/../../examples/cib-feeder.yaml"
    holds "$said" "pass " "rkm04 test"
}

test_a_recording_has_bytes_and_methods_and_is_replayed() {
    printf 'do5-8: {use: do}\n' >"$folder/setup.yaml"
    serve_cib --clock stepped --record "$folder/run.record" --trace "$folder/run.vcd" --trace "$folder/run.csv" \
        --device-option "setup=$folder/setup.yaml" --device-option comm-timeout=60000
    exits 0 cib cib command A 102 30 100
    exits 0 cib cib do 6=1
    exits 0 cib advance 100ms
    exits 0 cib shutdown
    status_of "$started"
    same 0 "$status" "the emulator"
    exits 0 "$RKM04" replay "$folder/run.record" --trace "$folder/again.csv"
    cmp -s "$folder/run.csv" "$folder/again.csv" || fail "another trace: $(diff "$folder/run.csv" "$folder/again.csv" | head)"
    holds "$(<"$folder/run.vcd")" "do1" "names of outputs in the VCD file"
}

run_cases "$@"
