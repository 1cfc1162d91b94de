#!/bin/bash
# SPDX-License-Identifier: MIT
# The unit's own pty: what a client meets who opens, closes and opens it again, and what is left when the unit ends.

. "$(dirname "$0")/lib.sh"
: "${PTY_CLIENT:=pty_client}" "${CC:=cc}"

version="01.02,06.03.2009"

test_the_ready_line_names_pty_link_and_node() {
    serve bus --node 7
    local line
    line=$(grep '^READY ' "$folder/bus.out")
    holds "$line" "\"pty\":\"$(readlink "$folder/bus")\"" "the pty"
    holds "$line" "\"link\":\"$folder/bus\"" "the link"
    holds "$line" '"node":7' "the node"
    same 1 "$(wc -l <"$folder/bus.out")" "lines on stdout"
}

test_without_an_option_the_link_lies_in_the_runtime_folder() {
    XDG_RUNTIME_DIR=$folder start bus "$RKM04" serve
    soon "the unit is ready" ready bus
    holds "$(readlink "$folder/rkm04/bus0")" /dev/pts/ "the link"
    exits 0 "$RKMCTL" -p "$folder/rkm04/bus0" version
}

test_without_a_runtime_folder_the_link_lies_in_a_private_folder_under_the_temporary_one() {
    local link
    start bus env -u XDG_RUNTIME_DIR TMPDIR="$folder" "$RKM04" serve
    soon "the unit is ready" ready bus
    link=$(sed 's/.*"link":"\([^"]*\)".*/\1/' "$folder/bus.out")
    holds "$link" "$folder/" "the link"
    same 700 "$(stat -c %a "$(dirname "$link")")" "permissions of its folder"
}

test_the_pty_is_raw_from_the_start_and_again_for_the_next_client() {
    local settings
    serve bus
    settings=$(stty -a <"$folder/bus")
    holds "$settings" "-echo " "fresh"
    holds "$settings" "-icanon" "fresh"
    holds "$settings" "-ixon" "fresh"
    stty echo icanon icrnl ixon <"$folder/bus"
    soon "the next client finds it raw" raw_again
    exec 3<>"$folder/bus"
    dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "a dialogue after another client's settings"
    exec 3>&-
}

raw_again() { [[ $(stty -a <"$folder/bus") == *-icanon*-echo\ * ]]; }

test_a_client_may_close_and_open_again_at_will() {
    serve bus
    local i
    for i in 1 2 3 4 5; do
        exits 0 ctl bus version
        holds "$said" "$version" "time $i"
    done
}

test_bytes_for_nobody_are_not_kept_for_the_next_client() {
    serve bus --baud 0
    exec 3<>"$folder/bus"
    say_bytes 3 "7e 01 00 08 58 10 7e 7e 01 00 01 99" # one request, and half of another
    exec 3>&-
    exits 0 ctl bus version
    holds "$said" "$version" "the next client"
}

test_two_clients_share_the_line() {
    serve bus --baud 0
    exec 4<>"$folder/bus" # the first one stays there, silent
    soon "the first client is seen" seen 'a client has opened the bus' 1
    exits 0 ctl bus version
    holds "$said" "$version" "the second client"
    soon "the user is warned" grep -q 'another client has opened the bus' "$folder/bus.err"
    exec 3<>"$folder/bus"
    dialogue 4 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "the first client afterwards"
    exec 3>&- 4>&-
}

test_the_motors_run_while_no_client_is_attached() {
    serve bus --clock max
    exits 0 ctl bus set 'F5000 R'
    soon "the motor has arrived" position_is bus 1 5000
}

# many WHAT TIMES: sessions of pty_client.c, one after the other; all are as they should be.
many() {
    serve bus --baud 0
    exits 0 timeout 500 "$PTY_CLIENT" "$1" "$folder/bus" "$2"
    same "$2 of $2" "$said" "sessions"
    ! grep -q 'another client' "$folder/bus.err" || fail "one client is called another one, too"
    exits 0 ctl bus version
    holds "$said" "$version" "afterwards"
}

test_clients_that_take_the_pty_for_themselves_come_and_go_at_once() { many exclusive 4000; }
test_clients_that_leave_the_pty_locked_do_not_keep_out_the_next() { many careless 1000; }
test_a_client_keeps_its_settings_though_another_has_just_gone() { many settings 4000; }

test_settings_outlive_the_client() {
    serve bus
    stty 9600 cstopb min 0 time 7 <"$folder/bus"
    soon "it has gone" grep -q 'has closed the bus' "$folder/bus.err"
    holds "$(stty -a <"$folder/bus")" "speed 9600" "the next client finds"
    holds "$(stty -a <"$folder/bus")" " cstopb" "the next client finds"
    holds "$(stty -a <"$folder/bus")" "min = 0; time = 7" "the next client finds"
}

# A client takes the pty for itself, and is killed, in the moment in which the emulator has none of it.
test_a_pty_that_was_locked_for_good_is_replaced() {
    [[ $(id -u) != 0 ]] || return 0 # nothing is locked for root
    shim "$(dirname "$0")/pty_lock_shim.c"
    local old
    LD_PRELOAD=$folder/shim.so ASAN_OPTIONS=verify_asan_link_order=0 serve bus
    old=$(readlink "$folder/bus")
    exits 0 ctl bus version
    soon "it is locked, and replaced" grep -q 'locked the pty .* and has closed it' "$folder/bus.err"
    soon "the link is there" test -L "$folder/bus"
    exits 0 ctl bus version
    holds "$said" "$version" "on another pty than $old"
}

