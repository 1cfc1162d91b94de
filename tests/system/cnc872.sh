#!/bin/bash
# SPDX-License-Identifier: MIT
# The CNC872 as programs see it: examples/cnc872 in serve, exec, test and from Python; what is refused; its backup memory in a
# file.

. "$(dirname "$0")/lib.sh"

example=$(cd "$(dirname "$0")/../../examples/cnc872" && pwd)

# serve_cnc OPTION...: the emulator with the control socket $folder/control, and no bus.
serve_cnc() {
    start cnc "$RKM04" serve --device cnc872 --clock stepped --control "$folder/control" "$@"
    soon "the cnc is ready" ready cnc
}

# call METHOD PARAMETER...: a method of the control socket; its answer is in $said.
call() {
    exits 0 "$RKMCTL" -c "$folder/control" call "$@"
}

test_NL1_the_mill_is_supervised_from_python() {
    local mill=(--config "$example/mill.xml" --plc "$example/mill.plc" --nc "$example/part.nc") over_the_socket
    serve_cnc "${mill[@]}"
    exits 0 python3 "$example/supervise.py" "$folder/control"
    over_the_socket=$said
    start tcp "$RKM04" serve --device cnc872 --clock stepped --control tcp:0 --control-file "$folder/file" "${mill[@]}"
    soon "the other one is ready" ready tcp
    exits 0 python3 "$example/supervise.py" "$folder/file"
    same "$over_the_socket" "$said" "what it prints with a control file"
    same "T 3234: X 15.005 mm, feed 50 %
T 5229: X 25.003 mm, feed 100 %
T 7300: X 24.995 mm, feed 50 %
T 9295: X 14.998 mm, feed 100 %
end after 11011 ms, X 10.000 mm" "$said" "what the supervisor prints"
}

test_NU1_the_part_passes_its_scenario() {
    exits 0 "$RKM04" test "$example/part.yaml"
    holds "$said" "pass " "the report"
}

