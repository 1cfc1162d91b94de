#!/bin/bash
# SPDX-License-Identifier: MIT
# --trace FILE.vcd, .csv, .jsonl of rkm04 exec and rkm04 serve: one run in every format says the same, read by programs that
# others wrote: GTKWave's vcd2fst and fst2vcd, sigrok-cli (the library of PulseView), Python's JSON.

. "$(dirname "$0")/lib.sh"

for tool in vcd2fst fst2vcd sigrok-cli python3; do
    if ! command -v $tool >/dev/null; then
        skip_all "there is no $tool (packages gtkwave, sigrok-cli, python3)"
    fi
done

# traced FILE...: the same two seconds of four motors, a trace each.
traced() {
    local file
    cd "$folder" || exit 1
    printf '%s\n' 'S300 V9000 A60000 @1 T85 F2000 R T02 D R C02 C85 W3 J1' >a.rks
    printf '%s\n' 'S500 O03 V700 G40 W300 H Z03 F10 Y B10 Y R' >b.rks
    printf '%s\n' '123456us di 3 1' '700001us di 3 0' '1s set 4 K' '1.1s set 4 C75' '1.7s di 8 1' >in.txt
    for file; do
        "$RKM04" exec --until 2s --stimulus in.txt --trace "$file" a.rks 2=b.rks 4=a.rks >said 2>&1
        grep -q -- '--until reached' said || fail "the run with $file: $(<said)"
    done
}

# changes_of FILE.vcd: `tick name value` of each change after the values at the beginning, by time and name.
changes_of() {
    awk '$1 == "$var" { name[$4] = $5 }
        $1 == "$end" { begun = 1 }
        /^#/ { tick = substr($1, 2) }
        begun && /^[01]/ { print tick, name[substr($1, 2)], substr($1, 1, 1) }
        begun && /^r/ { print tick, name[$2], substr($1, 2) }' \
        <(sed '1,/^\$enddefinitions/ { /^\$var/!d }' "$1") | sort -k1n,1 -k2,2
}

# equal WANTED GOT WHAT: two files.
equal() {
    [[ -s $1 ]] || fail "$3: nothing to compare with"
    diff "$1" "$2" >difference || fail "$3 differ (< wanted, > got): $(head -n 20 difference)"
}

test_R7_GTKWave_finds_every_pulse_of_the_CSV_trace_10_us_wide() {
    traced run.vcd run.csv
    vcd2fst run.vcd run.fst >tool.out 2>&1 || fail "vcd2fst: $(<tool.out)"
    fst2vcd run.fst >again.vcd 2>tool.out || fail "fst2vcd: $(<tool.out)"
    changes_of again.vcd >changes
    awk -F, '$3 == "step" { print $1, $2 "_step", 1; print $1 + 10, $2 "_step", 0 }' run.csv | sort -k1n,1 -k2,2 >wanted
    grep _step changes >got
    equal wanted got pulses
    awk -F, '$3 == "step" { print $1, $2 "_position", $4 }' run.csv | sort -k1n,1 -k2,2 >wanted
    grep _position changes >got
    equal wanted got positions
}

test_GTKWave_finds_direction_LED_DI_DO_VAR_and_speed() {
    traced run.vcd run.csv
    vcd2fst run.vcd run.fst >tool.out 2>&1 && fst2vcd run.fst | changes_of /dev/stdin >changes
    awk -F, '$3 == "dir" { print $1, $2 "_dir", $4 == 1 ? 1 : 0 }' run.csv >wanted
    grep _dir changes >got
    equal wanted got directions
    awk -F, '$3 == "led" { print $1, $2 "_led", $4 == "off" ? 0 : 1 }' run.csv | grep -v m2 | sort -k1n,1 -k2,2 >wanted
    grep _led changes | grep -v m2 >got
    equal wanted got LEDs
    printf '%s\n' '123456 di03 1' '700001 di03 0' '1700000 di08 1' >wanted
    grep ' di' changes >got
    equal wanted got inputs
    awk -F, -v name=do -v first=1 -f <(bits) run.csv >wanted
    grep ' do' changes >got
    equal wanted got outputs
    awk -F, -v name=var -v first=80 -f <(bits) run.csv >wanted
    grep ' var' changes >got
    equal wanted got variables
    same 9000 "$(awk '$2 == "m1_speed" { print $3 }' changes | sort -n | tail -n 1)" "the highest speed"
}

# An awk program: the bits that change in the rows of a mask.
bits() {
    cat <<'EOF'
$3 == name {
    for (bit = 0; bit < 16; bit++) {
        level = int($4 / 2 ^ bit) % 2
        if (level != was[bit])
            printf "%d %s%02d %d\n", $1, name, first + bit, level
        was[bit] = level
    }
}
EOF
}

test_U6_the_LED_of_a_motion_that_cannot_be_computed_blinks_in_GTKWave() {
    traced run.vcd run.csv
    local begin
    begin=$(awk -F, '/m2,led,blink/ { print $1 }' run.csv)
    vcd2fst run.vcd run.fst >tool.out 2>&1 && fst2vcd run.fst | changes_of /dev/stdin >changes
    printf '%s\n' "$begin m2_led 1" "$((begin + 500000)) m2_led 0" "$((begin + 1000000)) m2_led 1" >wanted
    awk -v begin="$begin" '$2 == "m2_led" && $1 >= begin' changes >got
    equal wanted got "changes of the LED"
}

