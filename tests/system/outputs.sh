#!/bin/bash
# SPDX-License-Identifier: MIT
# Files that are written: they are never a file that is read, nor one that is written otherwise, and a file of another kind stays
# as it is.
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "${BASH_SOURCE%/*}/lib.sh"

program='S100 V1000 F5 R'

# is TEXT FILE: this and nothing else is in the file.
is() {
    [[ -f $2 ]] || fail "$2 is gone"
    printf '%s' "$1" | cmp -s - "$2" || fail "$2 is not as it was: $(head -c 200 "$2" | tr '\0' '?')"
}

scenario() {
    printf 'name: Five\nsteps:\n  - set: "F5 R"\n  - advance: 1s\n  - expect: {motor: 1, position: %s}\n' "$1"
}

# refused WHAT COMMAND...: the command says that it cannot write a file, naming WHAT.
refused() {
    local what=$1
    shift
    exits 1 timeout "$limit" "$@" # one that is not refused serves for ever
    holds "$complained" "cannot write" "'$*'"
    holds "$complained" "$what" "'$*'"
    holds "$complained" "choose another name" "'$*'"
}

# ---- rkm04 test ----------------------------------------------------------------------------------------------------------

test_a_forgotten_name_of_a_report_leaves_the_scenario() {
    cd "$folder" || exit 1
    scenario 5 >a.yaml
    scenario 5 >b.yaml
    refused "a.yaml: it exists and is not a JUnit report" "$RKM04" test --junit ./*.yaml
    is "$(scenario 5)"$'\n' a.yaml
    holds "$complained" "--force" "what to do"
    exits 0 "$RKM04" test --force --junit a.yaml b.yaml
    holds "$(<a.yaml)" "<testsuite" "the forced report"
}

test_a_report_is_no_file_that_is_read() {
    cd "$folder" || exit 1
    scenario 5 >a.yaml
    printf 'F5 R' >part.rks
    printf 'steps:\n  - program: part.rks\n' >b.yaml
    ln a.yaml hard.xml
    ln -s part.rks soft.xml
    exits 0 "$RKM04" test a.yaml b.yaml
    refused "hard.xml: it is the same file as a.yaml, which is read" "$RKM04" test --force --junit hard.xml a.yaml b.yaml
    refused "soft.xml: it is the same file as part.rks, which is read" "$RKM04" test --force --junit soft.xml a.yaml b.yaml
    refused "a.yaml: it is read" "$RKM04" test --force --junit a.yaml b.yaml a.yaml
    refused "it is the same file as standard input" sh -c "'$RKM04' test --force --junit a.yaml - <a.yaml"
    is "$(scenario 5)"$'\n' a.yaml
    is "F5 R" part.rks
}

test_the_recording_of_a_failure_is_no_file_that_is_read() {
    cd "$folder" || exit 1
    scenario 6 >first.yaml
    exits 3 "$RKM04" test first.yaml
    mv first.record start.record
    cp start.record kept
    printf 'steps:\n  - call: restore\n    params: {file: start.record}\n  - expect: {motor: 1, position: 77}\n' >start.yaml
    exits 3 "$RKM04" test start.yaml
    holds "$complained" "cannot write the recording ./start.record: it is" "stderr"
    cmp -s start.record kept || fail "the recording that is restored was overwritten"
    printf 'precious' >first.record
    exits 3 "$RKM04" test first.yaml
    holds "$complained" "first.record: it exists and is not a recording" "stderr"
    is precious first.record
}

# ---- rkm04 exec ----------------------------------------------------------------------------------------------------------

test_a_forgotten_name_of_a_trace_leaves_the_program() {
    cd "$folder" || exit 1
    printf '%s' "$program" | tee a.rks >b.rks
    refused "a.rks: it exists and is not a CSV trace" "$RKM04" exec -t ./*.rks
    is "$program" a.rks
    exits 0 "$RKM04" exec --force -t a.rks b.rks
    holds "$(<a.rks)" "t_us,source,event,value" "the forced trace"
}

test_a_trace_is_no_file_that_is_read() {
    cd "$folder" || exit 1
    printf '%s' "$program" >a.rks
    printf '10ms di 01 1\n' >in.txt
    ln -s in.txt soft.csv
    ln in.txt hard.vcd
    : >empty
    refused "in.txt: it is read" "$RKM04" exec --force -s in.txt -t in.txt a.rks
    refused "soft.csv: it is the same file as in.txt" "$RKM04" exec --force -s in.txt -t soft.csv a.rks
    refused "hard.vcd: it is the same file as in.txt" "$RKM04" exec --force -s in.txt -t hard.vcd a.rks
    refused "./a.rks: it is the same file as a.rks" "$RKM04" exec --force -t ./a.rks a.rks
    refused "empty: it is read" "$RKM04" exec -s empty -t empty a.rks
    refused "it is the same file as standard input" sh -c "'$RKM04' exec --force -t a.rks - <a.rks"
    refused "it is the same file as standard output" sh -c "'$RKM04' exec -t out.csv a.rks >out.csv"
    is "$program" a.rks
    is $'10ms di 01 1\n' in.txt
}

test_a_program_that_is_refused_leaves_the_trace_of_before() {
    cd "$folder" || exit 1
    printf '%s' "$program" >a.rks
    printf 'nonsense' >bad.rks
    exits 0 "$RKM04" exec -t run.csv a.rks
    cp run.csv kept
    exits 1 "$RKM04" exec -t run.csv bad.rks
    cmp -s run.csv kept || fail "the trace of before is gone"
}

test_pipes_and_devices_are_written_as_they_are() {
    cd "$folder" || exit 1
    printf '%s' "$program" >a.rks
    scenario 5 >a.yaml
    mkfifo pipe
    start reader timeout "$limit" cat pipe
    local reader=$started
    exits 0 "$RKM04" exec -t pipe a.rks
    status_of "$reader"
    holds "$(<reader.out)" "m1,step,5" "the trace through a pipe"
    [[ -p pipe ]] || fail "the pipe is gone"
    exits 0 sh -c "'$RKM04' exec --json -t /dev/stderr a.rks 2>&1 >/dev/null | cat"
    holds "$said" "m1,step,5" "the trace on a device of the shell"
    exits 0 "$RKM04" exec -t /dev/null a.rks
    exits 0 sh -c "'$RKM04' test --json --junit /dev/stderr a.yaml 2>&1 >/dev/null | cat"
    holds "$said" "<testsuite" "the report on a device of the shell"
}

# ---- rkm04 serve, replay -------------------------------------------------------------------------------------------------

outputs=(--trace t.csv --trace t.vcd --trace t.jsonl --wire w.log --wire w.pcapng --record s.record --coverage covered.txt
    --flash u.flash)

session() {
    serve bus "$@"
    ctl bus set "$program" >/dev/null 2>"$folder/ctl.err" || fail "no answer"
    kill "$started"
    status_of "$started"
    same 0 "$status" "the end of serve"
}

test_every_output_is_written_again() {
    cd "$folder" || exit 1
    session "${outputs[@]}"
    rm w.pcapng
    session "${outputs[@]}"
    session "${outputs[@]}"
    local file
    for file in t.csv t.vcd t.jsonl w.log w.pcapng s.record covered.txt covered.txt.json; do
        [[ -s $file ]] || fail "$file is empty"
    done
    exits 0 "$RKM04" replay --trace r.csv --trace r.vcd --trace r.jsonl --wire r.log --wire r.pcapng s.record
    exits 0 "$RKM04" replay --trace r.csv --trace r.vcd --trace r.jsonl --wire r.log --wire r.pcapng s.record
}

test_files_of_another_kind_stay() {
    cd "$folder" || exit 1
    session --record s.record
    local option file
    for option in "--trace f.csv" "--trace f.vcd" "--trace f.jsonl" "--wire f.log" "--wire f.pcapng"; do
        file=${option#* }
        printf 'precious' >"$file"
        # shellcheck disable=SC2086
        refused "$file: it exists and is not a" "$RKM04" serve --link "$folder/bus" $option
        is precious "$file"
        # shellcheck disable=SC2086
        refused "$file: it exists and is not a" "$RKM04" replay $option s.record
        is precious "$file"
        # shellcheck disable=SC2086
        exits 0 "$RKM04" replay --force $option s.record
    done
    for option in "--record f" "--coverage f" "--coverage f.json"; do
        file=${option#* }
        printf 'precious' >"$file"
        # shellcheck disable=SC2086
        refused "$file: it exists and is not a" "$RKM04" serve --link "$folder/bus" $option
        is precious "$file"
    done
    rm f.json
    printf 'precious' >f.txt.json
    refused "f.txt.json: it exists and is not a" "$RKM04" serve --link "$folder/bus" --coverage f.txt
    is precious f.txt.json
    session --force --record f
    holds "$(<f)" '{"rkm04_record"' "the forced recording"
    head -c 32767 /dev/zero >zero.flash
    exits 1 "$RKM04" serve --link "$folder/bus" --flash zero.flash
    holds "$complained" "zero.flash has 32767 bytes and is no flash image" "stderr"
}

test_one_file_is_written_once() {
    cd "$folder" || exit 1
    mkdir sub
    ln -s ../a.csv sub/b.csv
    session --flash u.flash
    cp u.flash kept
    refused "./a.csv: it is the same file as a.csv, which is written" "$RKM04" serve --link "$folder/bus" \
        --trace a.csv --trace ./a.csv
    refused "sub/b.csv: it is the same file as a.csv, which is written" "$RKM04" serve --link "$folder/bus" \
        --trace a.csv --trace sub/b.csv
    refused "same.csv: it is being written already" "$RKM04" serve --link "$folder/bus" --record same.csv --trace same.csv
    refused "./covered: it is the same file as covered, which is written" "$RKM04" serve --link "$folder/bus" \
        --record covered --coverage ./covered
    refused "u.flash: it is being written already" "$RKM04" serve --force --link "$folder/bus" --flash u.flash --record u.flash
    refused "all.log: it is the same file as standard error" sh -c \
        "'$RKM04' serve --link '$folder/bus' --wire all.log 2>all.log || { cat all.log >&2; exit 1; }"
    cmp -s u.flash kept || fail "the flash image was overwritten"
    refused "bus.lock: it is the same file as $folder/bus.lock, which is written" "$RKM04" serve --link "$folder/bus" \
        --record bus.lock
    cp u.flash unit1.flash
    ln -s unit1.flash unit2.flash
    exits 1 "$RKM04" serve --link "$folder/bus" --node 1,2 --flash unit%n.flash
    holds "$complained" "unit2.flash: it is the same file as unit1.flash, which is written" "one image for two units"
    session --record s.record
    cp s.record kept
    ln s.record hard.csv
    refused "hard.csv: it is the same file as s.record, which is read" "$RKM04" replay --force --trace hard.csv s.record
    refused "./r.vcd: it is the same file as r.vcd" "$RKM04" replay --trace r.vcd --trace ./r.vcd s.record
    cmp -s s.record kept || fail "the recording was overwritten"
}

# refusal COMMAND...: the command is refused; the folder `work` is as `before`.
refusal() {
    exits 1 timeout "$limit" "$@"
    diff -r before work >"$folder/diff.err" || fail "'$*': a file has changed, or is new"
}

# Whatever is wrong with the last of them, or with what comes behind them.
test_a_refused_serve_changes_no_file() {
    cd "$folder" || exit 1
    serve bus --trace a.csv --record old.record --trace old.csv
    kill "$started"
    status_of "$started"
    for file in a.csv old.csv old.record; do echo "of before" >>"$file"; done
    mkdir before work
    cp a.csv old.csv old.record before
    cp before/* work
    local -a serve=("$RKM04" serve --link ../link)
    refusal env -C work "${serve[@]}" --trace a.csv --trace ./a.csv
    refusal env -C work "${serve[@]}" --trace new.csv --trace ./new.csv
    refusal env -C work "${serve[@]}" --record old.record --trace old.csv --wire new.log --trace a.csv --wire ./new.log
    refusal env -C work "${serve[@]}" --flash new.flash --trace ./old.csv --record old.record --coverage ./old.csv
    refusal env -C work "${serve[@]}" --flash new.vcd --trace ./new.vcd
    refusal env -C work "${serve[@]}" --trace a.csv --coverage new.txt --record new.txt.json
    refusal env -C work "${serve[@]}" --trace a.csv --record new.record --flash new.flash --control missing/control
    refusal env -C work "${serve[@]}" --trace new.csv --trace a.csv --flash new.flash --tcp 127.0.0.1:0 --rfc2217 192.0.2.1:0
}

test_a_plant_is_never_overwritten() {
    cd "$folder" || exit 1
    printf 'motors:\n  1:\n    stops: {low: 0, high: 5000}\n' >axis.yaml
    cp axis.yaml kept
    session --trace t.csv
    cp t.csv trace
    refused "axis.yaml: it is read" "$RKM04" serve --force --link "$folder/bus" --plant axis.yaml --record axis.yaml
    cmp -s axis.yaml kept || fail "the plant was overwritten"
    printf 'nonsense: [' >bad.yaml
    exits 1 "$RKM04" serve --link "$folder/bus" --plant bad.yaml --trace t.csv --coverage c.txt
    cmp -s t.csv trace || fail "a plant that is refused has emptied the trace of before"
    [[ ! -e c.txt ]] || fail "a plant that is refused leaves a report behind"
}

# ---- The control socket --------------------------------------------------------------------------------------------------

control() {
    "$RKMCTL" -c "$folder/bus.control" "$@"
}

test_a_snapshot_replaces_regular_files_alone() {
    cd "$folder" || exit 1
    serve bus
    mkfifo pipe
    mkdir sub
    ln -s /dev/full device
    printf 'precious' >target
    ln -s target soft
    local name
    for name in pipe sub device soft bus.control; do
        exits 1 control snapshot "file=$name"
        holds "$complained" "$name" "the snapshot on $name"
        holds "$complained" "it is not a regular file: choose another name" "the snapshot on $name"
        exits 1 control snapshot --force "file=$name"
    done
    [[ -p pipe && -d sub && -L device && -L soft && -S bus.control ]] || fail "something was replaced"
    is precious target
    exits 1 control snapshot file=target
    holds "$complained" "target: it exists and is not a recording" "the snapshot on another file"
    is precious target
    exits 2 control state --force
    holds "$complained" "--force is for snapshot and trace start" "where there is nothing to force"
    exits 2 control call snapshot '{"file": "target", "force": 1}'
    holds "$complained" "force: expected true or false" "a wrong parameter"
    exits 0 control snapshot --force file=target
    holds "$(<target)" '{"rkm04_record"' "the forced snapshot"
    exits 0 control snapshot file=target
    exits 0 control restore file=target
    exits 0 control snapshot file=target
}

test_a_snapshot_leaves_the_files_beside_it() {
    cd "$folder" || exit 1
    serve bus --record s.record
    printf 'precious' | tee x.rkm.new x.rkm.tmp x.rkm~ >.x.rkm
    exits 0 control snapshot file=x.rkm
    exits 0 control snapshot file=x.rkm
    local name
    for name in x.rkm.new x.rkm.tmp x.rkm~ .x.rkm; do
        is precious "$name"
    done
    rm x.rkm.new x.rkm.tmp x.rkm~ .x.rkm x.rkm
    exits 1 control snapshot file=s.record
    holds "$complained" "s.record: it is" "the snapshot in place of the recording"
    chmod a-w . # nothing is left behind by one that fails
    control snapshot file=y.rkm 2>"$folder/bus.err"
    chmod u+w .
    rm -f y.rkm
    same "bus bus.control bus.control.lock bus.err bus.lock bus.out complained s.record" "$(ls -A | sort | xargs)" "the files"
}

test_a_trace_over_the_control_socket_leaves_other_files() {
    cd "$folder" || exit 1
    printf 'motors:\n  1:\n    stops: {low: 0, high: 5000}\n' >axis.yaml
    ln axis.yaml plant.csv
    serve bus --plant axis.yaml --trace run.csv
    printf 'precious' >other.csv
    ln -s run.csv soft.csv
    exits 1 control trace start other.csv
    holds "$complained" "other.csv: it exists and is not a CSV trace" "another file"
    is precious other.csv
    exits 1 control trace start --force plant.csv
    holds "$complained" "plant.csv: it is the same file as axis.yaml, which is read" "the plant"
    exits 1 control trace start soft.csv
    holds "$complained" "soft.csv: it is the same file as run.csv, which is written" "the trace of the command line"
    exits 0 control trace start --force other.csv
    ln other.csv again.csv
    exits 1 control trace start again.csv
    holds "$complained" "other.csv, which is written" "twice the same"
    exits 0 control trace stop
    exits 0 control trace start again.csv
    exits 0 control trace stop
}

run_cases "$@"