shim() {
    $CC -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -shared -fPIC -o "$folder/shim.so" "$1" -ldl || fail "$1 cannot be compiled"
}

# without_inotify WHAT: the emulator looks who is there, and everything works.
without_inotify() {
    shim "$(dirname "$0")/notify_shim.c"
    NOTIFY_SHIM=$1 LD_PRELOAD=$folder/shim.so ASAN_OPTIONS=verify_asan_link_order=0 serve bus
    holds "$(<"$folder/bus.err")" "$2" "what is said"
    local i
    for i in 1 2 3; do
        exec 3<>"$folder/bus"
        dialogue 3 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "time $i"
        soon "the client is seen" seen 'opened the bus' "$i"
        exec 3>&-
        soon "it is seen to go" seen 'closed the bus' "$i"
    done
    stty echo icanon icrnl ixon <"$folder/bus"
    soon "the next client finds it raw" raw_again
    idle_cost_is_small "with nobody there"
}

seen() { [[ $(grep -c "$1" "$folder/bus.err") == "$2" ]]; }

test_without_inotify_watches_the_emulator_goes_on() { without_inotify watches "fs.inotify.max_user_watches"; }
test_without_inotify_instances_the_emulator_goes_on() { without_inotify instances "fs.inotify.max_user_instances"; }

# limited NUMBER OPTIONS...: a unit with so many descriptors at most; it is ready, or has ended.
limited() {
    local number=$1
    shift
    rm -f "$folder"/bus.{out,err} # of the one before
    (ulimit -n "$number"; exec "$RKM04" serve --link "$folder/bus%l" "$@" >"$folder/bus.out" 2>"$folder/bus.err" </dev/null) &
    started=$!
    processes=("$started")
    soon "it is ready or has ended, $number descriptors" ready_or_ended
}

# refused_at NUMBER: it is refused, and the message names `least`, which is set if it is empty.
refused_at() {
    ended "$started" || fail "it works with $1 descriptors, though $least are named"
    status_of "$started"
    same 1 "$status" "exit status with $1 descriptors"
    [[ $(<"$folder/bus.err") =~ "too few file descriptors: \`ulimit -n' is $1, expected at least "([0-9]+)$ ]] ||
        fail "with $1 descriptors: $(<"$folder/bus.err")"
    same "${least:=${BASH_REMATCH[1]}}" "${BASH_REMATCH[1]}" "the number named with $1 descriptors"
}

# With too few file descriptors the number is named that is enough; what it never does is to turn without a rest.
test_the_number_of_descriptors_that_is_named_is_enough_and_no_fewer_are() {
    local options number least
    while read -ra options; do
        least=''
        for number in 8 12 16 20; do
            limited "$number" "${options[@]}"
            refused_at "$number"
        done
        limited "$((least - 1))" "${options[@]}"
        refused_at "$((least - 1))"
        limited "$least" "${options[@]}"
        ready_and_well
        rm -f "$folder"/*.{csv,log,record,flash}
    done <<END
--baud 19200
--no-control
--tcp 127.0.0.1:0 --rfc2217 0
--lines 3 --trace $folder/%l.csv --wire $folder/%l.log --record $folder/%l.record
--node 1-4 --flash $folder/%n.flash --coverage $folder/coverage
END
}

ready_and_well() {
    grep -q '^READY ' "$folder/bus.out" ||
        fail "${options[*]}: $least descriptors are named, and not enough: $(<"$folder/bus.err")"
    local free=$((least - $(find "/proc/$started/fd" -mindepth 1 | wc -l)))
    ((free >= 8 && free <= 10)) || fail "${options[*]}: $free of $least descriptors are free"
    ctl bus0 version >"$folder/version" 2>&1 || fail "${options[*]}: no answer"
    idle_cost_is_small "$least descriptors"
    kill "$started"
    status_of "$started"
}

ready_or_ended() { grep -qs '^READY ' "$folder/bus.out" || ended "$started"; }

ends_cleanly_on() {
    serve bus --flash "$folder/flash"
    kill "-$1" "$started"
    status_of "$started"
    [[ $status == 0 || $status == $((128 + $(kill -l "$1"))) ]] || fail "exit status $status after SIG$1"
    [[ ! -e $folder/bus && ! -L $folder/bus ]] || fail "the link is still there"
    same "" "$(cd "$folder" && ls -A | grep -v -e '^bus.out$' -e '^bus.err$' -e '^flash$')" "what is left behind"
}

test_SIGTERM_ends_the_unit_cleanly() { ends_cleanly_on TERM; }
test_SIGINT_ends_the_unit_cleanly() { ends_cleanly_on INT; }

test_a_client_is_told_when_the_unit_ends() {
    serve bus
    exec 3<>"$folder/bus"
    kill "$started"
    status_of "$started"
    same "" "$(hear_bytes 3 1)" "bytes after the end"
    exec 3>&-
    exits 1 ctl bus version
}

# Processor time used while nothing happens, in hundredths of a second.
used() { awk '{print $14 + $15}' "/proc/$started/stat"; }

idle_cost_is_small() {
    local before after
    before=$(used)
    sleep 2 # the span that is measured
    after=$(used)
    ((after - before <= 20)) || fail "$1: used $((after - before)) of 200 hundredths of a second"
}

test_an_idle_unit_costs_next_to_nothing_with_and_without_a_client() {
    serve bus
    idle_cost_is_small "before the first client"
    exits 0 ctl bus version
    idle_cost_is_small "after a client has gone"
    exec 3<>"$folder/bus"
    idle_cost_is_small "with a silent client"
    exec 3>&-
}

run_cases "$@"
