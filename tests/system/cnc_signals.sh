#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 signals: the table of the CNC872's cells.
. "${0%/*}/lib.sh"

# row NAME: the words of its line, a space between them
row() {
    awk -v name="$1" '$1 == name {$1 = $1; print}' <<<"$said"
}

test_each_cell_has_a_line() {
    exits 0 "$RKM04" signals
    same "name type access preset section" "$(head -n 1 <<<"$said" | tr -s ' ')" "head"
    same "B_POL DWRD[6] r 0 8.1.1" "$(row B_POL)" "an array"
    same "MPxPI BIT X..16 rw 1 8.1.4" "$(row MPxPI)" "a bit of each axis"
    same "MPx BIT X..6 r 0 8.1.6" "$(row MPx)" "a bit of six axes"
    same "ZMMnPI BIT 1..14 r 0 8.2.6" "$(row ZMMnPI)" "bits with numbers"
    same "FEED_OVR_MULTIPLIER WORD rw 1000 8.1.19" "$(row FEED_OVR_MULTIPLIER)" "a preset"
    same "SYST_TIME_INFO structure r 0 8.4.2" "$(row SYST_TIME_INFO)" "a structure"
    same "SYST_TIME_INFO.TIME_HUND BYTE r - 8.4.2" "$(row SYST_TIME_INFO.TIME_HUND)" "its field"
    same "DISPTOC1.TOC_CHAR4 BYTE rw - 8.4.3" "$(row DISPTOC1.TOC_CHAR4)" "a field that may be written"
    same "EXT_PLC BIT rw 0 own" "$(row EXT_PLC)" "a cell of our own"
    same "BLK[n].AxNCnMove BIT 0..15 r - 8.3.1" "$(row 'BLK[n].AxNCnMove')" "bits of a block"
    same "BLK[n].RPlcParams REAL[5] r - 8.3.4" "$(row 'BLK[n].RPlcParams')" "reals of a block"
    same 6 "$(grep -c '^POSITION_POS[1-5]_EX \|^B_POL_EX ' <<<"$said")" "spaces"
    exits 2 "$RKM04" signals x
}

test_the_same_as_json() {
    exits 0 "$RKM04" signals --json
    same "255" "$(python3 -c 'import json, sys
all = {row["name"]: row for row in json.load(sys.stdin)}
assert all["MPx"] == {"name": "MPx", "type": "BIT", "count": 6, "access": "r", "section": "8.1.6", "last_axis": "6", "preset": 0}
assert all["ZMMnPI"]["first"] == 1 and all["ZMMnPI"]["count"] == 14
assert all["NlcServoEnable"]["preset"] == 65535
assert "preset" not in all["BLK[n].M"] and all["BLK[n].M"]["count"] == 15
assert all["FILETIME_INFO.HIGH_FILETIME"]["type"] == "DWRD"
print(len(all))' <<<"$said")" "objects"
    exits 0 "$RKM04" signals
    same 256 "$(wc -l <<<"$said")" "lines with the head"
}

run_cases "$@"
