#!/bin/bash
# SPDX-License-Identifier: MIT
# The PMC-1HS and PMC-2HS: rkm04 serve and exec with them, rkmctl pmc on both faces and through the control socket.
. "${0%/*}/lib.sh"

# unit OPTIONS...: a PMC-2HS on $folder/bus with a control socket.
unit() {
    serve bus --device pmc-2hs --control "$folder/bus.control" "$@"
}

# pmc WORDS...: on the bus. socket WORDS...: through the control socket.
pmc() {
    "$RKMCTL" -p "$folder/bus" pmc "$@"
}

socket() {
    "$RKMCTL" -c "$folder/bus.control" pmc "$@"
}

program() {
    cat >"$folder/a.pmc" <<'END'
# two laps, then an output
X: 00 REP 1
X: 01 INC 100 V3 50
X: 02 RPE
X: 03 OUT OUT0 ON
X: 04 END
Y: 00 ABS -20.5 V4
Y: 01 END
END
}

canonical="X: 00 REP 1
X: 01 INC 100 V3 50
X: 02 RPE
X: 03 OUT OUT0 ON
X: 04 END
Y: 00 ABS -20.5 V4
Y: 01 END"

# at WAY X Y: the counters.
at() {
    [[ $("$1" position 2>"$folder/at.err") == "x: $2"$'\n'"y: $3" ]]
}

idle() {
    "$RKMCTL" -c "$folder/bus.control" wait idle --limit 1s >/dev/null
}

# way_works WAY: moves, jogs and stops.
way_works() {
    exits 0 "$1" speed x=2000 y=2000
    exits 0 "$1" move x=1000 y=-5
    soon "$1: both axes arrive" at "$1" 1000 -5
    exits 0 "$1" move by x=-1000 y=5 --json
    same "{}" "$said" "$1: --json of a command"
    soon "$1: both axes come back" at "$1" 0 0
    exits 0 "$1" --json position
    same '{"x":0,"y":0}' "$said" "$1: --json position"
    exits 0 "$1" errors
    same "x: none
y: none" "$said" "$1: errors"
    exits 0 "$1" --json errors
    same '{"x":[],"y":[]}' "$said" "$1: --json errors"
    exits 0 "$1" jog x+ y-
    exits 0 "$1" stop
    soon "$1: both axes stop" idle
}

test_lines_of_text() {
    unit
    way_works pmc
    exits 2 pmc program get
    holds "$complained" "expected --face modbus, or --control" "stderr"
    exits 2 pmc stop x now
}

# files WAY: program and parameters there and back.
files() {
    program
    exits 0 "$1" program put "$folder/a.pmc"
    exits 0 "$1" program get
    same "$canonical" "$said" "$1: program get"
    exits 0 "$1" parameters get
    holds "$said" "deceleration = follow" "$1: parameters get"
    printf '[Y]\nspeed1 = 77\nlimit_minus = -1000\ndeceleration = 9\n' >"$folder/y.txt"
    exits 0 "$1" parameters put "$folder/y.txt"
    exits 0 "$1" parameters get
    holds "$said" "speed1 = 77" "$1: parameters get"
    holds "$said" "deceleration = 9" "$1: parameters get"
    holds "$said" "limit_minus = -1000" "$1: parameters get"
    holds "$said" "flags = 0x0133" "$1: parameters get"
    exits 0 "$1" store
    exits 0 "$RKMCTL" -c "$folder/bus.control" reset
    exits 0 "$1" program get
    same "$canonical" "$said" "$1: program get after a power-up"
    printf '5 REP 256\nX: 6 FOO\n' >"$folder/wrong.pmc"
    exits 1 "$1" program put "$folder/wrong.pmc"
    holds "$complained" "$folder/wrong.pmc:1:7: error: expected a count from 1 to 255" "stderr"
    holds "$complained" "$folder/wrong.pmc:2:6: error: expected a command" "stderr"
    exits 1 "$1" program put "$folder/none.pmc"
    exits 0 "$1" run x
    soon "$1: the program ends" at "$1" 200 0
}

