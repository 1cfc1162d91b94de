#!/bin/bash
# SPDX-License-Identifier: MIT
# The unit's own pty: what a client meets who opens, closes and opens it again, and what is left when the unit ends.

. "$(dirname "$0")/lib.sh"

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
    exits 0 ctl bus version
    holds "$said" "$version" "the second client"
    exec 3<>"$folder/bus"
    dialogue 4 "7e 01 00 08 58 10 7e" "7e 00 01 ff 08 00 00 db ff 7e" "the first client afterwards"
    exec 3>&- 4>&-
}

test_the_motors_run_while_no_client_is_attached() {
    serve bus --clock max
    exits 0 ctl bus set 'F5000 R'
    soon "the motor has arrived" position_is bus 1 5000
}

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