# A sample a tick: what PulseView shows.
test_R7_sigrok_samples_every_pulse_for_10_us() {
    traced run.vcd run.csv
    sigrok-cli -I vcd -i run.vcd --show >shown 2>tool.out || fail "sigrok-cli: $(<tool.out)"
    same "" "$(<tool.out)" "complaints of sigrok-cli"
    holds "$(<shown)" "Samplerate: 1000000" "the rate"
    local name
    for name in power di01 di08 do01 do08 var80 var95 m1_step m1_dir m1_led m1_moving m4_step; do
        holds "$(<shown)" "- $name: logic" "channels"
    done
    # A row a sample, the channels in the order of the file.
    sigrok-cli -I vcd -i run.vcd -C di03,m1_step,m2_step,m4_step -O csv:header=false:label=off 2>tool.out |
        grep -v ^META >samples
    same 2000001 "$(wc -l <samples)" "samples"
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) was[i] = 0 }
        { for (i = 1; i <= NF; i++) if ($i != was[i]) print NR - 1, i, was[i] = $i }' samples >changes
    awk -F, '$3 == "step" { motor = substr($2, 2); column = motor == 4 ? 4 : motor + 1
        print $1, column, 1; print $1 + 10, column, 0 }' run.csv | sort -k1n,1 -k2n,2 >wanted
    awk '$2 > 1' changes >got
    equal wanted got pulses
    printf '%s\n' '123456 1 1' '700001 1 0' >wanted
    awk '$2 == 1' changes >got
    equal wanted got "changes of DI 03"
}

test_JSON_lines_and_CSV_say_the_same() {
    traced run.jsonl run.csv
    python3 - >got <<'EOF' || fail "the trace is no JSON"
import json
names = {"step": "step", "direction": "dir", "motion": "motion", "command": "command", "led": "led", "inputs": "di",
         "outputs": "do", "variables": "var"}
print("t_us,source,event,value")
for line in open("run.jsonl"):
    event = json.loads(line)
    value = event.get("value")
    if event["kind"] == "direction":
        value = 1 if value else -1
    if event["kind"] == "motion":
        value = "begin" if value else "end"
    if event["kind"] in names:
        source = "m%d" % event["motor"] if "motor" in event else "unit"
        print(event["t_us"], source, names[event["kind"]], value, sep=",")
EOF
    equal run.csv got "the traces"
    holds "$(grep '"fault"' run.jsonl)" '"motor":2,"value":"motion"}' "the fault"
    same '{"t_us":2000001,"kind":"end"}' "$(tail -n 1 run.jsonl)" "the end"
}

# control ARGUMENTS...: something done to the emulator behind $folder/bus.
control() {
    exits 0 "$RKMCTL" --control "$folder/bus.control" "$@"
}

test_a_line_with_several_units_is_in_one_trace() {
    serve bus --node 1,3 --clock stepped --trace "$folder/run.vcd" --trace "$folder/run.csv" --trace "$folder/run.jsonl"
    ctl bus -n 1 set 'S1000 V1000 F30 R' >"$folder/ctl.out" || fail "unit 1 does not answer"
    ctl bus -n 3 -m 2 set 'S1000 V1000 B20 R T01' >"$folder/ctl.out" || fail "unit 3 does not answer"
    control advance 50ms
    control trace start "$folder/later.csv"
    control --unit 3 di 2=1
    control --unit 3 power off
    control advance 50ms
    control trace stop
    control shutdown
    status_of "$started"
    same 0 "$status" "exit status"
    cd "$folder" || exit 1
    same 20 "$(grep -c ',3.m2,step,' run.csv)" "pulses of unit 3"
    same 24000,3.m2,step,-20 "$(grep ,3.m2,step, run.csv | tail -n 1)" "the last pulse of unit 3"
    same $'50000,3.unit,di,2\n50000,3.unit,power,off' "$(tail -n 2 run.csv)" "the end"
    printf '%s\n' t_us,source,event,value 50000,1.m1,position,30 50000,1.m1,dir,1 50000,3.unit,do,1 50000,3.m2,position,-20 \
        50000,3.unit,di,2 50000,3.unit,power,off >wanted
    equal wanted later.csv "a trace that begins later"
    vcd2fst run.vcd run.fst >tool.out 2>&1 && fst2vcd run.fst | changes_of /dev/stdin >changes
    same 30 "$(grep -c 'u1_m1_step 1' changes)" "pulses of unit 1"
    same $'50000 u3_do01 0\n50000 u3_power 0' "$(grep -e u3_do01 -e u3_power changes | tail -n 2)" "the power of unit 3"
    same 2 "$(grep -c '"kind":"message".*"value":2,"from":\["master"\]' run.jsonl)" "messages of the master"
    holds "$(tail -n 1 run.jsonl)" '"kind":"end"' "the last line"
}

test_K1_two_runs_give_the_same_traces_to_the_byte() {
    traced 1.vcd 2.vcd 1.csv 2.csv 1.jsonl 2.jsonl
    local format
    for format in vcd csv jsonl; do
        cmp -s 1.$format 2.$format || fail "the $format traces differ"
    done
}

test_every_format_tells_that_it_cannot_be_written() {
    cd "$folder" || exit 1
    printf 'S100 V1000 A2000 F100000 R' >run.rks
    local format
    for format in vcd csv jsonl; do
        ln -s /dev/full full.$format
        exits 1 "$RKM04" exec --trace full.$format run.rks
        holds "$complained" "cannot write the trace full.$format: No space left" "stderr"
    done
}

run_cases "$@"