# Ten bits at 9600 baud are 1042 us: 22 bytes of an answer take 23 ms; at 115200 they take 2 ms.
test_bytes_take_the_time_of_their_speed() {
    local rate
    cat >"$folder/a.yaml" <<'END'
device: pmc-2hs
steps:
  - {message: '"POS"', answer: '"POS 00000000,00000000"', within: 24ms}
END
    exits 0 "$RKM04" test "$folder/a.yaml"
    sed 's/24ms/22ms/' "$folder/a.yaml" >"$folder/b.yaml"
    exits 3 "$RKM04" test --no-records "$folder/b.yaml"
    sed 's/24ms/3ms/; s/^device.*/&\nbaud: 115200/' "$folder/a.yaml" >"$folder/c.yaml"
    exits 0 "$RKM04" test "$folder/c.yaml"
    sed 's/115200/300/' "$folder/c.yaml" >"$folder/d.yaml"
    exits 2 "$RKM04" test "$folder/d.yaml"
    holds "$complained" "d.yaml:2:7: error: " "stderr"
    unit
    holds "$(<"$folder/bus.out")" '"baud":9600' "READY"
    exits 0 pmc position
    [[ $(<"$folder/bus.err") != *"client is"* ]] || fail "the client is as the unit: $(<"$folder/bus.err")"
    exits 2 "$RKM04" serve --device pmc-2hs --baud 19200
    holds "$complained" "expected 9600, the rate of the unit, or 0" "stderr"
}

test_modbus() {
    pmc() { "$RKMCTL" -p "$folder/bus" --face modbus pmc "$@"; }
    unit --device-option face=modbus
    way_works pmc
    exits 0 pmc stop xy now
    exits 0 pmc jog x+
    exits 1 pmc move by x=1
    holds "$complained" "exception 6: the axis is busy" "stderr"
    exits 0 pmc stop xy now
    soon "both axes stop" idle
    exits 0 "$RKMCTL" -p "$folder/bus" --face modbus --node 0 pmc speed x=1
    exits 3 "$RKMCTL" -p "$folder/bus" --face modbus --node 2 --timeout 100 pmc position
    soon "the counter is cleared" "$RKMCTL" -c "$folder/bus.control" call pmc.clear_counters >/dev/null
    files pmc
}

test_control_socket() {
    unit
    way_works socket
    files socket
}

test_files_are_stored_at_the_start() {
    program
    printf '[X]\nspeed3 = 2000\n' >"$folder/x.txt"
    unit --device-option program="$folder/a.pmc" --device-option parameters="$folder/x.txt"
    exits 0 socket program get
    same "$canonical" "$said" "the program"
    exits 0 socket parameters get
    holds "$said" "speed3 = 2000" "the parameters"
    exits 0 socket program put /dev/null
    exits 0 socket store
    exits 0 "$RKMCTL" -c "$folder/bus.control" reset
    exits 0 socket program get
    same "" "$said" "the program after another one was stored"
}

test_wrong_files_and_options_are_refused() {
    printf '5 REP 256\n' >"$folder/wrong.pmc"
    printf 'device: pmc-2hs\nsteps: []\n' >"$folder/empty.yaml"
    local words
    for words in serve "exec $folder/wrong.pmc" "test $folder/empty.yaml"; do
        exits 2 "$RKM04" $words --device pmc-2hs --device-option program="$folder/wrong.pmc"
        holds "$complained" "$folder/wrong.pmc:1:7: error: expected a count from 1 to 255" "stderr of $words"
        exits 1 "$RKM04" $words --device pmc-2hs --device-option program="$folder/none.pmc"
        holds "$complained" "cannot read $folder/none.pmc" "stderr of $words"
    done
    local option
    for option in face=hdlc baud=300 first-answer-late=60001 rep-counts=laps abs-needs-home=yes; do
        exits 2 "$RKM04" serve --device pmc-1hs --device-option "$option"
        holds "$complained" "expected" "$option"
    done
    exits 2 "$RKMCTL" -p "$folder/none" pmc
    exits 2 "$RKMCTL" -p "$folder/none" pmc flip
    exits 2 "$RKMCTL" -p "$folder/none" --face rtu pmc position
    exits 2 "$RKMCTL" -p "$folder/none" --face modbus position
}

