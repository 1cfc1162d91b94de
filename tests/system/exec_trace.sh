#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 exec --trace: every row of small programs, to the byte.

. "$(dirname "$0")/lib.sh"

# traces ROWS ARGUMENTS...: rkm04 exec ends well and its trace has these rows; the program is run.rks.
traces() {
    cd "$folder" || exit 1
    exits 0 "$RKM04" exec --trace run.csv "${@:2}"
    { echo t_us,source,event,value && printf '%s' "$1"; } >wanted.csv
    diff wanted.csv run.csv >difference || fail "the trace differs (< wanted, > got): $(<difference)"
}

test_R1_there_and_back_with_every_kind_of_row() {
    # S = V: a pulse every 10 ms (R3). The first slot is at 1 ms; a command a slot; after a motion the first slot at or
    # after its last pulse + 10 us (K4).
    printf 'S100 V100 F2 R T06 T81 D R C06 X01' >"$folder/run.rks"
    traces "1000,m1,command,1
2000,m1,command,2
3000,m1,command,3
4000,m1,command,4
4000,m1,dir,1
4000,m1,led,on
4000,m1,motion,begin
14000,m1,step,1
24000,m1,step,2
24000,m1,led,off
24000,m1,motion,end
25000,m1,command,5
25000,unit,do,32
26000,m1,command,6
26000,unit,var,2
27000,m1,command,7
28000,m1,command,8
28000,m1,dir,-1
28000,m1,led,on
28000,m1,motion,begin
38000,m1,step,1
48000,m1,step,0
48000,m1,led,off
48000,m1,motion,end
49000,m1,command,9
49000,unit,do,0
50000,m1,command,10
51000,m1,command,0
" run.rks
}

test_a_program_of_nothing_has_no_rows() {
    printf '{ nothing }\n' >"$folder/run.rks"
    traces "" run.rks
}

test_the_trace_goes_to_standard_output_and_the_table_does_not() {
    printf 'W5' >"$folder/run.rks"
    cd "$folder" || exit 1
    exits 0 "$RKM04" exec --trace - run.rks
    same $'t_us,source,event,value\n1000,m1,command,1\n6000,m1,command,0' "$said" "standard output"
    holds "$complained" "motor     position" "standard error"
}

test_T41_takes_the_pulses_away_and_the_counter_counts() {
    printf 'S100 V100 T41 F2 R' >"$folder/run.rks"
    cd "$folder" || exit 1
    exits 0 "$RKM04" exec --json --trace run.csv run.rks
    holds "$said" '{"motor":1,"position":2,"state":"idle"' "the counter"
    same "" "$(grep ,step, run.csv)" "rows of pulses"
    same 1 "$(grep -c ,motion,begin run.csv)" "motions"
}

test_a_million_pulses_are_traced() {
    printf 'S2000 V16000 A60000 F1000000 R' >"$folder/run.rks"
    cd "$folder" || exit 1
    exits 0 "$RKM04" exec --trace run.csv run.rks
    same 1000000 "$(grep -c ',m1,step,' run.csv)" "rows of pulses"
    # N/V + (V - S)^2/(A V) = 62.5 s + 0.204166... s after R at 5 ms.
    holds "$(grep ',m1,step,1000000' run.csv)" 62709167,m1,step,1000000 "the last pulse"
}

test_a_trace_that_cannot_be_written_is_a_failure() {
    printf 'S100 V1000 A2000 F100000 R' >"$folder/run.rks"
    cd "$folder" || exit 1
    exits 1 "$RKM04" exec --trace /dev/full run.rks
    holds "$complained" "cannot write the trace /dev/full: No space left" "stderr"
    exits 1 "$RKM04" exec --trace no/such/folder.csv run.rks
    holds "$complained" "cannot write the trace no/such/folder.csv: No such file" "stderr"
    exits 1 sh -c "'$RKM04' exec --json run.rks >/dev/full"
    holds "$complained" "cannot write the final state" "stderr"
}

test_a_reader_that_goes_away_ends_the_run() {
    printf 'S100 V100 A2000 G+' >"$folder/run.rks"
    cd "$folder" || exit 1
    start run sh -c "'$RKM04' exec --until 999999999s --trace - run.rks 2>errors | head -n 5; wait"
    status_of "$started"
    soon "the run has told why" grep -q 'cannot write the trace' errors
}

run_cases "$@"
