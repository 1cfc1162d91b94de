#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl --control against a real emulator: what it shows, what it changes, how it waits, what it says to wrong usage.

. "$(dirname "$0")/lib.sh"

# emulator OPTIONS...: units with a stepped clock, and RKM04_CONTROL for control.
emulator() {
    serve bus --clock stepped "$@"
    export RKM04_CONTROL=$folder/bus.control
}

control() { "$RKMCTL" "$@"; }

# program [-n NODE] [-m MOTOR] TEXT
program() { exits 0 ctl bus set "$@"; }

# state_of KEY: a member of the state as JSON.
state_of() {
    exits 0 control --json state
    python3 -c "import json, sys; print(json.dumps(json.load(sys.stdin)$1))" <<<"$said"
}

# pretend LINES: a control socket, $pretended, that answers everything with that, for one client.
pretend() {
    pretended=$folder/other$((++others)).control # the one before may still be there
    start other socat "UNIX-LISTEN:$pretended" "SYSTEM:$1"
    soon "the other one listens" test -S "$pretended"
}
others=0

test_state_is_for_people_and_as_json() {
    emulator
    program 'S100 V1000 A2000 F5000 R T03'
    exits 0 control advance 10ms
    same "0.010000 s" "$said" "the time"
    exits 0 control state
    holds "$said" " 1   *   moving" "motor 1"
    holds "$said" "6 of 700 commands" "memory"
    holds "$said" "(248;1000)" "the profile"
    same '"moving"' "$(state_of '["motors"][0]["state"]')" "state as JSON"
    same 10000 "$(state_of '["t_us"]')" "time as JSON"
}

test_several_units_are_named_or_all_shown() {
    emulator --node 3,3,5
    exits 0 control state
    holds "$said" "RKM04 unit 3-2" "the second one"
    holds "$said" "RKM04 unit 5" "the last one"
    exits 0 control -u 3-2 --json state
    holds "$said" '"unit":"3-2"' "the one named"
    exits 0 control -n 5 --json state
    holds "$said" '"unit":"5"' "the one named by its address"
    exits 2 control -u 7 state
    holds "$complained" "3, 3-2, 5" "the message names those there are"
    exits 2 control reset
    holds "$complained" unit "the message says what is missing"
}

test_inputs_are_shown_and_set() {
    emulator
    exits 0 control di 3=1 08=1 di5=0
    same "01=0 02=0 03=1 04=0 05=0 06=0 07=0 08=1" "$said" "inputs after setting"
    exits 0 control --json di
    same '{"t_us":0,"di":132}' "$said" "inputs as JSON"
    program 'O03 T01'
    exits 0 control advance do1=1 --limit 10ms
    exits 0 control di 3=0
    same "01=0 02=0 03=0 04=0 05=0 06=0 07=0 08=1" "$said" "inputs after setting again"
    for wrong in 9 di x; do
        exits 2 control di "$wrong=1"
        holds "$complained" "unknown input \`$wrong': expected 1 to 8" "an input that the unit has not"
    done
    for wrong in 3=2 3 =1 0=1 33=1; do
        exits 2 control di "$wrong"
        holds "$complained" "'$wrong'" "the message quotes it"
    done
}

test_time_goes_on_by_a_time_or_until_a_condition_holds() {
    emulator
    program 'S100 V1000 A2000 F5000 R T03'
    exits 0 control advance 1500
    same "0.001500 s" "$said" "the time"
    exits 0 control advance 'm1.position>=2500' and m1.state=moving --limit 10s
    exits 0 control --json advance do3=1
    holds "$said" '"holds":true' "the condition"
    same 5000 "$(state_of '["motors"][0]["position"]')" "position"
    exits 3 control advance 'm1.position>=9999' --limit 1s
    holds "$complained" "is 5000" "the message says what there is instead"
    exits 3 control --json advance 'm1.position>=9999' --limit 1s
    holds "$said" '"holds":false' "the result"
    exits 2 control advance 1s 2s
    exits 2 control advance 1s --limit 2s
    exits 2 control advance 'm1.position>='
    exits 2 control advance 'm1.idle' --limit soon
    for time in 100000000000000000 99999999999999999999 1000000001s; do
        exits 2 control advance "$time"
        holds "$complained" "ticks: expected a time from 0 to 10^15 us (10^9 s)" "the range"
    done
    exits 2 control advance 't>=1000000001s'
    holds "$complained" "t: expected a time from 0 to 10^15 us (10^9 s)" "the range of a condition"
    exits 0 control clock real
    exits 1 control advance 1s
    holds "$complained" stepped "the message says which clock it takes"
}