# With another number of the alarm the scenario fails.
test_NU1_the_shaft_passes_its_scenario_on_the_lathe() {
    exits 0 "$RKM04" check "$example/lathe/lathe.xml" "$example/lathe/lathe.plc"
    exits 0 "$RKM04" test "$example/lathe/shaft.yaml"
    holds "$said" "pass " "the report"
    cp "$example"/lathe/* "$folder"
    sed -i 's/WAITED,2000,LATE_TAIL,22h/WAITED,2000,LATE_TAIL,23h/' "$folder/lathe.plc"
    exits 3 "$RKM04" test --no-records "$folder/shaft.yaml"
    holds "$said" "PLC_ERROR" "the report of another alarm"
}

# cnc WORD...: rkmctl cnc; its answer is in $said.
cnc() {
    exits 0 "$RKMCTL" -c "$folder/control" cnc "$@"
}

test_NL1_rkmctl_cnc_does_what_an_operator_and_a_plc_author_do() {
    printf 'G1 X10 F1000\nG1 Q1\n' >"$folder/bad.nc"
    printf 'G1 X10 F1000\nM30\n' >"$folder/a.nc"
    serve_cnc
    exits 2 "$RKMCTL" -c "$folder/control" cnc load "$folder/bad.nc"
    holds "$complained" "bad.nc:2:4: error: expected" "a wrong program"
    cnc load "$folder/a.nc"
    cnc panel feed=50
    cnc start
    exits 0 "$RKMCTL" -c "$folder/control" wait --advance --limit 10s 'cell.B_INK_EX[0]>100000000'
    cnc get PO_STOP FEED_OVR_MULTIPLIER
    same $'PO_STOP=0\nFEED_OVR_MULTIPLIER=1000' "$said" "cnc get"
    cnc stop
    exits 0 "$RKMCTL" -c "$folder/control" advance 2s
    cnc get PO_STOP
    same "PO_STOP=1" "$said" "after stop"
    cnc reset
    exits 0 "$RKMCTL" -c "$folder/control" advance 100ms
    cnc panel mode=manual
    cnc jog X+
    exits 0 "$RKMCTL" -c "$folder/control" wait --advance --limit 10s 'm1.position>9000'
    cnc jog X
    exits 0 "$RKMCTL" -c "$folder/control" wait --advance --limit 10s m1.idle
    cnc set REQ_BACKUP_MEM=0
    cnc cells PO_ST
    holds "$said" "PO_STOP" "the list"
    exits 0 "$RKMCTL" -c "$folder/control" --json cnc get PO_STOP
    holds "$said" '"PO_STOP":' "--json"
}

test_every_example_of_the_document_over_the_control_socket_is_so() {
    exits 0 python3 "${0%/*}/control_examples.py" "${0%/*}/../../docs/CNC872.md" -- --device cnc872
}

test_NL1_what_rkmctl_cnc_cannot_do_is_said() {
    serve_cnc
    exits 2 "$RKMCTL" -c "$folder/control" cnc get NO_CELL
    holds "$complained" "NO_CELL" "an unknown cell"
    [[ $complained != *mean* ]] || fail "nothing is near: $complained"
    exits 2 "$RKMCTL" -c "$folder/control" cnc get po_stp
    holds "$complained" "there is no cell; did you mean \`PO_STOP'?" "a slip in a cell"
    exits 2 "$RKMCTL" -c "$folder/control" wait 'cell.B_PLO[0]>5'
    holds "$complained" "did you mean \`B_POL[0]'?" "a slip in a condition"
    exits 2 "$RKMCTL" -c "$folder/control" cnc get PO_STOP+1
    [[ $complained != *mean* ]] || fail "another fault: $complained"
    exits 2 "$RKMCTL" -c "$folder/control" cnc panel fed=50
    holds "$complained" "did you mean \`feed'?" "a slip in a name of the panel"
    exits 2 "$RKMCTL" -c "$folder/control" cnc get
    exits 2 "$RKMCTL" -c "$folder/control" cnc set PO_STOP
    exits 2 "$RKMCTL" -c "$folder/control" cnc jog +
    exits 2 "$RKMCTL" -c "$folder/control" cnc home
    exits 2 "$RKMCTL" -c "$folder/control" cnc begin
    holds "$complained" "cells, start, stop, reset, jog, home, panel, load or plc, found 'begin'" "an unknown word"
    exits 1 "$RKMCTL" -c "$folder/control" cnc load "$folder/none.nc"
    holds "$complained" "cannot read $folder/none.nc" "a missing file"
    exits 2 "$RKMCTL" -c "$folder/control" cnc home Q
    exits 2 "$RKMCTL" -c "$folder/control" wait 'cell.PO_STOP'
}

test_NU1_exec_runs_an_nc_program_to_its_end() {
    printf 'G1 X10 Y-2 F1000\nG0 Z5 M30\n' >"$folder/a.nc"
    exits 0 "$RKM04" exec --device cnc872 "$folder/a.nc"
    holds "$said" "10000  idle" "positions"
    holds "$said" "-2000  idle" "positions"
    holds "$said" "5000  idle" "positions"
}

# An author writes, loads, looks, without another start of the emulator.
test_rkmctl_loads_plc_programs_and_switches() {
    printf 'DATA\nNEAR BIT 0\nDATA_END\nMODULE_MAIN\n LDR NEAR\n WR STOP_REQ\nMODULE_MAIN_END\n' >"$folder/a.plc"
    printf 'DATA\nNEAR BITS 0\nDATA_END\n' >"$folder/bad.plc"
    printf 'switches: [{cell: NEAR, axis: X, at_least: 2000}]\n' >"$folder/a.yaml"
    printf 'G1 X3 F1000\n' >"$folder/a.nc"
    serve_cnc
    exits 2 "$RKMCTL" -c "$folder/control" cnc load "$folder/bad.plc"
    holds "$complained" "$folder/bad.plc:2:6: error: " "a wrong program"
    exits 0 "$RKMCTL" -c "$folder/control" --json cnc load "$folder/a.yaml" "$folder/a.nc" "$folder/a.plc"
    holds "$said" '"blocks":1,"instructions":3' "the answer"
    cnc start
    exits 0 "$RKMCTL" -c "$folder/control" wait --advance --limit 10s 'cell.NEAR=1'
    exits 1 "$RKMCTL" -c "$folder/control" cnc load "$folder/a.plc"
    holds "$complained" "an axis moves, or a block is in its motion or delay: stop it and RESET" "while it moves"
    exits 0 "$RKMCTL" -c "$folder/control" wait --advance --limit 10s 'cell.PO_STOP=1'
    exits 2 "$RKMCTL" -c "$folder/control" cnc load "$folder/a.plc" "$folder/bad.plc"
    holds "$complained" "bad.plc: expected one file of a kind" "two PLC programs"
    exits 2 "$RKMCTL" -c "$folder/control" cnc load "$example/mill.xml"
    holds "$complained" "start it with --config $example/mill.xml" "a configuration"
    exits 2 "$RKMCTL" -c "$folder/control" cnc load
    holds "$complained" "cnc load: expected FILE..." "no file"
}

test_rkmctl_lists_the_plc_program_that_runs() {
    printf 'DATA\nGO BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n LDR GO\n EX0\nMODULE_BLOCK_INIT_END\n' >"$folder/a.plc"
    printf 'G1 X3 F1000\n' >"$folder/a.nc"
    serve_cnc --plc "$folder/a.plc" --nc "$folder/a.nc"
    cnc start
    exits 0 "$RKMCTL" -c "$folder/control" advance 5ms
    cnc plc 4 3
    same "T 4  RLO 0  DR 1  DR_REAL 0  BX 0
MODULE_BLOCK_INIT: 2 instructions, at most 2
MODULE_BLOCK_INIT waits in line 6
     4                 MODULE_BLOCK_INIT
     5              0   LDR GO
     6 >                EX0" "$said" "the listing"
    exits 2 "$RKMCTL" -c "$folder/control" cnc plc 0
    holds "$complained" "cnc plc: expected the first line" "a wrong line"
    exits 2 "$RKMCTL" -c "$folder/control" cnc plc 1 501
    exits 2 "$RKMCTL" -c "$folder/control" cnc plc 1 2 3
}

# A PLC program goes on for ever; what it was started for does not.
test_NU1_exec_ends_with_the_nc_program_though_a_plc_program_runs() {
    local machine=(--config "$example/mill.xml" --plc "$example/mill.plc" --machine "$example/mill.machine.yaml")
    exits 0 "$RKM04" exec --device cnc872 "${machine[@]}" "$example/part.nc"
    holds "$said" "at 9.015000 s: finished" "exec"
    same 6 "$(wc -l <<<"$said")" "lines: three axes alone"
    exits 0 "$RKM04" plot --device cnc872 "${machine[@]}" "$example/part.nc" -o "$folder/part.svg"
    printf '50ms di 1 1\n' >"$folder/stimulus"
    exits 1 "$RKM04" exec --device cnc872 "${machine[@]}" --stimulus "$folder/stimulus" "$example/part.nc"
    holds "$complained" "expected an input (the device has none), found '1'" "a stimulus"
}

# All axes have one program.
test_NU1_exec_reports_a_stop_once() {
    printf 'MODULE_BLOCK_INIT\n FL 1,STOP_REQ\nMODULE_BLOCK_INIT_END\n' >"$folder/stop.plc"
    exits 1 "$RKM04" exec --device cnc872 --plc "$folder/stop.plc" "$example/part.nc"
    same "rkm04 exec: motor 1: the program is stopped: START makes it go on" "$complained" "a stop that the PLC program makes"
}

test_NU1_exec_reports_a_start_that_is_dropped() {
    printf 'MODULE_MAIN\n FL 1,START_DISABLE\nMODULE_MAIN_END\n' >"$folder/never.plc"
    exits 1 "$RKM04" exec --device cnc872 --plc "$folder/never.plc" "$example/part.nc"
    same "rkm04 exec: motor 1: start refused: START_DISABLE is 1" "$complained" "a PLC program that disables it"
    printf 'MODULE_MAIN\n FL 1,STOP_REQ\nMODULE_MAIN_END\n' >"$folder/stop.plc"
    exits 1 "$RKM04" exec --device cnc872 --plc "$folder/stop.plc" "$example/part.nc"
    same "rkm04 exec: motor 1: start refused: a stop came before the start was done" "$complained" "one that stops it"
}

test_NU1_exec_reports_a_block_that_is_refused() {
    printf 'G1 X1 F1000\nS9000 M3\n' >"$folder/fast.nc"
    exits 1 "$RKM04" exec --device cnc872 "$folder/fast.nc"
    same "rkm04 exec: motor 1: a block is refused: S is outside of the limits of the gear" \
        "$complained" "a speed that is too high"
}

test_NU1_exec_runs_one_nc_program() {
    printf 'G1 X1 F1000\n' >"$folder/a.nc"
    printf 'G1 Y1 F1000\n' >"$folder/b.nc"
    exits 1 "$RKM04" exec --device cnc872 "$folder/a.nc" "$folder/b.nc"
    holds "$complained" "b.nc: error: another NC program has just been started" "the second one"
    holds "$said" "1000  idle" "the first one"
}

test_NU1_what_is_about_a_bus_is_refused() {
    local option
    for option in "--link $folder/l" "--tcp 127.0.0.1:0" "--rfc2217 127.0.0.1:0" "--port /dev/null" "--wire $folder/w.log" \
        "--node 1" "--node 2" "--baud 0" "--baud 19200" "--baud 9600" "--turnaround 0" "--turnaround 5" --strict-line \
        "--lines 1" "--lines 2" "--rts driver" "--rts toggles" --verbose --exit-when-idle=1 "--coverage $folder/c" \
        "--min-coverage 0" "--wine $folder:COM3"; do
        exits 2 "$RKM04" serve --device cnc872 $option
        holds "$complained" "cnc872 has no bus" "serve $option"
    done
    for option in "--service modbus-tcp=127.0.0.1:0" "--framing plain" "--readings hold-exit=latch" "--version-text x"; do
        exits 2 "$RKM04" serve --device cnc872 $option
        holds "$complained" "the device cnc872 has no" "serve $option"
    done
    printf 'motors: {1: {turn: 400}}\n' >"$folder/p.yaml"
    exits 2 "$RKM04" serve --device cnc872 --plant "$folder/p.yaml"
    holds "$complained" "make no steps" "serve --plant"
    exits 2 "$RKM04" serve --device cnc872 --framing plain
    holds "$complained" "no such option" "serve --framing"
}

# Keys of scenarios, lines of stimulus files, methods of the control socket.
test_NU1_what_is_about_a_bus_is_refused_everywhere() {
    local key
    for key in "units: 1" "baud: 0" "baud: 19200" "turnaround: 1ms"; do
        printf 'device: cnc872\n%s\nsteps: [advance: 1ms]\n' "$key" >"$folder/a.yaml"
        exits 2 "$RKM04" test "$folder/a.yaml"
        holds "$complained" "a.yaml:2:" "$key"
        holds "$complained" "the device cnc872 has no bus" "$key"
    done
    for key in "plant: {motors: {1: {turn: 400}}}" "di: {1: 1}" "steps: [message: '04']" "steps: [bytes: '04']" \
        "steps: [set: R]" "steps: [pulses: {motor: 1, count: 0}]" "steps: [di: {1: 1}]"; do
        printf 'device: cnc872\n%s\n' "$key" >"$folder/a.yaml"
        [[ $key == steps* ]] || echo 'steps: [advance: 1ms]' >>"$folder/a.yaml"
        exits 2 "$RKM04" test "$folder/a.yaml"
        holds "$complained" "a.yaml:2:" "$key"
        holds "$complained" cnc872 "$key"
    done
    printf 'G1 X1 F1000\n' >"$folder/a.nc"
    for key in "1ms di 01 1" "1ms message 04"; do
        echo "$key" >"$folder/stimulus"
        exits 1 "$RKM04" exec --device cnc872 --stimulus "$folder/stimulus" "$folder/a.nc"
        holds "$complained" "stimulus:1:" "$key"
    done
    exits 2 "$RKM04" exec --device cnc872 "1=$folder/a.nc"
    holds "$complained" "for all motors" "exec with a motor"
    serve_cnc
    exits 1 "$RKMCTL" -c "$folder/control" call switch node=1
    holds "$complained" "the device cnc872 has no bus" "switch"
}

test_NP8_wrong_files_are_named_with_line_and_column() {
    exits 2 "$RKM04" serve --device cnc872 --config "$example/part.nc"
    holds "$complained" "part.nc:1:1: error: expected ChannelConfig" "serve --config"
    printf 'MODULE_MAIN\n TIM 3\nMODULE_MAIN_END\n' >"$folder/bad.plc"
    exits 2 "$RKM04" serve --device cnc872 --plc "$folder/bad.plc"
    holds "$complained" "bad.plc:2:" "serve --plc"
    printf 'G1 4=3\n' >"$folder/bad.nc"
    exits 2 "$RKM04" exec --device cnc872 --nc "$folder/bad.nc"
    holds "$complained" "bad.nc:1:" "exec --nc"
    printf 'switches:\n  - {cell: PO_F, axis: X, at_least: 1}\n' >"$folder/bad.yaml"
    exits 2 "$RKM04" serve --device cnc872 --machine "$folder/bad.yaml"
    holds "$complained" "bad.yaml:2:12: error: expected a bit that may be written" "serve --machine"
    [[ $complained != *mean* ]] || fail "it is known: $complained"
    printf 'switches:\n  - {cell: KXH0, axis: X, at_least: 1}\n' >"$folder/bad.yaml"
    exits 2 "$RKM04" serve --device cnc872 --machine "$folder/bad.yaml"
    holds "$complained" "did you mean \`KHX0'?" "a slip in a machine file"
    printf 'switches:\n  - {cell: KH40, axis: 4, at_least: 1}\n' >"$folder/bad.yaml"
    exits 2 "$RKM04" serve --device cnc872 --machine "$folder/bad.yaml"
    holds "$complained" "bad.yaml: error: switch 1: the configuration has no axis 4" "serve --machine"
}

# The PLC program is named after the NC program that needs nothing of it, the switches before the program whose bits they are.
test_options_may_come_in_any_order() {
    printf 'DATA\nEND_I BIT 0\nDATA_END\nMODULE_MAIN\n LDR END_I\n WR STOP_REQ\nMODULE_MAIN_END\n' >"$folder/s.plc"
    printf 'switches: [{cell: END_I, axis: 4, at_least: 3000}]\n' >"$folder/s.yaml"
    printf '<ChannelConfig><Axis Name="4"/></ChannelConfig>' >"$folder/s.xml"
    printf 'G1 A4=10 F1000\n' >"$folder/s.nc"
    serve_cnc --machine "$folder/s.yaml" --nc "$folder/s.nc" --plc "$folder/s.plc" --config "$folder/s.xml"
    call cnc.panel start=true
    call cnc.exchange slots=1000 'get=["PO_STOP", "B_INK_EX[3]"]'
    holds "$said" '"PO_STOP":1' "the switch stops the axis"
}

# Texts that are not UTF-8, of some MiB together.
test_a_recording_has_the_files_of_its_machine() {
    local name
    { printf '<?xml version="1.0"?>\n<!-- h\341lka %0900000d -->\n' 0; sed 1d "$example/mill.xml"; } >"$folder/a.xml"
    { printf '; h\341lka %0900000d\n' 0; cat "$example/mill.plc"; } >"$folder/a.plc"
    { cat "$example/part.nc"; yes $'(h\341)' | head -n 200000; } >"$folder/a.nc"
    sed "s/mill\.plc/a.plc/; s/mill\.xml/a.xml/; s/part\.nc/a.nc/; \$a\  - expect: {motor: 1, position: 1}" "$example/part.yaml" \
        >"$folder/a.yaml"
    cp "$example/mill.machine.yaml" "$folder"
    exits 3 "$RKM04" test --records "$folder" "$folder/a.yaml"
    for name in xml plc nc; do rm "$folder/a.$name"; done
    exits 0 "$RKM04" replay --until 3s "$folder/a.record"
    holds "$said" "the same" "the replay"
}

# A million blocks are the limit of an NC program, 32 MiB that of its file, 10 000 that of switches.
test_NL4_files_may_be_as_long_as_their_limits() {
    { echo 'G1 F1000'; yes 'X1 Y-2.5' | head -n 999999; } >"$folder/a.nc"
    exits 0 "$RKM04" check "$folder/a.nc"
    serve_cnc --nc "$folder/a.nc"
    call cnc.state
    holds "$said" '"blocks":1000000' "the program"
    call shutdown
    status_of "$started"
    echo 'X1' >>"$folder/a.nc"
    exits 2 "$RKM04" serve --device cnc872 --nc "$folder/a.nc"
    holds "$complained" "a.nc:1000001:1: error: expected at most 1000000 blocks" "one block more"
    { echo 'G1 X1 F1000'; yes '(                            )' | head -c $((32 << 20)); } >"$folder/b.nc"
    exits 1 "$RKM04" serve --device cnc872 --nc "$folder/b.nc"
    holds "$complained" "b.nc: it is longer than 32 MiB" "a file that is too long"
    printf 'device: cnc872\nnc: b.nc\nsteps: [advance: 1ms]\n' >"$folder/a.yaml"
    exits 2 "$RKM04" test "$folder/a.yaml"
    holds "$complained" "b.nc: it is" "the same in a scenario"
    { echo 'switches:'; yes '  - {cell: KHX0, axis: X, at_least: 5, at_most: 6}' | head -n 10000; } >"$folder/m.yaml"
    serve_cnc --machine "$folder/m.yaml"
    call advance 'ticks="3ms"'
    call shutdown
    status_of "$started"
    echo '  - {cell: KHX1, axis: X, at_least: 5}' >>"$folder/m.yaml"
    exits 2 "$RKM04" serve --device cnc872 --machine "$folder/m.yaml"
    holds "$complained" "m.yaml:2:3: error: expected at most 10000 switches" "one switch more"
}

test_NL2_rkmctl_shows_cells_that_change() {
    printf 'G1 X10 F1000\n' >"$folder/a.nc"
    serve_cnc --nc "$folder/a.nc"
    start events "$RKMCTL" -c "$folder/control" events cell=PO_F cell=DWRD.B_INK count=3
    soon "it listens" grep -q listening "$folder/events.err"
    call cnc.panel start=true
    call advance 'ticks="1s"'
    status_of "$started"
    same "0.001000 s  unit 1  cell PO_F 1
0.002000 s  unit 1  cell DWRD.B_INK 4
0.003000 s  unit 1  cell DWRD.B_INK 12" "$(cat "$folder/events.out")" "the events"
    exits 2 "$RKMCTL" -c "$folder/control" events cell=NO_CELL
    holds "$complained" "NO_CELL" "the refusal"
}

test_NL2_what_cells_have_been_is_collected_until_a_client_asks() {
    cat >"$folder/blip.plc" <<'PLC'
DATA
COUNT DW 0
PHASE DB 0
BLIP BIT 0
DATA_END
MODULE_MAIN
  LOD COUNT
  AD CNST.1
  STO COUNT
  LOD PHASE
  AD CNST.1
  STO PHASE
  EQ CNST.100
  WR BLIP
  JL0 DONE
  LOD CNST.0
  STO PHASE
DONE:
MODULE_MAIN_END
PLC
    serve_cnc --plc "$folder/blip.plc"
    exits 0 python3 "$(dirname "$0")/cnc_collect.py" "$folder/control"
    same "done" "$said" "what the client prints"
}

test_NL2_events_of_cells_wait_for_a_client_that_advances_and_reads_late() {
    serve_cnc
    exits 0 python3 "$(dirname "$0")/cnc_client.py" "$folder/control" "$started"
    same "['DWRD.FILETIME_INFO.LOW_FILETIME']
True
{'t_us': 4000001} {64} 4000 True" "$said" "what the client prints"
}

# The command line with all files, as docs/CNC872.md has it.
test_NU1_a_machine_is_served_with_all_its_files() {
    serve_cnc --config "$example/mill.xml" --nc "$example/part.nc" --plc "$example/mill.plc" \
        --machine "$example/mill.machine.yaml" --backup "$folder/mill.backup"
    call cnc.set 'cells={"PLC_MEM_BACKUP[9999]": 5, "REQ_BACKUP_MEM": 1}'
    call cnc.exchange 'get=["REQ_BACKUP_MEM"]'
    holds "$said" '"REQ_BACKUP_MEM":0' "it is saved"
    kill -KILL "$started"
    status_of "$started"
    printf 'G1 X1 F1000\n' >"$folder/a.nc"
    printf 'MODULE_MAIN\n LOD PLC_MEM_BACKUP[9999]\n AD CNST.1\n STO PLC_MEM_BACKUP[9999]\nMODULE_MAIN_END\n' >"$folder/a.plc"
    exits 0 "$RKM04" exec --device cnc872 --plc "$folder/a.plc" --nc "$folder/a.nc" --backup "$folder/mill.backup"
    holds "$said" "1000  idle" "exec runs the program of --nc"
    printf 'device: cnc872\nbackup: mill.backup\nsteps:\n  - expect: {cell: {"PLC_MEM_BACKUP[9999]": %d}}\n%s\n' 100 \
        '  - call: cnc.exchange
    params: {set: {"PLC_MEM_BACKUP[9999]": 7, REQ_BACKUP_MEM: 1}, get: [REQ_BACKUP_MEM]}
    result: {cells: {REQ_BACKUP_MEM: 0}}' >"$folder/a.yaml"
    exits 0 "$RKM04" test "$folder/a.yaml"
    exits 0 "$RKM04" test "$folder/a.yaml" # the first run has not written the file
    echo '  - expect: {cell: {"PLC_MEM_BACKUP[9999]": 8}}' >>"$folder/a.yaml"
    exits 3 "$RKM04" test --records "$folder" "$folder/a.yaml"
    rm "$folder/mill.backup"
    exits 0 "$RKM04" replay "$folder/a.record"
    holds "$said" "the same" "the replay"
}

test_NO3_a_backup_that_cannot_be_is_refused() {
    exits 2 "$RKM04" serve --backup "$folder/b"
    holds "$complained" "the device rkm04 has no backup memory: expected --flash" "serve"
    exits 2 "$RKM04" serve --device cnc872 --backup "$folder/b" --flash "$folder/c"
    holds "$complained" "either --flash or --backup" "serve with both"
    exits 2 "$RKM04" serve --device cib --flash "$folder/b"
    holds "$complained" "the device cib has no flash" "serve of a device without flash"
    printf 'G1 X1 F1000\n' >"$folder/a.nc"
    exits 2 "$RKM04" exec --backup "$folder/b" "$folder/a.nc"
    holds "$complained" "the device rkm04 has no backup memory" "exec"
    exits 1 "$RKM04" exec --device cnc872 --backup "$folder/no/b" --nc "$folder/a.nc"
    holds "$complained" "rkm04 exec: cannot open the backup image $folder/no/b" "exec in a folder that is not there"
    cp "$folder/a.nc" "$folder/b.nc"
    exits 1 "$RKM04" exec --device cnc872 --backup "$folder/b.nc" --nc "$folder/a.nc"
    holds "$complained" "b.nc has 12 bytes and is no backup image" "exec with another file"
    exits 1 "$RKM04" serve --device cnc872 --backup "$folder"
    holds "$complained" "backup image" "serve with a folder"
    exits 2 "$RKM04" exec --device cnc872
    holds "$complained" "no program given" "exec without a program"
    printf 'device: cnc872\nbackup: a.nc\nsteps:\n  - advance: 1ms\n' >"$folder/a.yaml"
    exits 2 "$RKM04" test "$folder/a.yaml"
    holds "$complained" "a.yaml:2:9: error: $folder/a.nc has 12 bytes and is no backup file" "a scenario"
    printf 'backup: b\nsteps:\n  - advance: 1ms\n' >"$folder/a.yaml"
    exits 2 "$RKM04" test "$folder/a.yaml"
    holds "$complained" "a.yaml:1:1: error: expected" "a scenario of another device"
    holds "$complained" 'found "backup"' "a scenario of another device"
}

test_NO3_the_backup_memory_is_kept_in_a_file() {
    serve_cnc --flash "$folder/backup.img"
    call cnc.set 'cells={"PLC_MEM_BACKUP[5]": 77}'
    call shutdown
    status_of "$started"
    serve_cnc --flash "$folder/backup.img"
    call cnc.get 'cells=["PLC_MEM_BACKUP[5]"]'
    holds "$said" '"PLC_MEM_BACKUP[5]":77' "the memory after a regular end"
}

# A fault that is none of a motor.
test_a_critical_error_of_the_panel_is_reported() {
    serve_cnc
    call cnc.panel rtm=7
    call advance ticks=5ms
    call state
    holds "$said" '"fault":"critical"' "the state"
    grep -q 'unit 1: fault critical$' "$folder/cnc.err" || fail "the log does not have the fault"
    printf 'device: cnc872\nsteps:\n  - {call: cnc.panel, params: {rtm: 7}}\n  - advance: 5ms\n' >"$folder/fault.yaml"
    exits 3 "$RKM04" test --no-records "$folder/fault.yaml"
    holds "$said" "expected no unit in fault; seen unit 1 in fault: critical; at tick 1000" "the scenario"
}

run_cases "$@"
