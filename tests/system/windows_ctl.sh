#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl.exe under Wine asks an emulator what rkmctl asks here, over the TCP port of its control socket, and says the same.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}"
RKMCTL_EXE=${RKM04_EXE%/*}/rkmctl.exe
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

# rkmctl.exe, then rkmctl here, with the emulator's control file.
there() { wine_in "$prefix" "$RKMCTL_EXE" -c bus.control "$@"; }
here() { "$RKMCTL" -c bus.control "$@"; }

emulator() {
    cd "$folder" || fail "cd"
    serve bus --control tcp:0 --clock stepped "$@"
}

# alike STATUS ARGUMENTS...: both say the same, complain the same, and end so; $said is what they say.
alike() {
    local wanted=$1 status
    shift
    said=$(here "$@" 2>here.err </dev/null)
    status=$?
    same "$wanted" "$status" "exit status of rkmctl $*"
    same "$said" "$(there "$@" 2>there.err </dev/null; echo "status $?" >there.status)" "rkmctl.exe $*"
    same "status $wanted" "$(<there.status)" "exit status of rkmctl.exe $*"
    cmp -s here.err there.err || fail "rkmctl.exe $* complains otherwise"
}

# does ARGUMENTS...: rkmctl.exe does this; $said is what it says.
does() {
    said=$(there "$@" 2>there.err </dev/null) || fail "rkmctl.exe $*"
}

test_what_is_asked_is_answered_alike() {
    emulator --node 3,5
    for arguments in "state" "-u 5 state --json" "-u 3 di" "--json call units" "call ready" "clock" "fault" "-u 3 plant" \
        "-u 3 watch --once" "watch --json -u 5" "events --limit 0 count=1" "call fault.kinds" "wait --limit 0 idle -u 3"; do
        # shellcheck disable=SC2086
        "$RKMCTL" -c bus.control $arguments >/dev/null 2>&1
        # shellcheck disable=SC2086
        alike $? $arguments
    done
}

# cmd.exe has no device files, variables with $, and single quotes.
test_examples_in_help_are_those_of_Windows() {
    local command commands="version set send raw pmc wait advance shell"
    cd "$folder" || fail "cd"
    for command in "" $commands; do
        # shellcheck disable=SC2086
        wine_in "$prefix" "$RKMCTL_EXE" $command --help >help.txt || fail "rkmctl.exe $command --help"
        same "" "$(grep '^  rkmctl ' help.txt | grep -e "/dev/" -e '[$]' -e "'")" "examples of rkmctl.exe $command --help"
    done
    holds "$(<help.txt)" "rkmctl -p COM3 shell" "the examples"
}

test_what_is_wrong_is_refused_alike() {
    emulator
    for arguments in "di 9=1" "di" "-u 7 state" "wait" "wait nonsense" "advance 5x" "fault inject nothing" "call nonsense" \
        "staet" "clock x0" "snapshot" "restore none" "trace start a.txt" "-p COM1 state" "plant set none.yaml" "power maybe"; do
        # shellcheck disable=SC2086
        "$RKMCTL" -c bus.control $arguments >/dev/null 2>&1
        # shellcheck disable=SC2086
        alike $? $arguments
    done
}

test_it_changes_what_rkmctl_changes() {
    emulator
    does di 3=1 08=1
    same "01=0 02=0 03=1 04=0 05=0 06=0 07=0 08=1" "$said" "inputs"
    exits 0 "$RKMCTL" -p bus set 'S100 V1000 A2000 F500 R T03'
    does advance m1.idle
    holds "$(here --json state)" '"position":500' "the motor"
    does snapshot there
    does advance 1s
    does restore there
    does fault inject drop direction=to_master count=1
    holds "$(here fault)" "drop" "the fault"
    does fault clear
    printf 'motors:\n  1: {stops: {high: 700}}\n' >axis.yaml
    does plant set axis.yaml
    holds "$(here plant)" "700" "the stop"
    does call trace.start file=there.csv
    does advance 5ms
    does trace stop
    [[ -s there.csv ]] || fail "the trace"
    does reset
    does power off
    does clock x100
    same "x100" "$(here --json clock | sed 's/.*"clock":"\([^"]*\)".*/\1/')" "the clock"
    does shutdown
    soon "the emulator ends" ended "$started"
}