# A stopped process answers nothing, takes nothing when its socket is full, and its connections come to be.
test_an_emulator_that_is_stopped_is_waited_for_within_the_limit() {
    cd "$folder" || fail "cd"
    emulator
    { echo '# a large plant'; yes '# filled up' | head -c 900000; } >large.yaml
    kill -STOP "$started"
    for command in "advance 1s" "wait idle" "call units" "state" "plant set large.yaml" "restore file=none"; do
        # shellcheck disable=SC2086
        exits 3 timeout "$limit" "$RKMCTL" --timeout 300 $command
        holds "$complained" "no answer from $RKM04_CONTROL in time" "rkmctl $command"
    done
    kill -CONT "$started"
    exits 0 control state
}

# A person at a terminal learns after five seconds that there is no answer, and can end the wait.
test_a_person_is_informed_of_a_long_wait_and_can_end_it() {
    emulator
    exits 0 timeout "$limit" python3 - "$RKMCTL" <<'END'
import os, signal, subprocess, sys
ours, theirs = os.openpty()
waiting = subprocess.Popen([sys.argv[1], "wait", "t>=1s"], stderr=theirs, start_new_session=True)
os.close(theirs)
said = b""
while b"--timeout MS limits it" not in said:
    said += os.read(ours, 1000)
assert b"time is stopped" in said and b"no answer from" in said, said
waiting.send_signal(signal.SIGINT)
assert waiting.wait() == -signal.SIGINT, waiting.returncode
END
    exits 3 control --timeout 6000 wait 't>=1s'
    same "" "$(grep "no answer from .* yet" <<<"$complained")" "the note where nobody watches"
}

test_waiting_ends_when_it_has_come_true_or_the_limit_is_over() {
    emulator
    exits 0 control clock x100
    exits 3 control wait 'm1.position>=1' --limit 100ms
    holds "$complained" "is 0" "the message says what there is instead"
    program 'S100 V1000 A2000 F5000 R T03'
    exits 0 control wait m1.position=5000 and do3=1 --limit 60s
    holds "$said" " s" "the time"
    exits 2 control wait 'm1.place>5'
    holds "$complained" m1.position "the message says what can be waited for"
    exits 2 control wait
}

test_a_wait_is_given_up_after_a_timeout_of_real_time() {
    emulator
    exits 3 control wait m1.position=1 --timeout 50
    holds "$complained" "$folder/bus.control" "the message names the emulator"
}

test_a_message_on_the_line_can_be_waited_for() {
    emulator
    start waiting control wait unit.message=4
    soon "it waits or has seen it" saw_a_message
    status_of "$started"
    same 0 "$status" "exit status of the wait"
}

saw_a_message() {
    ctl bus position >/dev/null
    ended "$started"
}

# listen NAME ARGUMENTS...: begin to show events.
listen() {
    start "$1" "$RKMCTL" events "${@:2}"
    soon "$1 listens" grep -qs "^listening from" "$folder/$1.err"
}

test_events_come_a_line_each() {
    emulator
    listen events outputs led motor=1 count=3
    local listener=$started
    listen other --json command motor=2 count=1
    local other=$started
    program 'S100 F2 R T03'
    program -m 2 'W1'
    exits 0 control advance 1s
    status_of "$listener"
    same 0 "$status" "exit status"
    same "unit 1 motor 1 led on/unit 1 motor 1 led off/unit 1 outputs 4/" \
        "$(sed 's/^[0-9.]* s *//; s/  */ /g' "$folder/events.out" | tr '\n' /)" events
    status_of "$other"
    holds "$(<"$folder/other.out")" '"kind":"command"' "an event as JSON"
}

test_events_end_with_the_limit() {
    emulator
    exits 0 control clock x100
    exits 0 control events step --limit 100ms
    same "" "$said" "no events"
    exits 2 control events steps
    holds "$complained" step "the message names the kinds"
    exits 2 control events motor=5
    exits 2 control events step --limit long
}

test_what_was_kept_can_be_gone_back_to() {
    emulator
    program 'S100 V1000 A2000 F5000 R'
    exits 0 control advance 'm1.position>=1000'
    exits 0 control snapshot here
    exits 0 control advance idle
    exits 0 control restore here
    same 1000 "$(state_of '["motors"][0]["position"]')" "position after going back"
    exits 0 control advance idle
    same 5000 "$(state_of '["motors"][0]["position"]')" "position at the end"
    exits 1 control restore elsewhere
    holds "$complained" here "the message names those there are"
}

