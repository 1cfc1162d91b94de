#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 plot: the corners of the speed against closed forms, the pictures as other programs read them, sources, refusals.

. "$(dirname "$0")/lib.sh"
examples=$(cd "$(dirname "$0")/../../examples" && pwd)

# corners ARGUMENTS...: what plot writes as CSV, without the head and the motor, in $corners.
corners() {
    exits 0 "$RKM04" plot --format csv "$@"
    corners=$(tail -n +2 <<<"$said" | cut -d, -f1,3,4)
}

program() {
    printf '%s\n' "$2" >"$folder/$1.rks"
}

# S = 100, V = 5000, A = 5000: 0.98 s of ramp over 2499 steps; 5002 steps at V. The first slot is at 1 ms, R at 5 ms.
test_R1_the_corners_of_a_trapezium_are_exact() {
    program a 'S100 V5000 A5000 F10000 R'
    corners "$folder/a.rks"
    same "0.000,0.000,0.000
5000.000,0.000,0.000
5000.000,100.000,0.000
985000.000,5000.000,2499.000
1985400.000,5000.000,7501.000
2965400.000,100.000,10000.000
2965400.000,0.000,10000.000" "$(head -n 7 <<<"$corners")" "corners"
}

# X takes the speed down from the slot that sees the input; K holds, C75 goes on from rest.
test_R5_a_stop_on_the_way_begins_where_it_begins() {
    program a 'S100 V4000 A8000 X02 F9000 R'
    printf '1s di 02 1\n' >"$folder/in"
    corners -s "$folder/in" "$folder/a.rks"
    holds "$corners" "1000000.000,4000.000," "the last corner at full speed"
    [[ $(cut -d, -f2 <<<"$corners" | sort -g | tail -n 1) == 4000.000 ]] || fail "a speed above V in '$corners'"
    same 0.000 "$(tail -n 1 <<<"$corners" | cut -d, -f2)" "speed at the end"
}

test_back_is_drawn_below_and_rest_at_its_position() {
    program a 'S100 V1000 A2000 F500 R W100 B1000 R'
    corners "$folder/a.rks"
    holds "$corners" ",-1000.000," "back at V"
    same 0.000,-500.000 "$(tail -n 1 <<<"$corners" | cut -d, -f2,3)" "the end"
}

test_a_recording_of_a_scenario_has_the_corners_of_its_program() {
    corners "$examples/manual/9-9.yaml"
    holds "$corners" "17716500.000,2500.000,12000.000" "the peak of the compound motion"
    same 18000.000 "$(tail -n 1 <<<"$corners" | cut -d, -f3)" "position at the end"
}

# Means over pulses: within the tick of 1 us that each pulse is rounded to.
test_a_trace_gives_the_same_speeds_about() {
    program a 'S100 V2000 A5000 F5000 R'
    exits 0 "$RKM04" exec -t "$folder/a.csv" "$folder/a.rks"
    corners "$folder/a.csv"
    awk -F, '$1 > 1e6 && $1 < 2e6 && ($2 < 1990 || $2 > 2010) { bad = 1 } END { exit bad }' <<<"$corners" ||
        fail "full speed is not 2000 in '$corners'"
    same 5000.000 "$(tail -n 1 <<<"$corners" | cut -d, -f3)" "position at the end"
}

test_a_picture_is_well_formed_and_says_what_it_shows() {
    program a 'S100 V5000 A5000 F10000 R O02 T01'
    printf '4s di 02 1\n' >"$folder/in"
    exits 0 "$RKM04" plot -s "$folder/in" --title 'a < b & "c"' -o "$folder/a.svg" "$folder/a.rks"
    python3 - "$folder/a.svg" <<'END' || fail "the picture"
import sys
import xml.etree.ElementTree as tree
root = tree.parse(sys.argv[1]).getroot()
text = "".join(root.itertext())
space = "{http://www.w3.org/2000/svg}"
assert root.find(space + "title").text == 'a < b & "c"'
assert "Motor 1: 1 motion, at most 5000 steps/s, position 10000" in root.find(space + "desc").text
for part in ("5000 steps/s", "10000 steps, 2.96 s", "O02 wait", "DI 02", "DO 01"):
    assert part in text, part
END
}