test_a_wait_ends_when_the_condition_holds_and_3_if_it_does_not() {
    emulator
    there wait di3=1 >wait.out 2>wait.err &
    waiting=$!
    processes+=("$waiting")
    switch_until_it_ends() { here di 3=1 >/dev/null && ended "$waiting"; }
    soon "it waits, and no more when the input is on" switch_until_it_ends
    wait "$waiting"
    same 0 $? "exit status of wait"
    there wait --advance m1.position=5 --limit 10ms >wait.out 2>wait.err
    same 3 $? "exit status without the condition"
}

test_the_shell_does_the_commands_of_a_file_and_of_stdin() {
    emulator
    printf '# a check\ndi 3=1\nclock\ndi "3=1"\nstate --json\n' >commands.txt
    alike 0 shell -f commands.txt
    printf 'di 5=1\ndi 99=1\ndi 6=1\n' >wrong.txt
    alike 2 shell -f wrong.txt
    holds "$(here di)" "05=1 06=0" "inputs after the failure"
    same "$(here shell -f - <commands.txt)" "$(there shell <commands.txt 2>there.err)" "stdin"
    printf 'set "unfinished\n' >open.txt
    alike 2 shell -f open.txt
}

test_a_PMC_is_reached_by_its_faces_and_the_control_socket() {
    local face port
    cd "$folder" || fail "cd"
    for face in ascii modbus; do
        serve bus --device pmc-2hs --device-option face=$face --control tcp:0 --tcp 0
        port=tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' bus.out)
        does pmc move x=100 y=50
        does pmc stop xy now
        same "$(here pmc position)" "$(there pmc position 2>there.err)" "the position by the control socket"
        same "$(here pmc position --json)" "$(wine_in "$prefix" "$RKMCTL_EXE" -p "$port" --face $face -n 1 pmc position --json \
            2>there.err)" "the position by $face"
        here shutdown >/dev/null
        soon "the unit ends" ended "$started"
    done
    alike 2 pmc nonsense
}

test_a_CIB_module_too() {
    emulator --device cib
    does cib command A 102 3000 500
    does advance m1.idle
    alike 0 cib status A
    alike 0 cib config
    alike 0 watch --once
}

test_messages_about_the_file_are_the_same() {
    cd "$folder" || fail "cd"
    for content in "" diary "tcp:127.0.0.1:1 00" "tcp:192.0.2.1:80 00" "tcp:127.0.0.1:x 00"; do
        printf '%s' "$content" >bus.control
        here state >/dev/null 2>here.err
        there state >there.out 2>there.err
        same 1 $? "exit status with '$content'"
        cmp -s here.err there.err || fail "with '$content': '$(<there.err)', here '$(<here.err)'"
    done
    rm bus.control
    alike 1 state
}

test_an_emulator_there_is_found_and_asked_and_its_file_is_private() {
    local file
    cd "$folder" || fail "cd"
    start bus wine_in "$prefix" "$RKM04_EXE" serve --tcp 0 --clock stepped
    soon "the unit is ready" ready bus
    file=$(sed -n 's/.*"control":"[A-Z]:\([^"]*\)".*/\1/p' bus.out)
    file=$(find "$prefix/drive_c" -path "*$file")
    [[ -f $file ]] || fail "there is no control file: $(<bus.out)"
    same 0 "$((0$(stat -c %a "$file") & 07))" "rights of others" # Wine gives those of the user to the group, too
    ctl_exe() { wine_in "$prefix" "$RKMCTL_EXE" "$@" 2>there.err; }
    same "01=0 02=0 03=1 04=0 05=0 06=0 07=0 08=0" "$(ctl_exe di 3=1)" "inputs"
    same "motor 1: ok" "$(ctl_exe set 'S100 V1000 A2000 F500 R')" "the bus is found, too"
    same "0.911001 s" "$(ctl_exe advance m1.idle)" "the time"
    same "motor 1: 500" "$(ctl_exe position)" "the motor"
    ctl_exe trace start 'there.csv' >/dev/null || fail "trace start"
    ctl_exe snapshot file=there.record >/dev/null || fail "snapshot"
    [[ -s there.record ]] || fail "the snapshot"
    exits 0 "$RKMCTL" -c "$file" --json di # a client of this system has the same way in
    same '{"t_us":911001,"di":4}' "$said" "inputs here"
    ctl_exe shutdown >/dev/null || fail "shutdown"
    soon "the emulator ends" ended "$started"
    [[ ! -e $file ]] || fail "the file is left behind"
}

run_cases "$@"