# What is wrong with the words needs no unit.
test_wrong_words_are_told_where_no_unit_is() {
    local words
    for words in "jog z" jog "move q=3" "move x=" move "speed x=0" "run x 64" "run 64" "stop q" "stop x later" "home xz" \
        "position x" "errors x" "errors clear q" program "parameters put" "store z"; do
        exits 2 "$RKMCTL" -p "$folder/none" pmc $words
        holds "$complained" "pmc" "stderr of $words"
        exits 2 alone "$RKMCTL" pmc $words
    done
    exits 1 "$RKMCTL" -p "$folder/none" pmc jog x
    holds "$complained" "cannot open $folder/none" "stderr"
    exits 1 "$RKMCTL" -p "$folder/none" pmc program put "$folder/nothing.pmc"
    holds "$complained" "cannot read $folder/nothing.pmc" "stderr"
}

test_exec_runs_a_program() {
    program
    exits 0 "$RKM04" exec --device pmc-2hs "$folder/a.pmc"
    holds "$said" "1              200  idle" "the state"
    holds "$said" "2              -21  idle" "the state"
    exits 0 "$RKM04" exec --device pmc-2hs --device-option rep-counts=passes "$folder/a.pmc"
    holds "$said" "1              100  idle" "the state"
    printf '0 RPE\n' >"$folder/a.pmc"
    exits 1 "$RKM04" exec --device pmc-1hs "$folder/a.pmc"
    holds "$complained" "a.pmc:1:1: warning: RPE without a REP before it" "stderr"
    holds "$complained" "error pgm: an error in the program" "stderr"
    printf '0 JMP 0\n' >"$folder/a.pmc"
    exits 124 "$RKM04" exec --device pmc-1hs "$folder/a.pmc"
    holds "$complained" "never ends" "stderr"
}

# The python that knows pymodbus and pyserial; "none".
for python in python3 /usr/bin/python3 none; do
    "$python" -c 'import pymodbus, serial' 2>/dev/null && break
done

client() {
    [[ $python != none ]] || skip_case "there is no pymodbus; apt-get install python3-pymodbus python3-serial"
    exits 0 "$python" -W ignore "${0%/*}/pmc_client.py" "$@"
}

