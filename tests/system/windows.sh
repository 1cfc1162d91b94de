#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04.exe under Wine does what rkm04 does here, byte for byte.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}"
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"
examples=$(cd "$(dirname "$0")/../../examples" && pwd)

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

program='\C100 S100 V1000 A2000 F5000 R W100 L3 F100 R E'

exe() { wine_in "$prefix" "$RKM04_EXE" "$@"; }

# alike ARGUMENTS...: both programs print the same, complain the same, and end the same; $said is what they print.
alike() {
    local here there
    said=$("$RKM04" "$@" 2>"$folder/here.err" </dev/null; echo "status $?")
    here=$said
    there=$(exe "$@" 2>"$folder/there.err" </dev/null; echo "status $?")
    same "$here" "$there" "rkm04 $*"
    cmp -s "$folder/here.err" "$folder/there.err" || fail "rkm04 $*: complains otherwise"
}

begin() {
    cd "$folder" || fail "cd"
    printf '%s\n' "$program" >program.rks
}

test_the_scenarios_of_the_examples_pass() {
    alike test "$examples"/{faults,hand-over,linear-axis,turntable}.yaml "$examples"/manual/*.yaml
    holds "$said" ", 0 failed" "the result"
}

test_traces_are_the_same_byte_for_byte() {
    local form
    begin
    for form in csv vcd jsonl; do
        "$RKM04" exec --trace "here.$form" program.rks >here.out 2>&1 || fail "exec here"
        exe exec --trace "there.$form" program.rks >there.out 2>&1 || fail "exec there"
        cmp "here.$form" "there.$form" || fail "the trace .$form"
        cmp here.out there.out || fail "the state"
    done
}

test_tools_for_programs_say_the_same() {
    begin
    printf 'L3 F100 R\nQ5 E E' >wrong.rks
    for arguments in "check program.rks" "check wrong.rks" "check --json wrong.rks" "fmt --check program.rks" \
        "explain program.rks" "estimate program.rks" "exec --json program.rks" "plot -o - program.rks" "devices --json"; do
        # shellcheck disable=SC2086
        alike $arguments
    done
    cp program.rks there.rks
    "$RKM04" fmt program.rks && exe fmt there.rks || fail "fmt"
    cmp program.rks there.rks || fail "the formatted program"
}

test_wrong_usage_is_refused_in_the_same_words() {
    begin
    for arguments in "" "exce" "exec" "exec --nope" "exec --until" "exec --until=5x program.rks" "exec -Z" \
        "exec --json=1 program.rks" "test none.yaml" "replay" "--version"; do
        # shellcheck disable=SC2086
        alike $arguments
    done
}

test_a_file_of_another_kind_is_not_overwritten() {
    begin
    echo precious >mine.csv
    exe exec --trace mine.csv program.rks >/dev/null 2>said.err && fail "exec overwrites a file"
    holds "$(<said.err)" "mine.csv" "the message"
    exe exec --trace program.rks program.rks >/dev/null 2>&1 && fail "exec overwrites its program"
    same "precious $program" "$(<mine.csv) $(<program.rks)" "the files"
    exe exec --force --trace mine.csv program.rks >/dev/null 2>&1 || fail "--force"
    exe exec --trace mine.csv program.rks >/dev/null 2>&1 || fail "a trace is overwritten by a trace"
}

test_a_recording_from_there_is_replayed_here_and_the_other_way_round() {
    begin
    printf 'steps:\n  - set: F500 R\n  - wait: {motor: 1, position: 400}\n  - expect: {motor: 1, position: 499}\n' >fails.yaml
    mkdir -p here there
    "$RKM04" test --records here fails.yaml >/dev/null 2>&1
    exe test --records there fails.yaml >/dev/null 2>&1
    cmp here/fails.record there/fails.record || fail "the recordings"
    alike replay there/fails.record
}

test_paths_may_have_backslashes_and_letters_of_any_language() {
    begin
    mkdir "žluťoučký kůň"
    cp program.rks "žluťoučký kůň/p.rks"
    exe exec --json "1=žluťoučký kůň\\p.rks" >there.out 2>there.err || fail "exec"
    "$RKM04" exec --json program.rks >here.out
    cmp here.out there.out || fail "the state"
    exe exec --trace="žluťoučký kůň\\t.csv" program.rks >/dev/null 2>&1 || fail "a trace"
    [[ -s "žluťoučký kůň/t.csv" ]] || fail "the trace is elsewhere"
}

test_files_beside_a_scenario_are_found_by_backslashes_and_may_have_CRLF() {
    local file
    cd "$folder" || fail "cd"
    mkdir "kůň 1" "kůň 2"
    cp "$examples"/{linear-axis,linear-axis.plant,pmc-drill}.yaml "$examples"/pmc-drill.pmc "kůň 1"
    cp "$examples"/cnc872/*.{xml,plc,nc,yaml} "kůň 1"
    for file in "kůň 1"/*; do
        sed 's/$/\r/' "$file" >"kůň 2/${file##*/}"
    done
    for name in linear-axis pmc-drill part; do
        for file in "kůň 1\\$name.yaml" "kůň 2\\$name.yaml" "Z:${folder//\//\\}\\kůň 1\\$name.yaml"; do
            exits 0 exe test "$file"
            holds "$said" "pass " "the result of $file"
        done
    done
    local long
    long=$(printf 'x%.0s' {1..90})
    mkdir -p "$long/$long/$long"
    cp "kůň 1"/linear-axis* "$long/$long/$long"
    exits 0 exe test "$long\\$long\\$long\\linear-axis.yaml"
    exits 0 exe check --config="kůň 2\\mill.xml" "kůň 2\\mill.plc" "kůň 2\\part.nc"
    exits 1 exe exec --device pmc-1hs --device-option "program=kůň 1\\none.pmc" -
    holds "$complained" "kůň 1/none.pmc" "the message"
}

