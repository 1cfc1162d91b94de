#!/bin/bash
# SPDX-License-Identifier: MIT
# Signals, and standard streams, as a parent may leave them.

. "$(dirname "$0")/lib.sh"

# blocked COMMAND...: with SIGINT, SIGTERM and SIGHUP blocked by the parent.
blocked=(python3 -c '
import os, signal, sys
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.execvp(sys.argv[1], sys.argv[1:])')

test_signals_that_the_parent_has_blocked_end_the_emulator() {
    local signal
    for signal in TERM INT HUP; do
        start bus "${blocked[@]}" "$RKM04" serve --link "$folder/bus"
        soon "the unit is ready" ready bus
        kill -$signal "$started"
        status_of "$started"
        same 0 "$status" "exit status after SIG$signal"
        [[ ! -L $folder/bus ]] || fail "the link is still there"
    done
}

test_signals_that_the_parent_has_blocked_end_the_client() {
    serve bus --clock stepped
    start client "${blocked[@]}" "$RKMCTL" -c "$folder/bus.control" wait 'm1.position>100'
    soon "the client runs" grep -qx rkmctl "/proc/$started/comm"
    kill -TERM "$started"
    status_of "$started"
    same 143 "$status" "exit status"
}

# When the first files are there, and the last of many are not.
test_a_signal_during_the_start_leaves_no_files() {
    local signal
    mkdir "$folder/many"
    for signal in HUP TERM INT; do
        start many "$RKM04" serve --lines 200 --link "$folder/many/bus%l" --control "$folder/many/control"
        soon "the first file is there" test -e "$folder/many/bus0.lock"
        kill -$signal "$started"
        status_of "$started"
        same 0 "$status" "exit status after SIG$signal"
        same "" "$(ls -A "$folder/many")" "files that are left after SIG$signal"
    done
}

# Code that closes them must not find messages in the file that took their number.
test_with_standard_streams_closed_messages_go_nowhere() {
    printf 'S100 V1000 A300 F5000 R\n' >"$folder/program.rks"
    (exec 0<&- 1>&- 2>&-; exec "$RKM04" exec --trace "$folder/exec.csv" "$folder/program.rks" "$folder/missing.rks")
    (exec 0<&- 1>&- 2>&-; exec "$RKM04" exec --trace "$folder/exec.csv" "$folder/program.rks")
    [[ $(head -n 1 "$folder/exec.csv") == *,* ]] || fail "exec: $(head -c 200 "$folder/exec.csv")"
    (exec 0<&- 1>&- 2>&-; exec "$RKM04" serve --link "$folder/bus" --trace "$folder/serve.csv" --flash "$folder/unit.flash" \
        --record "$folder/serve.record") &
    started=$!
    processes+=("$started")
    soon "the unit is there" test -S "$folder/bus.control"
    exits 0 ctl bus version
    (exec 0<&- 1>&- 2>&-; exec "$RKMCTL" -c "$folder/bus.control" --timeout 5000 state)
    (exec 0<&- 1>&- 2>&-; exec "$RKMCTL" -c "$folder/bus.control" no such command)
    kill "$started"
    status_of "$started"
    grep -qE 'rkm04|READY|client' "$folder/serve.csv" "$folder/unit.flash" && fail "messages have gone into a file"
    grep -v '^{' "$folder/serve.record" && fail "messages have gone into the record"
    return 0
}

run_cases "$@"
