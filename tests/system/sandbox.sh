#!/bin/bash
# SPDX-License-Identifier: MIT
# What a running emulator has given up (docs/SECURITY.md): files outside its folders, system calls that it does not need.
# A build with sanitizers, which need more, keeps its system calls; a kernel without Landlock or seccomp confines nothing.

. "$(dirname "$0")/lib.sh"
: "${BUILD:=build/dev}"

control() { "$RKMCTL" -c "$folder/own/bus.control" "$@"; }

# begin OPTIONS...: an emulator that works in $folder/here, with its link in $folder/own; $folder/away is not its business.
begin() {
    mkdir -p "$folder/own" "$folder/here" "$folder/away"
    start bus env -C "$folder/here" HOME="$folder" "$RKM04" serve --link "$folder/own/bus" "$@"
    soon "the unit is ready" ready bus
}

# Does this kernel confine? What it does not is in the log. Returns false, having said so.
confines() {
    ! grep -q "this kernel does not confine $1" "$folder/bus.err" || { echo "  skipped: this kernel does not confine $1"; false; }
}

status_line() { sed -n "s/^$1:[[:space:]]*//p" "/proc/$started/task/$2/status"; }

test_clients_reach_files_in_the_folders_of_the_command_line_only() {
    mkdir "$folder/trace"
    begin --trace "$folder/trace/all.csv"
    confines files || return 0
    exits 0 control trace start "$folder/here/here.csv"
    exits 0 control trace start "$folder/own/own.vcd"
    exits 0 control trace start "$folder/trace/other.jsonl"
    exits 0 control snapshot "file=$folder/own/own.record"
    exits 0 control restore "file=$folder/own/own.record"
    exits 1 control trace start "$folder/away/away.csv"
    holds "$complained" "--allow-folder" "what is said to a trace elsewhere"
    exits 1 control snapshot "file=$folder/away/away.record"
    holds "$complained" "--allow-folder" "what is said to a snapshot elsewhere"
    cp "$folder/own/own.record" "$folder/away/there.record"
    # The sanitizers' reports need to read everything.
    is_sanitized || exits 1 control restore "file=$folder/away/there.record"
    exits 1 control trace start "$folder/home.csv"
    same there.record "$(ls -A "$folder/away")" "files elsewhere"
}

test_a_folder_may_be_allowed() {
    mkdir "$folder/away"
    begin --allow-folder "$folder/away"
    exits 0 control trace start "$folder/away/away.csv"
    exits 0 control snapshot "file=$folder/away/away.record"
    exits 0 control restore "file=$folder/away/away.record"
    exits 2 "$RKM04" serve --allow-folder "$folder/nowhere"
    exits 2 "$RKM04" serve --allow-folder "$folder/bus.err"
}

test_the_home_of_the_user_is_not_a_folder_to_work_in() {
    mkdir "$folder/own"
    start bus env -C "$folder" HOME="$folder" "$RKM04" serve --link "$folder/own/bus"
    soon "the unit is ready" ready bus
    confines files || return 0
    exits 1 control trace start "$folder/home.csv"
}

test_without_the_sandbox_everything_is_within_reach() {
    begin --no-sandbox
    exits 0 control trace start "$folder/away/away.csv"
    same 0 "$(status_line Seccomp "$started")" "the filter"
    same 0 "$(status_line NoNewPrivs "$started")" "privileges"
}

test_every_thread_is_confined() {
    local thread
    # The log has a thread if stderr is no file.
    mkdir -p "$folder/own"
    start bus sh -c "exec '$RKM04' serve --link '$folder/own/bus' 2>&1 >'$folder/said' | cat >'$folder/log'"
    soon "the unit is ready" grep -qs READY "$folder/said"
    started=$(pgrep -f -x "$RKM04 serve --link $folder/own/bus") || fail "there is no process"
    grep -q "this kernel does not confine" "$folder/log" && return
    for thread in "/proc/$started/task/"*; do
        same 1 "$(status_line NoNewPrivs "${thread##*/}")" "no new privileges"
        is_sanitized || same 2 "$(status_line Seccomp "${thread##*/}")" "the filter"
    done
    kill "$started"
}

is_sanitized() { grep -q '^RKM04_SANITIZE:BOOL=ON' "$BUILD/CMakeCache.txt"; }

# Whatever an emulator does while it runs, it can do in its confinement.
test_what_a_unit_does_goes_on() {
    begin --tcp 0 --flash "$folder/own/unit.flash" --record "$folder/own/all.record" --coverage "$folder/own/covered"
    exits 0 ctl own/bus set 'S100 V1000 A300 F5 R'
    exits 0 ctl own/bus store
    exits 0 control fault inject unplugged duration=10ms count=1
    soon "the adapter is there again" grep -q "plugged in again" "$folder/bus.err"
    soon "it answers again" ctl own/bus version >"$folder/version"
    exits 0 "$RKMCTL" -p "tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")" version
    exits 0 control reset
    exits 0 control shutdown
    status_of "$started"
    same 0 "$status" "exit status"
    [[ -s $folder/own/covered ]] || fail "there is no report of coverage"
    exits 0 "$RKM04" replay "$folder/own/all.record"
    same "" "$(find "$folder/own" -name 'bus*')" "links, locks and sockets that are left"
}

test_images_traces_and_recordings_are_for_their_owner_alone() {
    local mask name
    for mask in 000 077 777; do
        rm -rf "$folder/own"
        mkdir -p "$folder/own"
        start bus sh -c "umask $mask; exec '$RKM04' serve --no-control --link '$folder/own/bus' --flash '$folder/own/unit.flash' \
            --record '$folder/own/all.record' --trace '$folder/own/t.csv' --trace '$folder/own/t.vcd' --wire '$folder/own/w.log'"
        soon "the unit is ready" ready bus
        for name in unit.flash all.record t.csv t.vcd w.log; do
            same 600 "$(stat -c %a "$folder/own/$name")" "mode of $name with umask $mask"
        done
        kill "$started"
        status_of "$started"
    done
}

run_cases "$@"