test_what_was_kept_in_a_file_outlives_the_emulator() {
    emulator
    cd "$folder" || fail "no folder"
    program 'S100 V1000 A2000 F5000 R'
    exits 0 control advance 'm1.position>=1000'
    exits 0 control snapshot file=here.record
    exits 0 control shutdown
    status_of "$started"
    serve bus --clock stepped
    exits 0 control restore file=here.record
    same 1000 "$(state_of '["motors"][0]["position"]')" "position after going back"
    exits 0 control advance idle
    same 5000 "$(state_of '["motors"][0]["position"]')" "position at the end"
    exits 1 control restore file=there.record
    holds "$complained" there.record "the message names the file"
}

test_power_reset_and_switch() {
    emulator
    program 'S100 F7 R T03'
    exits 0 control advance 1s
    exits 0 control power off
    exits 0 control watch --once
    holds "$said" "unit 1: no power" "the panel"
    exits 1 control reset
    exits 0 control power on
    same 0 "$(state_of '["motors"][0]["position"]')" "position after power-up"
    exits 0 control switch 7
    same 7 "$(state_of '["switch"]')" "the switch"
    same 1 "$(state_of '["node"]')" "the address in force, as the switch has not been read"
    exits 0 control switch 8 reset
    same 8 "$(state_of '["node"]')" "the address in force"
    exits 0 ctl bus -n 8 version
    for wrong in 0 17 x '7 now'; do
        # shellcheck disable=SC2086
        exits 2 control switch $wrong
    done
    exits 2 control power maybe
}

test_the_clock_is_shown_and_set() {
    emulator
    exits 0 control clock
    same "stepped, 0.000000 s" "$said" "the clock"
    exits 0 control clock x50
    exits 0 control --json clock
    holds "$said" '"clock":"x50"' "the clock"
    exits 2 control clock sundial
    holds "$complained" stepped "the message says what there is"
}

test_traces_are_in_the_folder_of_the_caller() {
    local here=$folder/here
    emulator
    mkdir "$here"
    cd "$here" || fail "no folder"
    exits 0 control trace start steps.csv
    same "trace 1" "$said" "the number"
    program 'S100 F7 R'
    exits 0 control advance 1s
    exits 0 control trace stop 1
    [[ $(grep -c step steps.csv) -ge 7 ]] || fail "the trace: $(cat steps.csv)"
    exits 2 control trace start steps.txt
    exits 2 control trace start
    exits 2 control trace stop first
    exits 2 control trace
}

test_faults_are_injected_listed_and_cleared() {
    emulator
    exits 0 control fault
    same "" "$said" "no faults"
    exits 0 control fault inject no_answer count=1
    same "fault 1" "$said" "its number"
    until [[ $(control fault) == *state=spent* ]]; do # a busy machine may let it wait until its client has given up
        exits 3 ctl bus --timeout 300 version
    done
    exits 0 ctl bus version
    exits 0 control fault inject input input=3 level=1 after=5ms
    exits 0 control fault
    holds "$said" "2  input" "the list"
    exits 0 control advance 10ms
    exits 0 control di 3=0
    holds "$complained" "input 03" "what does not obey is named"
    exits 0 control fault clear
    exits 0 control fault list
    same "" "$said" "no faults again"
    exits 2 control fault inject
    exits 2 control fault inject gremlins
    exits 2 control fault inject drop count
    exits 2 control fault inject drop cuont=1
    exits 2 control fault clear x
    exits 2 control fault mend
}

test_a_plant_is_set_shown_and_handled() {
    emulator
    exits 0 control plant
    same "no plant" "$said" "without one"
    printf 'motors: {1: {offset: 7}}\n' >"$folder/axis.yaml"
    exits 0 control plant set "$folder/axis.yaml"
    program 'S100 F20 R'
    exits 0 control advance m1.true=27 --limit 10s
    exits 0 control watch --once
    holds "$said" "true pos." "the panel"
    exits 0 control plant motor=1 jammed=true
    exits 0 control plant
    holds "$said" "jammed=true" "the plant"
    exits 0 control plant none
    exits 2 control plant set /dev/null/nothing/there more
    exits 1 control plant set "$folder/nothing.yaml"
    printf 'motors: {1: {offset: far}}\n' >"$folder/axis.yaml"
    exits 2 control plant set "$folder/axis.yaml"
    holds "$complained" "1:" "the message names the place"
}

test_any_method_can_be_called() {
    emulator
    exits 0 control call di.set '{"di": {"1": 1}}'
    holds "$said" '"di":1' "the result"
    exits 0 control call clock clock=stepped
    holds "$said" '"clock":"stepped"' "the result"
    exits 1 control call nothing
    exits 2 control call di.set '{'
    exits 2 control call di.set di
}

test_the_emulator_can_be_ended() {
    emulator
    local emulator=$started
    exits 0 control shutdown
    status_of "$emulator"
    same 0 "$status" "its exit status"
    exits 1 control state
    holds "$complained" "$folder/bus.control" "the message names the socket"
    holds "$complained" "rkm04 serve" "the message says what should be there"
}

