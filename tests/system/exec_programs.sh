#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 exec: programs in virtual time, several motors, what comes from outside, the end of a run and its exit status.

. "$(dirname "$0")/lib.sh"

# text NAME LINE...: a file of these lines in the folder.
text() {
    printf '%s\n' "${@:2}" >"$folder/$1"
}

# run STATUS ARGUMENTS...: rkm04 exec in the folder ends with this status.
run() {
    cd "$folder" || exit 1
    exits "$1" "$RKM04" exec "${@:2}"
}

# motor NUMBER POSITION STATE INDEX LED FAULT: its object in the final state.
motor() {
    echo "{\"motor\":$1,\"position\":$2,\"state\":\"$3\",\"index\":$4,\"led\":\"$5\",\"fault\":$6}"
}

idle() {
    motor "$1" "${2-0}" idle 0 off null
}

# motors OBJECT: the list of all four when only the first one did anything.
motors() {
    echo "\"motors\":[$1,$(idle 2),$(idle 3),$(idle 4)]"
}

test_M_4_6_three_motions_and_two_dwells_between_them() {
    text run.rks 'S100 A2000 F1000 V3000' 'L3 R W200 E' 'B300'
    run 0 --json run.rks
    same "{\"t_us\":4564000,$(motors "$(idle 1 3000)"),\"di\":0,\"do\":0,\"var\":0,\"end\":\"done\",\"answers\":[]}" "$said" \
        "the final state"
    same "" "$complained" stderr
}

test_M_9_1_there_and_back_and_home() {
    text run.rks '\C100' 'S100 V1000 A2000 F5000 R' 'B2000 R' 'H'
    run 0 --json run.rks
    holds "$said" "$(idle 1 0)" "the motor is home"
    run 0 --trace run.csv run.rks
    same 10000 "$(grep -c ',m1,step,' run.csv)" "pulses"
    same 3 "$(grep -c ',m1,motion,begin' run.csv)" "motions"
    same ,m1,step,5000 "$(grep -o ',m1,step,.*' run.csv | sort -t, -k4n | tail -1)" "the farthest place"
}

test_M_9_2_an_endless_program_ends_with_until() {
    text run.rks '\' 'S100 V800 A2000' '@1 F1000 R' 'W500 D R' 'W1000 J1'
    run 124 --json --until 60s run.rks
    holds "$said" '"t_us":60000000,' "the time reached"
    holds "$said" '"end":"until"' "the end"
    holds "$complained" "--until 60s reached with a motor still running" "stderr"
}

# endless PERIOD PROGRAM...: motors 1, 2, … run these programs; it is seen that they never end.
endless() {
    local arguments=() number=0 program
    for program in "${@:2}"; do
        text $((++number)).rks "$program"
        arguments+=("$number=$number.rks")
    done
    run 124 --json --trace run.csv "${arguments[@]}"
    holds "$said" '"end":"endless"' "the end"
    holds "$complained" "the program never ends: its state repeats every $1 s; set an end with --until" "stderr"
    (($(wc -c <run.csv) < 2000000)) || fail "the trace is long"
}

test_a_program_that_never_ends_is_recognised() {
    endless 0.006000 '@1 T01 W2 C01 J1'
    endless 16000.002000 '@1 W16000000 J1'
    endless 4.618000 'S100 V800 A2000 @1 F1000 R W500 D R W1000 J1'
    endless 0.151000 '@1 F10 R H J1'
}

test_an_endless_motion_is_recognised_at_its_speed() {
    text run.rks 'S100 V1000 A2000 G+'
    run 124 --json --trace run.csv run.rks
    holds "$said" '"end":"endless"' "the end"
    (($(grep -c ,m1,step, run.csv) >= 247)) || fail "it has not come to its speed"
    holds "$complained" "the program never ends: motor 1 is in an endless motion; set an end with --until" "stderr"
    text 1.rks ')02'
    text 2.rks 'G-'
    run 124 1=1.rks 2=2.rks
    holds "$complained" "motor 1 moves until input 02 is 1, which no stimulus sets; motor 2 is in an endless motion; set an end" \
        "stderr"
}

test_motors_that_repeat_together_are_recognised() {
    endless 0.030000 '@1 T01 W1 C01 J1' '@1 W2 T02 C02 J1'
    endless 0.005000 '@1 T01 W1 C01 J1' 'S100 V200 A9000 G+' ')02 T04' 'O03'
}

test_what_repeats_for_long_and_then_ends_is_done() {
    text run.rks 'L200 L200 W1 E E T08'
    run 0 --json run.rks
    holds "$said" '"end":"done"' "the end"
}

test_a_stimulus_that_is_still_to_come_is_waited_for() {
    text run.rks '@1 W2 I01H2 J1 @2 T05'
    text inputs '10s di 01 1'
    run 0 --json --stimulus inputs run.rks
    holds "$said" '"do":16' "the outputs"
}

