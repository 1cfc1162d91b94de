#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl watch in a terminal: what the panel shows, on which terminals and sizes, and how it leaves them.

. "$(dirname "$0")/lib.sh"

client=$(dirname "$0")/panel_client.py

for python in python3 /usr/bin/python3 none; do # a python3 of one's own does not know the packages of the system
    "$python" -c 'import pyte' 2>/dev/null && break
done
if [[ $python == none ]]; then
    skip_all "there is no terminal in Python; apt-get install python3-pyte"
fi

# emulator OPTIONS...: units whose clock stands until it is moved on.
emulator() {
    serve bus --clock stepped "$@"
    export RKM04_CONTROL=$folder/bus.control
}

# panel STEP...: watch in a terminal of 24 x 80, or $size, of the kind $TERM.
panel() {
    # shellcheck disable=SC2086
    exits 0 "$python" "$client" ${size:-24 80} "$RKMCTL" watch "${more[@]}" -- "$@"
}

more=()
export TERM=xterm-256color LC_ALL=C.UTF-8
unset NO_COLOR LINES COLUMNS

test_the_panel_shows_what_changes() {
    emulator
    exits 0 ctl bus set 'S100 V1000 A2000 F5000 R T03 O04 T80'
    exits 0 "$RKMCTL" advance 10ms
    panel "see:RKM04 unit 1  0.010000 s  clock stepped" "see: 1   ●   moving             0     110      5  R" \
        "see: DO    ○  ○  ○" keys:q status:0
    exits 0 "$RKMCTL" advance do3=1
    exits 0 "$RKMCTL" advance 1ms
    panel "see: 1   ○   wait            5000       0      7  O04" "see: DO    ○  ○  ●  ○" "see:1 requests   1 answers" \
        "see: VAR   ○  ○" keys:q status:0
}

test_the_picture_is_updated_while_it_is_shown() {
    emulator
    exits 0 "$RKMCTL" clock real
    start mover "$RKMCTL" -p "$folder/bus" set 'L255 F200 R W300 B200 R W300 E'
    panel see:moving see:dwell see:moving "see: 1   ●" "see: 1   ○" keys:q status:0
}

test_it_is_seen_when_the_emulator_does_not_answer() {
    emulator
    panel "see:idle" "run:kill -STOP $started" "see:no answer for" "see: s   q quit" "see:idle" \
        "run:kill -CONT $started" "gone:no answer" see:quit keys:q status:0
    panel "see:idle" "run:kill -STOP $started" "see:no answer for" keys:q status:0
    kill -CONT "$started"
}

test_an_LED_blinks_by_the_clock_of_the_line() {
    emulator
    exits 0 ctl bus set 'F10 Y B10 Y R'
    exits 0 "$RKMCTL" advance m1.led=blink
    panel "see: 1   ●   fault" "see:fault: motion" colours:green,red keys:q status:0
    exits 0 "$RKMCTL" advance 500ms
    panel "see: 1   ○   fault" keys:q status:0
}

test_the_unit_is_chosen_by_keys() {
    emulator --node 3,3,16
    panel "see:units [3] 3-2 16" 'keys:\t' "see:unit 3-2" 'keys:n' "see:3 3-2 [16]" 'keys:\t' "see:RKM04 unit 3 " 'keys:\x1b[Z' \
        "see:RKM04 unit 16" 'keys:p' "see:[3-2]" keys:q status:0
    more=(-u 16)
    panel "see:RKM04 unit 16" keys:Q status:0
    more=(-u 4)
    panel status:2
}

test_the_panel_fits_itself_to_the_size() {
    emulator
    panel see:quit see:collisions size:10x40 gone:collisions see:VAR size:5x24 gone:VAR "see: 4   ○" size:1x1 size:24x80 \
        "see: 4   ○   idle" see:collisions see:quit size:60x200 see:quit keys:q status:0
    size="3 12"
    panel "see: 2   ○" keys:q status:0
    size="1 1"
    panel size:24x80 see:quit keys:q status:0
}

test_it_leaves_the_terminal_as_it_was_however_it_ends() {
    emulator
    panel see:quit 'keys:\x03' status:0
    panel see:quit signal:SIGTERM status:-15
    panel see:quit signal:SIGHUP status:-1
    panel see:quit signal:SIGINT status:0
}

test_it_ends_with_the_emulator() {
    emulator
    local emulator=$started
    panel see:quit "run:kill $emulator" status:1
    holds "$complained" "$folder/bus.control" "the message names the emulator"
}

test_colours_can_be_done_without() {
    emulator
    exits 0 ctl bus set 'T03 .'
    exits 0 "$RKMCTL" advance 10ms
    panel "see:.  fault: no_call" colours:green,red keys:q status:0
    NO_COLOR=1 panel "see:.  fault: no_call" colours: keys:q status:0
    TERM=vt100 panel "see:.  fault: no_call" colours: keys:q status:0
}

test_lamps_are_ASCII_where_there_is_nothing_else() {
    emulator
    exits 0 ctl bus set 'T03'
    exits 0 "$RKMCTL" advance 10ms
    LC_ALL=C TERM=vt100 panel "see: DO    .  .  *  .  ." keys:q status:0
}

test_a_terminal_without_a_screen_is_refused() {
    emulator
    TERM=dumb panel status:1
    holds "$complained" "--once" "the message says what else there is"
    TERM=nonsense panel status:1
    holds "$complained" "nonsense" "the message names it"
}

test_one_picture_is_text_for_scripts() {
    emulator --node 2
    exits 0 ctl bus -n 2 -m 3 set 'S100 F3 R T03'
    exits 0 "$RKMCTL" advance do3=1
    TERM=dumb exits 0 "$RKMCTL" watch --once
    holds "$said" " 3   .   ready              3       0      4  T03" "motor 3"
    holds "$said" " DO    .  .  *  .  .  .  .  ." "outputs"
    exits 0 "$RKMCTL" watch --json
    holds "$said" '"unit":"2"' "as JSON"
}

test_the_panel_of_a_CNC872_shows_axes_block_and_stops() {
    printf 'G1 X10 F1000\nG1 X20\n' >"$folder/two.nc"
    start bus "$RKM04" serve --device cnc872 --nc "$folder/two.nc" --clock stepped --control "$folder/bus.control"
    soon "the unit is ready" ready bus
    export RKM04_CONTROL=$folder/bus.control
    exits 0 "$RKMCTL" call cnc.panel start=true feed=120
    exits 0 "$RKMCTL" advance 100ms
    panel "see:cnc872 unit 1  0.100000 s" "see: X     block" "see: block    move   block 0   line 1" "see:feed 120 %   aut" \
        "see: stops    -" "run:'$RKMCTL' call cnc.panel stop=true" "run:'$RKMCTL' advance 500ms" "see: X     stopped" \
        "see: stops    po_stop   sf_stop" colours:red keys:q status:0
    exits 0 "$RKMCTL" watch --once
    holds "$said" " spindle  off   0.0 of 0.0 rev/min   gear 1   spindle 100 %" "the spindle"
}

run_cases "$@"
