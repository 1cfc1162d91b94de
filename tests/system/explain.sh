#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 explain and rkm04 estimate from the command line.

. "$(dirname "$0")/lib.sh"
here=$(cd "$(dirname "$0")" && pwd)

test_a_program_is_explained_line_by_line_in_two_languages() {
    cd "$folder" || exit 1
    printf 'S100\nF1000 R' >p.rks
    exits 0 "$RKM04" explain p.rks
    same "p.rks:1:1: S100      start/stop speed 100 steps/s
p.rks:2:1: F1000     set 1000 steps forward
p.rks:2:7: R         move: 1000 steps forward; S100 V1000 A2000" "$said" "English"
    exits 0 "$RKM04" explain --lang cs p.rks
    holds "$said" "proveď pohyb: 1000 kroků vpřed; S100 V1000 A2000" "Czech"
    exits 0 "$RKM04" explain --json p.rks
    same 3 "$(python3 -c 'import json, sys; print(len(json.load(sys.stdin)))' <<<"$said")" JSON
    exits 2 "$RKM04" explain --lang de p.rks
    holds "$complained" "--lang: expected en or cs, found 'de'" "another language"
}

test_an_estimate_agrees_with_a_run() {
    cd "$folder" || exit 1
    printf 'S100 V3000 A2000\n@1 F1000 R W200 I01L2 J1\n@2 B200 R H' >p.rks
    exits 0 "$RKM04" estimate --json p.rks
    local end position
    end=$(python3 -c 'import json, sys; a = json.load(sys.stdin); print("%d.%06d" % divmod(a["duration_us"], 10**6))' <<<"$said")
    position=$(python3 -c 'import json, sys; a = json.load(sys.stdin); print(a["motors"][0]["position"])' <<<"$said")
    exits 0 "$RKM04" exec p.rks
    holds "$said" "at $end s: finished" "the end"
    holds "$said" "$(printf '%11s' "$position")" "the position"
}

test_estimates_of_random_programs_agree_with_runs() {
    local told
    told=$(python3 "$here/estimate_random.py" "$RKM04" "$folder" 1 25) || fail "$told"
}

test_several_motors_on_a_plant() {
    cd "$folder" || exit 1
    printf 'F1500 R O80' >x.rks
    printf 'F100 R O81 T80' >y.rks
    printf 'motors: {1: {stops: {low: -10, high: 1000}}}\n' >plant.yaml
    exits 1 "$RKM04" estimate 1=x.rks 2=y.rks --plant plant.yaml
    holds "$said" "runs against its end stop at 1000" "the collision"
    holds "$said" "x.rks:1:9: O80: motor 1 waits from " "the first wait"
    holds "$said" "y.rks:1:8: O81: motor 2 waits from 0.361000 s on" "the second wait"
    holds "$said" "on motors wait for each other" "both"
}

test_texts_and_plants_with_errors_are_refused() {
    cd "$folder" || exit 1
    printf 'F100 q' >p.rks
    printf 'motors: 1\n' >plant.yaml
    exits 1 "$RKM04" estimate p.rks
    holds "$complained" "p.rks:1:6: error: expected a command, found 'q'" "estimate"
    exits 1 "$RKM04" explain p.rks
    holds "$complained" "p.rks:1:6: error: expected a command, found 'q'" "explain"
    printf 'F100 R' >p.rks
    exits 1 "$RKM04" estimate --plant plant.yaml p.rks
    holds "$complained" "plant.yaml:1:" "the plant"
    exits 1 "$RKM04" check --plant plant.yaml p.rks
    holds "$complained" "plant.yaml:1:" "the plant of check"
    exits 1 "$RKM04" estimate none.rks
    exits 1 "$RKM04" estimate --plant none.yaml p.rks
    exits 2 "$RKM04" estimate
    exits 2 "$RKM04" explain
}

run_cases "$@"