test_wildcards_are_the_files_that_there_are() {
    begin
    mkdir kůň
    cp program.rks "kůň/1.rks"
    echo 'Q5' >"kůň/2.rks"
    exits 1 exe check 'kůň\*.rks'
    holds "$said" "kůň/2.rks:1:1: error" "the message"
    exits 0 exe check '?ro*.rks'
    exits 1 exe check '*.pmc'
    holds "$complained" "cannot read *.pmc" "the message"
}

test_names_of_devices_are_no_files() {
    local name
    begin
    for name in con aux AUX.rks com1 prn lpt1.txt; do
        exits 1 exe exec "$name"
        holds "$complained" "$name: Windows has a device of this name" "the message"
    done
    exits 1 exe exec --trace con.csv program.rks
    exits 0 exe exec --trace nul program.rks
}

test_the_zip_has_the_program_documents_and_a_prompt() {
    begin
    (cd "${RKM04_EXE%/*}" && cpack -G ZIP -B "$folder/zip") >"$folder/cpack.err" 2>&1 || fail "cpack"
    cmake -E chdir "$folder" cmake -E tar xf "$folder"/zip/rkm04-*-windows.zip || fail "the zip"
    cd "$folder"/rkm04-*-windows || fail "the folder in it"
    [[ -f README.md && -f LICENSE && -f docs/WINDOWS.md && -f examples/linear-axis.yaml ]] || fail "documents"
    for script in rkm04-prompt.cmd rkm04-serve.cmd; do
        same "$("$RKM04" --version)" "$(wine_in "$prefix" cmd /c "$script" --version 2>/dev/null | tr -d '\r')" "$script"
    done
    same "$("$RKMCTL" --version)" "$(wine_in "$prefix" cmd /c rkm04-window.cmd --version 2>/dev/null | tr -d '\r')" "the window"
}

# The commands down to the first motion and behind it, as the document shows them: what follows three blanks is a remark.
test_the_first_commands_of_the_document_work() {
    begin
    ln -s "$examples" examples
    {
        printf '@echo off\r\n'
        sed -n '/^Unpack the zip/,/^What the programs print/s/^    \(.*\)/\1/p' "$examples/../docs/WINDOWS.md" |
            sed 's/   .*//; s/$/\r/; p; s/.*/if errorlevel 1 exit 1\r/'
    } >first.cmd
    same 7 "$(grep -c ^rkm04 first.cmd)" "commands of docs/WINDOWS.md"
    WINEPATH=$(dirname "$RKM04_EXE") wine_in "$prefix" cmd /c first.cmd >first.out 2>first.err || fail "$(<first.out)"
    holds "$(<first.out)" "at 5.412000 s: finished" "the first motion"
    [[ -s first.html && -s first.vcd ]] || fail "a picture and a trace"
}

# rkmctl.exe at $port of the unit $folder/bus.
ctl_exe() { wine_in "$prefix" "${RKM04_EXE%/*}/rkmctl.exe" -p "$port" "$@"; }

is_at() { [[ $(ctl_exe position 2>/dev/null) == "motor 1: $1" ]]; }

test_rkmctl_talks_to_a_unit_over_TCP_and_a_COM_port() {
    begin
    serve bus --tcp 0 --wine "$prefix:COM33"
    for port in COM33 "tcp:$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' bus.out)"; do
        same "01.02,06.03.2009" "$(ctl_exe version 2>ctl.err)" "the version at $port"
        same "motor 1: ok" "$(ctl_exe set '\C100 S100 V1000 A2000 F500 R' 2>ctl.err)" "a program at $port"
        soon "the last step at $port" is_at 500
        ctl_exe -m 2 send program.rks >ctl.out 2>ctl.err || fail "send at $port"
        same "$program" "\\$(ctl_exe -m 2 command 2>ctl.err)" "the program in the unit at $port"
        same '{"motor":1,"position":500}' "$(ctl_exe --json position 2>ctl.err)" "as JSON at $port"
        ctl_exe -n 5 --timeout 200 version >ctl.out 2>ctl.err
        same 3 $? "exit status without an answer at $port"
        ctl_exe -m 2 set '\' >ctl.out 2>ctl.err || fail "stop at $port"
    done
}

test_rkmctl_reports_a_port_that_is_not_there() {
    begin
    for port in COM77 tcp:127.0.0.1:1; do
        ctl_exe version >ctl.out 2>ctl.err
        same 1 $? "exit status at $port"
        holds "$(<ctl.err)" "$port" "the message"
    done
}

run_cases "$@"