test_forms_are_chosen_by_the_name() {
    program a 'S100 V5000 A5000 F10000 R'
    exits 0 "$RKM04" plot -o "$folder/a.png" --width 400 --scale 1 "$folder/a.rks"
    same "PNG image data, 400 x" "$(file -b "$folder/a.png" | cut -c 1-21)" "the PNG"
    exits 0 "$RKM04" plot -o "$folder/a.html" "$folder/a.rks"
    holds "$(<"$folder/a.html")" "</html>" "the page"
    [[ $(<"$folder/a.html") != *http*://*http*://*http* ]] || fail "the page names another address than SVG's name space"
    exits 2 "$RKM04" plot -o "$folder/a.jpg" "$folder/a.rks"
    holds "$complained" "expected a name that ends with .svg, .png, .html or .csv" "another ending"
}

test_a_picture_for_which_there_is_no_room_is_a_failure() {
    program a 'S100 V5000 A5000 F10000 R'
    for form in svg png html csv; do
        ln -s /dev/full "$folder/full.$form"
        exits 1 "$RKM04" plot --force -o "$folder/full.$form" "$folder/a.rks"
        holds "$complained" "No space left on device" "the reason for .$form"
    done
}

test_without_rsvg_convert_a_png_is_refused_and_the_way_out_named() {
    program a 'F10 R'
    exits 1 env PATH=/nowhere "$RKM04" plot -o "$folder/a.png" "$folder/a.rks"
    holds "$complained" "librsvg2-bin" "what to install"
    [[ ! -e $folder/a.png ]] || fail "there is a file"
    exits 0 "$RKM04" plot -o "$folder/a.png" "$folder/a.rks"
    cp "$folder/a.png" "$folder/kept.png"
    exits 1 env PATH=/nowhere "$RKM04" plot -o "$folder/a.png" "$folder/a.rks"
    cmp -s "$folder/a.png" "$folder/kept.png" || fail "the picture that was there has gone"
}

test_a_run_without_end_is_drawn_until_it_repeats() {
    program loop 'S100 V1000 A5000 @1 F200 R W100 J1'
    program fast 'S1 V16000 A1000 G+'
    exits 0 "$RKM04" plot -o "$folder/loop.csv" "$folder/loop.rks"
    holds "$complained" "never ends" "loop"
    exits 0 "$RKM04" plot -o "$folder/fast.csv" "$folder/fast.rks"
    holds "$(<"$folder/fast.csv")" ",16000.000," "full speed of an endless motion"
}

test_a_plant_shows_where_the_axis_is() {
    exits 0 "$RKM04" plot -o "$folder/a.svg" "$examples/linear-axis.yaml"
    holds "$(<"$folder/a.svg")" "<title>true position</title>" "the curve of the plant"
    holds "$(<"$folder/a.svg")" ">dashed: true position</text>" "what the dashed curve is"
}

test_thousands_of_motions_make_a_small_picture() {
    program a 'S100 V4000 A9000 L255 L50 F100 R B100 R E E'
    exits 0 "$RKM04" plot -o "$folder/a.svg" "$folder/a.rks"
    (($(stat -c %s "$folder/a.svg") < 500000)) || fail "$(stat -c %s "$folder/a.svg") bytes"
}

test_refusals_name_their_place_and_write_nothing() {
    program bad 'F1000 R V0'
    exits 1 "$RKM04" plot -o "$folder/a.svg" "$folder/bad.rks"
    holds "$complained" "bad.rks:1:9: error: " "the text"
    printf 't_us,source,event,value\n12,m1,step,x\n' >"$folder/bad.csv"
    exits 1 "$RKM04" plot -o "$folder/a.svg" "$folder/bad.csv"
    holds "$complained" "bad.csv:2:12: error: expected a position" "the trace"
    printf 't_us,source,event,value\n12,m1,step,1\n11,m1,step,2\n' >"$folder/bad.csv"
    exits 1 "$RKM04" plot -o "$folder/a.svg" "$folder/bad.csv"
    holds "$complained" "bad.csv:3:1: error: expected a time of 12 us or later" "a time that goes back"
    program a 'F10 R'
    exits 1 "$RKM04" plot -o "$folder/a.rks" --format svg "$folder/a.rks"
    holds "$complained" "cannot write" "over its own input"
    exits 2 "$RKM04" plot --from 2s --until 1s -o "$folder/a.svg" "$folder/a.rks"
    exits 1 "$RKM04" plot --from 100s -o "$folder/a.svg" "$folder/a.rks"
    holds "$complained" "--from: expected a time before the end of what is drawn" "a part after the end"
    [[ ! -e $folder/a.svg ]] || fail "a picture was begun"
}

run_cases "$@"