# Many buses take their time to end.
test_when_shutdown_returns_the_emulator_has_ended() {
    local word
    mkdir "$folder/many"
    export RKM04_CONTROL=$folder/many/control
    for word in shutdown "call shutdown"; do
        start many "$RKM04" serve --lines 100 --node 1-4 --link "$folder/many/bus%l" --control "$RKM04_CONTROL" \
            --record "$folder/%l.record" --coverage "$folder/covered" --clock stepped
        soon "the buses are ready" ready many
        # shellcheck disable=SC2086
        exits 0 control $word
        same "" "$(ls -A "$folder/many")" "links, locks and sockets after $word"
        same 100 "$(tail -qn 1 "$folder"/*.record | grep -c '"end":true')" "recordings that are complete after $word"
        status_of "$started"
        same 0 "$status" "exit status of serve after $word"
    done
}

test_the_default_is_the_emulator_started_without_a_link() {
    unset RKM04_CONTROL
    export XDG_RUNTIME_DIR=$folder/run TMPDIR=$folder/tmp
    mkdir "$XDG_RUNTIME_DIR" "$TMPDIR"
    exits 1 alone "$RKMCTL" state
    start default "$RKM04" serve --clock stepped
    soon "it is ready" ready default
    exits 0 control watch --once
    exits 0 control shutdown
    status_of "$started"
    unset XDG_RUNTIME_DIR
    start default "$RKM04" serve --clock stepped
    soon "it is ready" ready default
    exits 0 control watch --once
    RKM04_CONTROL=$folder/elsewhere exits 1 control watch --once
    holds "$complained" "$folder/elsewhere" "the environment comes first"
}

test_what_is_no_emulator_is_told() {
    echo text >"$folder/file"
    exits 1 control -c "$folder/file" state
    holds "$complained" socket "the message says what was expected"
    exits 1 control -c "$folder/$(printf '%0200d' 0)" state
    holds "$complained" characters "the message says how long it may be"
    pretend 'echo hello; cat'
    exits 1 control -c "$pretended" state
    holds "$complained" JSON "the message says what was expected"
    pretend 'true'
    exits 1 control -c "$pretended" state
    pretend 'cat >/dev/null'
    exits 3 control -c "$pretended" --timeout 100 state
    pretend 'yes x | tr -d "\n" | head -c 100000000'
    exits 1 control -c "$pretended" state
}

test_commands_go_where_they_belong() {
    export RKM04_CONTROL=$folder/nowhere
    exits 2 control -p "$folder/bus" state
    holds "$complained" --control "the message says where it goes"
    exits 2 control -c "$folder/bus.control" position
    holds "$complained" --port "the message says where it goes"
    exits 2 control --once state
    exits 2 control --limit 5s state
    exits 2 control -u 1 clock
    exits 2 control state now
    exits 2 control snapshot
    exits 2 control statue
    holds "$complained" watch "the message names the commands"
    exits 2 control --line 256 state
    exits 2 control watch
    holds "$complained" --once "the message says what else there is"
}

test_a_wait_for_time_that_is_stopped_says_so_at_once() {
    emulator
    program 'S100 V1000 A2000 F500 R'
    exits 0 control wait 'm1.position=0'
    same "" "$complained" "nothing to say where the condition holds"
    start waiting "$RKMCTL" wait 'm1.position>=500'
    soon "it says why it waits" grep -q 'time is stopped' "$folder/waiting.err"
    grep -q 'rkmctl advance' "$folder/waiting.err" || fail "it does not say what to do"
    exits 0 control advance 2s
    status_of "$started"
    same 0 "$status" "the wait ends when another client lets time go on"
    program 'B500 R'
    exits 0 control wait --advance 'm1.position=0'
    [[ $said == [12].*" s" ]] || fail "the time: $said"
    exits 3 control wait --advance 'm1.position=9' --limit 10ms
    exits 0 control clock max
    program 'F5 R'
    exits 0 control wait --advance 'm1.position=5'
    exits 2 control --advance state
}

test_events_that_do_not_come_within_the_limit_are_exit_3() {
    serve bus --clock max
    export RKM04_CONTROL=$folder/bus.control
    exits 3 control events count=3 --limit 10ms
    holds "$complained" "0 of 3 events" "what is missing"
    exits 0 control events --limit 10ms
    exits 0 control clock stepped
    start listening "$RKMCTL" events count=1 --limit 10ms
    soon "it says that time is stopped" grep -q 'time is stopped' "$folder/listening.err"
    exits 0 control advance 1s
    status_of "$started"
    same 3 "$status" "no event came"
}

run_cases "$@"
