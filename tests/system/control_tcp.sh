#!/bin/bash
# SPDX-License-Identifier: MIT
# The control socket over TCP: who is let in, rkmctl with its file, and clients that behave badly.
. "${0%/*}/lib.sh"

command -v python3 >/dev/null || skip_all "python3 is not there"
here=$(cd "${0%/*}" && pwd)
export RKM04 RKMCTL PYTHONDONTWRITEBYTECODE=1

# An emulator whose control file is $folder/bus.control.
emulator() {
    serve bus --clock stepped --control tcp:0 "$@"
    export RKM04_CONTROL=$folder/bus.control
}

test_rkmctl_takes_the_file_as_it_takes_a_socket() {
    emulator --node 1,3
    exits 0 "$RKMCTL" -u 3 di 3=1
    exits 0 "$RKMCTL" -u 3 --json di
    same '{"t_us":0,"di":4}' "$said" "inputs"
    exits 0 "$RKMCTL" advance 10ms
    same "0.010000 s" "$said" "the time"
    printf 'state\ndi 1=1\n' >"$folder/commands"
    exits 2 "$RKMCTL" shell -f "$folder/commands"
    holds "$complained" "expected one of 1, 3" "the shell is let in"
    exits 0 "$RKMCTL" watch --once
    holds "$said" "RKM04 unit 1" "the panel"
    exits 0 "$RKMCTL" shutdown
    soon "the file is gone" test ! -e "$folder/bus.control"
}

test_the_file_is_found_where_the_socket_would_be() {
    start bus "$RKM04" serve --control tcp:localhost:0
    soon "ready" ready bus
    exits 0 "$RKMCTL" --json call ready
    holds "$said" "\"control\":\"$XDG_RUNTIME_DIR/rkm04/bus0.control\"" "where it is"
    holds "$said" '"control_tcp":"127.0.0.1:' "the address"
    same 600 "$(stat -c %a "$XDG_RUNTIME_DIR/rkm04/bus0.control")" "its mode"
}

test_an_emulator_without_pty_is_found_by_its_file() {
    start bus "$RKM04" serve --tcp 0 --control tcp:0
    soon "ready" ready bus
    exits 0 "$RKMCTL" -c "$(sed -n 's/.*"control":"\([^"]*\)".*/\1/p' "$folder/bus.out")" state
    exits 0 env RKM04_PORT="$(sed -n 's/.*"tcp":"\([^"]*\)".*/tcp:\1/p' "$folder/bus.out")" "$RKMCTL" state
    holds "$said" "RKM04 unit 1" "the file is found by way of the bus"
}

test_messages_say_what_is_wrong_with_the_file() {
    local address
    emulator
    address=$(sed 's/ .*//' "$RKM04_CONTROL")
    echo "$address 00" >"$folder/wrong.control"
    exits 1 "$RKMCTL" -c "$folder/wrong.control" state
    holds "$complained" "token: wrong" "a wrong token"
    echo "tcp:192.0.2.1:80 00" >"$folder/far.control"
    exits 1 "$RKMCTL" -c "$folder/far.control" state
    holds "$complained" "far.control" "another machine"
    echo "precious" >"$folder/other.control"
    exits 1 "$RKMCTL" -c "$folder/other.control" state
    holds "$complained" "expected the control socket" "no such file"
    cp "$RKM04_CONTROL" "$folder/dead.control"
    exits 0 "$RKMCTL" shutdown
    soon "the emulator ends" ended "$started"
    exits 1 "$RKMCTL" -c "$folder/dead.control" state
    holds "$complained" "has ended" "an emulator that is no more"
}

test_causes_of_silence_are_found_by_the_file() {
    emulator --node 3
    exits 3 "$RKMCTL" -p "$folder/bus" -n 5 --timeout 300 version
    holds "$complained" "there are 3: select one with -n" "the addresses there are"
}

test_the_options_go_together_or_say_why_not() {
    exits 2 "$RKM04" serve --control-file x
    holds "$complained" "expected --control tcp:PORT, too" "the message"
    exits 2 "$RKM04" serve --control tcp:0 --no-control
    holds "$complained" "expected either --control or --no-control" "the message"
    exits 1 "$RKM04" serve --link "$folder/a" --control tcp:0 --control-file "$folder/none/x"
    holds "$complained" "cannot lock $folder/none/x.lock" "the message"
    [[ ! -e $folder/a ]] || fail "a link is left behind"
    echo precious >"$folder/mine"
    exits 1 "$RKM04" serve --link "$folder/a" --control tcp:0 --control-file "$folder/mine"
    same precious "$(<"$folder/mine")" "a file of another kind"
    serve bus --control tcp:0
    exits 1 "$RKM04" serve --link "$folder/b" --control "tcp:$(sed 's/^tcp:\(.*\) .*/\1/' "$folder/bus.control")"
    holds "$complained" "another program listens there" "the message"
    [[ ! -e $folder/b.control && ! -e $folder/b.control.lock ]] || fail "a file is left behind"
}

# Of the clients that behave badly those for which the kind of connection matters.
wanted='one_too_many|before_it_goes|leaves_in_the_middle|who_does_not_read|however_slow|an_advance_ends|files_begun'
wanted+='|killed_emulator|megabytes'
run_python() { CONTROL=tcp:0 python3 "$here/$1.py" "$2" >"$folder/robust" 2>&1 || fail "$(<"$folder/robust")"; }
for name in $(sed -n 's/^def \(test_[a-z_]*\).*/\1/p' "$here/control_door.py"); do
    eval "$name() { run_python control_door $name; }"
done
for name in $(sed -n 's/^def \(test_[a-z_]*\).*/\1/p' "$here/control_robust.py" | grep -E "$wanted"); do
    eval "$name() { run_python control_robust $name; }"
done

run_cases "$@"