test_until_after_the_end_changes_nothing() {
    text run.rks 'W500'
    run 0 --json --until 10s run.rks
    holds "$said" '"t_us":501000,' "the end of the dwell"
    holds "$said" '"end":"done"' "the end"
}

test_until_is_the_last_tick_done() {
    text run.rks 'S100 V100 F100 R' # a pulse every 10 ms, from 14 ms on
    run 124 --json --until 13999us run.rks
    holds "$said" '"position":0,"state":"moving","index":4,"led":"on"' "before the first pulse"
    run 124 --json --until 14ms run.rks
    holds "$said" '"position":1,"state":"moving"' "at the first pulse"
    run 124 --json --until 0us run.rks
    holds "$said" '"t_us":0,' "nothing has been done"
}

test_a_dwelling_motor_runs_and_a_waiting_one_does_not() {
    text dwell.rks 'W1000'
    text wait.rks 'O01'
    run 124 --until 100ms dwell.rks
    run 0 --until 100ms wait.rks
    run 0 --json wait.rks
    holds "$said" "$(motor 1 0 wait 1 off null)" "a wait for what never comes"
    run 124 --until 100ms 1=wait.rks 3=dwell.rks
}

test_U1_each_motor_runs_its_own_program() {
    text a.rks 'F100 R'
    text b.rks 'B200 R'
    run 0 --json a.rks 2=b.rks 4=a.rks
    holds "$said" "[$(idle 1 100),$(idle 2 -200),$(idle 3),$(idle 4 100)]" "the motors"
    run 0 --json 0=b.rks
    holds "$said" "[$(idle 1 -200),$(idle 2 -200),$(idle 3 -200),$(idle 4 -200)]" "the motors"
}

test_U2_motors_wait_for_one_another_by_variables() {
    text first.rks 'F100 R T80 Z81 B100 R'
    text second.rks 'T81 O80 W100 F50 R C81'
    run 0 --json 1=first.rks 2=second.rks
    holds "$said" "[$(idle 1 0),$(idle 2 50)," "the motors"
    holds "$said" '"var":1,' "the variables"
}

test_C2_files_for_one_motor_follow_one_another() {
    text first.rks '\ S100 V1000 A2000 F100 R'
    text second.rks '{ goes on } F20 R'
    run 0 --json first.rks second.rks
    holds "$said" "$(idle 1 120)" "both have run"
    run 0 --json second.rks first.rks
    holds "$said" "$(idle 1 100)" "the last one begins with \\"
}

test_a_program_comes_from_standard_input() {
    cd "$folder" || exit 1
    said=$(printf 'F300 R' | "$RKM04" exec --json 3=-) || fail "exit status $?"
    holds "$said" "$(idle 3 300)" "motor 3"
    text run.rks 'F1 R'
    said=$(printf '1ms set 2 F7 R' | "$RKM04" exec --json --stimulus - run.rks) || fail "exit status $?"
    holds "$said" "[$(idle 1 1),$(idle 2 7)," "the motors"
}

test_C8_typographic_apostrophes_call_a_subroutine() {
    printf '\xEF\xBB\xBF\xE2\x80\x9E3 \xC2\xB43 \xE2\x80\x983 \xE2\x80\x993 J1 @3 F10 R . @1' >"$folder/run.rks"
    run 0 --json run.rks
    holds "$said" "$(idle 1 40)" "four calls"
}

test_C7_a_motor_in_fault_is_a_failure() {
    text run.rks 'F10 R' 'E'
    run 1 --json run.rks
    holds "$said" "$(motor 1 10 fault 3 off '"no_loop"')" "the motor"
    holds "$complained" "motor 1: fault at command 3: " "stderr"
    run 1 run.rks
    holds "$said" "no_loop" "the table"
}

test_C7_a_motor_that_waits_for_a_label_for_good_is_a_failure() {
    text run.rks 'F10 R' 'J5'
    run 1 --json run.rks
    holds "$said" "$(motor 1 10 wait 3 off null)" "the motor"
    holds "$complained" "motor 1: command 3 waits for label 5, which is not in memory" "stderr"
}

test_E1_a_motion_that_cannot_be_computed_is_a_failure() {
    text run.rks 'F10 Y B10 Y R'
    run 1 --json 2=run.rks
    holds "$said" "$(motor 2 0 fault 5 blink '"motion"')" "the motor"
}

test_C10_an_overflowing_program_is_a_warning() {
    printf 'W1 %.0s' {1..701} >"$folder/run.rks"
    run 0 run.rks
    holds "$complained" "run.rks: warning: " "stderr"
    holds "$complained" 700 "stderr"
}