test_the_conformance_kit_passes() {
    [[ $python != none ]] || skip_case "there is no pyserial; apt-get install python3-serial"
    local kit=${0%/*}/../../tools/conformance
    unit
    exits 0 "$python" "$kit" --device pmc-2hs --port "$folder/bus"
    holds "$said" "pass  AS2 text moves" "the kit"
    exits 0 "$python" "$kit" --device pmc-2hs --port "$folder/bus" --no-motion
    holds "$said" "skip  AS2 text moves" "the kit"
    exits 1 "$python" "$kit" --device pmc-1hs --port "$folder/bus" --no-motion
    holds "$said" "FAIL  AS2 text position" "the kit with another device"
    exits 3 "$python" "$kit" --device pmc-2hs --port "$folder/none"
}

test_the_conformance_kit_passes_by_modbus() {
    [[ $python != none ]] || skip_case "there is no pyserial; apt-get install python3-serial"
    unit --device-option face=modbus
    exits 0 "$python" "${0%/*}/../../tools/conformance" --device pmc-2hs --face modbus --port "$folder/bus"
    holds "$said" "pass  AB5 modbus moves" "the kit"
}

test_pymodbus_on_the_pty() {
    unit --device-option face=modbus
    client modbus "$folder/bus"
}

# address: where the server listens.
address() {
    sed -n "s/.*: modbus-tcp on //p" "$folder/bus.err"
}

test_pymodbus_over_tcp_is_recorded_and_replayed() {
    [[ $python != none ]] || skip_case "there is no pymodbus; apt-get install python3-pymodbus"
    unit --service modbus-tcp=127.0.0.1:0 --record "$folder/a.record"
    client modbus "$(address)"
    exits 0 pmc position # lines of text on the bus, all the while
    holds "$said" "y: -1000" "the position"
    exits 0 "$RKMCTL" -c "$folder/bus.control" shutdown
    exits 0 "$RKM04" replay "$folder/a.record"
    exits 2 "$RKM04" serve --device pmc-2hs --service plccoms=127.0.0.1:0
    holds "$complained" "modbus-tcp" "the servers there are"
}

test_mbpoll_over_tcp() {
    local at
    command -v mbpoll >/dev/null || skip_case "there is no mbpoll; apt-get install mbpoll"
    unit --service modbus-tcp=127.0.0.1:0
    at=$(address)
    exits 0 mbpoll -o 10 -m tcp -a 1 -p "${at##*:}" -0 -1 -q -t 4 -r 1102 -c 2 "${at%:*}"
    holds "$said" "[1103]: 	400" "the acceleration"
}

test_pyserial_speaks_the_lines() {
    unit
    client lines "$folder/bus"
}

test_a_home_search_with_a_plant_is_recorded_and_replayed() {
    printf 'motors: {1: {offset: 5000}}\nswitches:\n' >"$folder/plant.yaml"
    printf ' - {motor: 1, input: x.near, at_most: 1000, hysteresis: 10}\n' >>"$folder/plant.yaml"
    printf ' - {motor: 1, input: x.home, at_most: 200, hysteresis: 5}\n' >>"$folder/plant.yaml"
    unit --clock stepped --plant "$folder/plant.yaml" --record "$folder/a.record" --trace "$folder/a.csv"
    export RKM04_CONTROL=$folder/bus.control
    exits 0 "$RKMCTL" call pmc.home '{"axes": "x"}'
    exits 0 "$RKMCTL" advance m1.state=search m1.fault!=hl- --limit 1s
    exits 2 "$RKMCTL" wait m1.fault=no_label
    holds "$complained" 'expected one of none, sl+, sl-, hl+' "the faults of the device"
    exits 0 "$RKMCTL" advance t=2s
    exits 0 "$RKMCTL" snapshot half
    exits 0 "$RKMCTL" advance m1.idle --limit 10s
    exits 0 "$RKMCTL" --json state
    holds "$said" '"t_us":3883' "AX35: the search ends in slot 3883"
    holds "$said" '"position":0,"state":"idle"' "AX35: the counter is 0"
    holds "$said" '"true_position":200' "AX35: at 200"
    holds "$said" '"homed":true' "AX35: homed"
    exits 0 "$RKMCTL" restore half
    exits 0 "$RKMCTL" advance m1.idle --limit 10s
    exits 0 "$RKMCTL" --json state
    holds "$said" '"true_position":200' "the same after a restore"
    exits 0 "$RKMCTL" shutdown
    grep -q '^431000.000,m1,step' "$folder/a.csv" || fail "AX35: step 1 has no pulse at 431 000 us"
    exits 0 "$RKM04" replay "$folder/a.record"
}

test_traces_have_the_names_and_fractions_of_us() {
    program
    exits 0 "$RKM04" exec --device pmc-2hs --trace "$folder/a.vcd" "$folder/a.pmc"
    holds "$(head -n 40 "$folder/a.vcd")" "\$timescale 1 ns" "VCD"
    holds "$(head -n 40 "$folder/a.vcd")" "x.out0" "VCD"
    exits 0 "$RKM04" exec --device pmc-2hs --trace - "$folder/a.pmc"
    holds "$(head -n 20 <<<"$said")" "3236.125,m1,step,1" "CSV"
}

test_a_scenario_speaks_to_both_faces() {
    cat >"$folder/a.yaml" <<'END'
device: pmc-2hs
allow_faults: true
steps:
  - {message: '"POS"', answer: '"POS 00000000,00000000"'}
  - {message: '"PIC 10"', answer: none, within: 10ms}
  - wait: {idle: true}
  - expect: {motor: 1, position: 10}
  - {call: pmc.move, params: {x: -5, relative: true}}
  - wait: {idle: true}
  - expect: {motor: 1, position: 5}
  - di: {x.lmt-: 1}
  - {message: '"JOG -X"', answer: none, within: 10ms}
  - wait: {motor: 1, fault: hl-}
  - expect: {motor: 1, position: 5}
END
    exits 0 "$RKM04" test "$folder/a.yaml"
    cat >"$folder/b.yaml" <<'END'
device: pmc-1hs
face: modbus
steps:
  - {message: '03 04 4E 00 01', answer: '03 02 00 0A'}
  - {message: '03 05 00 00 01', answer: '83 02'}
END
    exits 0 "$RKM04" test "$folder/b.yaml"
}

test_the_files_of_a_scenario_are_in_the_flash_of_its_unit() {
    printf 'X: 00 ABS 7 V3\nX: 01 END\n' >"$folder/a.pmc"
    printf '[X]\nmultiplier = 20\n' >"$folder/a.parameters"
    cat >"$folder/a.yaml" <<'END'
device: pmc-1hs
face: modbus
program: a.pmc
parameters: a.parameters
steps:
  - {message: '03 04 4E 00 01', answer: '03 02 00 14'}
  - {call: pmc.run}
  - wait: {motor: 1, position: 7}
END
    exits 0 "$RKM04" test "$folder/a.yaml"
    exits 0 "$RKM04" test "$(dirname "$0")/../../examples/pmc-drill.yaml"
    printf '\0' >>"$folder/a.pmc"
    exits 2 "$RKM04" test "$folder/a.yaml"
    holds "$complained" "a.yaml:3:10: error: cannot read $folder/a.pmc: expected text without the character 0" "a zero in a file"
}

test_bytes_may_take_no_time() {
    printf 'device: pmc-1hs\nbaud: 0\nsteps:\n  - {message: %s, answer: %s, within: 1ms}\n' "'\"POS\"'" "'\"POS 00000000\"'" \
        >"$folder/a.yaml"
    exits 0 "$RKM04" test "$folder/a.yaml"
    sed -i 's/baud: 0/baud: 115200/; s/1ms/2ms/' "$folder/a.yaml"
    exits 0 "$RKM04" test "$folder/a.yaml"
    sed -i 's/baud: 115200/baud: 19201/' "$folder/a.yaml"
    exits 2 "$RKM04" test "$folder/a.yaml"
    holds "$complained" "a.yaml:2:7: error" "a wrong speed"
}

# A program that is longer than a name, with a comment that is not UTF-8.
test_a_recording_has_the_files_of_its_unit() {
    { printf '# h\341lka\n%0300d\n' 0 | sed '2s/^/# /'; printf 'X: 00 ABS 7 V3\nX: 01 END\n'; } >"$folder/a.pmc"
    printf '[X]\nmultiplier = 20 # h\341lka\n' >"$folder/a.parameters"
    cat >"$folder/a.yaml" <<'END'
device: pmc-1hs
program: a.pmc
parameters: a.parameters
steps:
  - {call: pmc.run}
  - wait: {motor: 1, position: 7}
  - expect: {motor: 1, position: 8}
END
    exits 3 "$RKM04" test --records "$folder" "$folder/a.yaml"
    rm "$folder/a.pmc" "$folder/a.parameters"
    exits 0 "$RKM04" replay "$folder/a.record"
    holds "$said" "the same" "the replay"
    holds "$said" "7 pulses" "the replay"
}

test_the_wire_log_says_what_frames_mean() {
    unit --device-option face=modbus --wire "$folder/bus.log"
    exits 0 "$RKMCTL" -p "$folder/bus" --face modbus pmc jog x+
    exits 0 "$RKMCTL" -c "$folder/bus.control" shutdown
    holds "$(<"$folder/bus.log")" "write 0000 0120: continuous move" "the log"
}

test_the_panel_has_the_axes() {
    unit
    exits 0 "$RKMCTL" -c "$folder/bus.control" watch --once
    holds "$said" "pmc-2hs unit 1" "the panel"
    exits 0 "$RKMCTL" -c "$folder/bus.control" state
    holds "$said" "pmc-2hs unit 1" "state"
    [[ $said != *"of 700 commands"* ]] || fail "state: has numbers of an RKM04: $said"
}

test_a_file_of_another_kind_does_not_fill_the_terminal() {
    yes 'no program' | head -n 5000 >"$folder/wrong.pmc"
    exits 1 "$RKM04" exec --device pmc-2hs "$folder/wrong.pmc"
    same 1001 "$(wc -l <<<"$complained")" "lines of errors"
    holds "$complained" "wrong.pmc: 4000 more errors are not shown" "the last line"
}

run_cases "$@"