test_inputs_of_the_stimulus_act_at_their_time() {
    text run.rks 'S100 V100 O05 F3 R Z05 B1 R'
    text in.txt '# lines in any order' '0.5s di 05 0' '100250us di 5 1' '2s di 8 1'
    run 0 --json --stimulus in.txt --trace run.csv run.rks
    holds "$said" "$(idle 1 2)" "the motor"
    holds "$said" '"di":128,' "the inputs"
    same $'100250,unit,di,16\n500000,unit,di,0\n2000000,unit,di,128' "$(grep ,di, run.csv)" "rows of inputs"
    # O05 passes in the slot at 101 ms, F3 and R follow a slot each; Z05 passes in the slot that begins with the input.
    same $'103000,m1,motion,begin\n502000,m1,motion,begin' "$(grep ,begin run.csv)" "the motions"
}

test_C3_texts_of_the_stimulus_hold_and_resume() {
    text run.rks 'S100 V1000 A2000 F5000 R'
    text in.txt '1s set 1 K'
    run 0 --json --stimulus in.txt run.rks
    holds "$said" '"state":"held","index":5,"led":"off"' "the motor is held"
    text in.txt '1s set 1 K' '5s set 1 C75'
    run 0 --json --stimulus in.txt run.rks
    holds "$said" "$(idle 1 5000)" "the motor has done the rest"
}

test_answers_to_messages_are_shown() {
    text in.txt '1ms message 01' '1s message 02 31 46 31 20 52 # F1 R' '2s message 0431' '3s message 0C' '3s message 0330'
    run 0 --json --stimulus in.txt
    holds "$said" '"answers":[{"t_us":1000,"message":"01","answer":"011030312E30322C30362E30332E32303039"},' "version"
    holds "$said" '{"t_us":1000000,"message":"023146312052","answer":"02310000"},' "set command"
    holds "$said" '{"t_us":2000000,"message":"0431","answer":"04310A20202020202020202031"},' "position"
    holds "$said" '{"t_us":3000000,"message":"0C","answer":"FF0C0000"},' "an unknown message"
    holds "$said" '{"t_us":3000000,"message":"0330","answer":"033000"}]' "store"
    run 0 --stimulus in.txt
    holds "$complained" "2000000 us: message 0431, answer 04310A20202020202020202031" "stderr"
}

test_the_table_for_people_shows_every_motor() {
    text run.rks 'F100 R T02 T05 T81 O08'
    run 0 run.rks
    holds "$said" $'\nmotor     position  state   command  led    fault\n' "the head"
    holds "$said" $'\n1              100  wait          6  off    -\n2                0  idle          0  off    -\n' "the motors"
    holds "$said" "inputs on: none; outputs on: 02 05; variables on: 81" "the bits"
}

test_an_interrupted_run_shows_the_state_reached() {
    text run.rks 'S100 V100 A2000 G+'
    cd "$folder" || exit 1
    start run env -u COLUMNS "$RKM04" exec --json --until 999999999s --trace pulses.csv run.rks
    soon "the run writes its trace" test -s pulses.csv
    kill -INT "$started"
    status_of "$started"
    same 1 "$status" "exit status"
    said=$(<run.out) complained=$(<run.err)
    holds "$said" '"state":"moving"' "the state"
    holds "$said" '"end":"interrupted"' "the end"
    holds "$complained" interrupted stderr
    same "" "$(tail -c 1 pulses.csv | tr -d '\n')" "the trace ends with a whole row"
}

test_K1_two_runs_are_the_same_to_the_byte() {
    text a.rks 'S100 V9000 A20000 @1 F900 R W7 D R J1'
    text b.rks 'S300 V16000 A60000 @1 T85 F500 Y V100 Y R C85 W3 J1'
    text in.txt '123456us di 3 1' '700001us set 1 V500' '900ms set 2 K' '1s set 2 C75'
    run 124 --until 3s --stimulus in.txt --trace 1.csv a.rks 2=b.rks 3=b.rks 4=a.rks
    run 124 --until 3s --stimulus in.txt --trace 2.csv a.rks 2=b.rks 3=b.rks 4=a.rks
    cmp -s 1.csv 2.csv || fail "the traces differ"
    sort -s -t, -k1n,1 1.csv | cmp -s - 1.csv || fail "the trace is not in the order of time"
}

test_a_run_that_nothing_brings_on_names_what_it_waits_for() {
    echo 'S100 V1000 A1000 F10 R O03 F10 R' >"$folder/input.rks"
    echo 'W5 [ F1 R' >"$folder/block.rks"
    echo 'F10 R' >"$folder/end.rks"
    exits 0 "$RKM04" exec "$folder/input.rks"
    holds "$complained" "motor 1 waits in O03 for DI 03 to be 1, which never happens" "an input that no stimulus sets"
    holds "$said" "not finished, but no motor can continue" "the first line"
    exits 0 "$RKM04" exec --json "$folder/block.rks"
    holds "$said" '"waits":[{"motor":1,"command":"[","for":"the ] of its block"}]' "the same as JSON"
    exits 0 "$RKM04" exec "$folder/end.rks"
    same "" "$complained" "a run that is finished"
    holds "$said" ": finished" "its first line"
}

run_cases "$@"
