#!/bin/bash
# SPDX-License-Identifier: MIT
# `rkm04.exe serve' under Wine: units for clients on Linux and for a Windows program.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}" "${PORT_CLIENT=}"
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"
tests=$(cd "$(dirname "$0")" && pwd)

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

exe() { wine_in "$prefix" "$RKM04_EXE" "$@"; }

# serve_exe NAME OPTIONS...: a unit in Wine that is ready; $started is the process that waits for it.
serve_exe() {
    cd "$folder" || fail "cd"
    start "$1" wine_in "$prefix" "$RKM04_EXE" serve --verbose "${@:2}"
    soon "unit $1 is ready" ready "$1"
}

# part NAME KEY: what READY says of the key, a text.
part() { sed -n 's/^READY .*"'"$2"'":"\([^"]*\)".*/\1/p' "$folder/$1.out"; }

# end_exe NAME: Ctrl-C ends it; its exit status is in $status.
end_exe() {
    pkill -INT -P "$started" || fail "$1 has ended before"
    status_of "$started"
    same 0 "$status" "exit status of $1"
    holds "$(<"$folder/$1.err")" "ended by Ctrl-C" "the log of $1"
}

# at PORT ARGUMENTS...: the client of this system.
at() { "$RKMCTL" -p "$1" "${@:2}"; }

is_at() { [[ $(at "$1" position 2>"$folder/ctl.err") == "motor 1: $2" ]]; }

test_clients_here_use_a_unit_there_to_the_last_step() {
    serve_exe bus --tcp 0 --rfc2217 0 --plant "$tests/../../examples/linear-axis.plant.yaml" --coverage covered.txt \
        --record there.record --trace there.csv --wire there.log
    port=tcp:$(part bus tcp)
    same "01.02,06.03.2009" "$(at "$port" version 2>ctl.err)" "the version"
    same "motor 1: ok" "$(at "$port" set '\C100 S100 V1000 A2000 F500 R' 2>ctl.err)" "a program"
    soon "the last step" is_at "$port" 500
    exits 0 timeout 200 python3 "$tests/tcp_client.py" again "${port##*:}" 5
    end_exe bus
    exits 0 "$RKM04" replay --trace here.csv --wire here.log there.record
    holds "$said" "the same" "the recording replayed here"
    cmp here.csv there.csv || fail "the trace"
    cmp here.log there.log || fail "the log of the wires"
    holds "$(<covered.txt)" "messages" "the coverage report"
}

test_a_Windows_program_uses_a_unit_there() {
    [[ -f $PORT_CLIENT ]] || skip_case "the programs for Windows are not built"
    serve_exe bus --tcp 0
    port=tcp:$(part bus tcp)
    wine_in "$prefix" "$PORT_CLIENT" "$port" version motion version 2>wine.err | tr -d '\r' >checks.err
    same "2 1" "$(grep -cx 'ok version' checks.err) $(grep -cx 'ok motion' checks.err)" "its checks at $port"
    same "01.02,06.03.2009" "$(wine_in "$prefix" "${RKM04_EXE%/*}/rkmctl.exe" -p "$port" version 2>ctl.err)" "rkmctl.exe"
    end_exe bus
}

test_settings_of_an_RFC_2217_client_count() {
    serve_exe bus --rfc2217 0 --strict-line
    exec 3<>"/dev/tcp/127.0.0.1/$(part bus rfc2217 | sed 's/.*://')" || fail "connect"
    soon "the client is there" grep -q "has opened the bus" bus.err
    say_bytes 3 "fffb2c fffa2c0100002580fff0 7e01000858107e" # WILL COM-PORT, 9600 baud, a request
    soon "the log says so" grep -q "client is 9600 8N1, unit is 19200 8N1" bus.err
    exec 3>&-
    end_exe bus
}

test_host_software_with_pyserial_uses_a_unit_there() {
    local what url
    /usr/bin/python3 -c 'import serial.rfc2217' 2>/dev/null || skip_case "there is no pyserial; apt-get install python3-serial"
    serve_exe bus --framing plain --tcp 0 --rfc2217 0
    for what in talk settings; do
        for url in "socket://$(part bus tcp)" "rfc2217://$(part bus rfc2217)"; do
            exits 0 timeout 200 /usr/bin/python3 -W ignore "$tests/pyserial_client.py" "$what" "$url"
        done
    done
    end_exe bus
}

test_all_clocks_run() {
    serve_exe fast --tcp 0 --clock max
    at "tcp:$(part fast tcp)" set '\C100 S100 V1000 A2000 F50000 R' >ctl.out 2>ctl.err || fail "set"
    soon "50000 steps" is_at "tcp:$(part fast tcp)" 50000
    end_exe fast
    serve_exe scaled --tcp 0 --clock x20
    at "tcp:$(part scaled tcp)" set '\C100 S100 V1000 A2000 F5000 R' >ctl.out 2>ctl.err || fail "set"
    soon "5000 steps" is_at "tcp:$(part scaled tcp)" 5000
    end_exe scaled
}

test_several_buses_and_servers_of_a_device() {
    serve_exe buses --tcp 0 --lines 2 --node 1,2
    for port in $(grep -o '"tcp":"[^"]*"' buses.out | sed 's/.*:"//; s/"//' | sort -u); do
        same "01.02,06.03.2009" "$(at "tcp:$port" -n 2 version 2>ctl.err)" "unit 2 at $port"
    done
    end_exe buses
    serve_exe cib --device cib --tcp 0 --service modbus-tcp=0
    exec 3<>"/dev/tcp/127.0.0.1/$(part cib modbus-tcp | sed 's/.*://')" || fail "connect"
    dialogue 3 "0001 0000 0006 01 01 0000 0001" "0001 0000 0004 01 01 01 00" "a coil"
    exec 3>&-
    end_exe cib
}

test_what_Windows_does_not_have_is_refused() {
    cd "$folder" || fail "cd"
    for option in "--link bus" "--wine x:COM1" "--ready-fd 3" "--window" "--allow-folder ." "--no-sandbox"; do
        # shellcheck disable=SC2086
        exits 2 exe serve --tcp 0 $option
        holds "$complained" "${option%% *}: not in the program for Windows" "the message about $option"
    done
    exits 2 exe serve
    holds "$complained" "expected --tcp, --rfc2217 or --port" "the message without a port"
    serve_exe bus --tcp 0
    exits 1 exe serve --tcp "$(part bus tcp)"
    holds "$complained" "another program listens there" "the message about a port in use"
    end_exe bus
    exits 1 exe serve --tcp 0 --lines 256 --node 1-16 --flash f%l-%n.flash
    holds "$complained" "too many files: 4096, expected at most 2000" "the message about files"
    exits 1 exe serve --tcp 192.0.2.1:4001
    holds "$complained" "cannot listen at 192.0.2.1:4001" "the message about a strange address"
}

# options TEXT: the options that a text of --help lists.
options() { grep -oE '^ +(-., )?--[a-z0-9-]+' <<<"$1" | grep -oE '[-]-[a-z].*' | grep -vx -- --version | sort -u; }

test_help_shows_what_Windows_has() {
    local help word hidden="--allow-folder --link --no-sandbox --ready-fd --window --wine"
    cd "$folder" || fail "cd"
    exits 0 "$RKM04" serve --help
    options "$said" >here.txt
    exits 0 exe serve --help
    help=${said//'"pty":'/} # in READY
    options "$help" >there.txt
    same "$hidden" "$(comm -23 here.txt there.txt | xargs)" "what is not shown"
    same "" "$(comm -13 here.txt there.txt)" "what is shown there alone"
    for word in pty /dev/ '$XDG' SIGTERM Landlock --link --window; do
        [[ $help != *"$word"* ]] || fail "the help knows $word"
    done
    same "" "$(grep '^  rkm04 serve' <<<"$help" | grep -v -e --tcp -e --rfc2217 -e --port)" "examples that are refused"
    holds "$help" "rkm04 serve --port COM3" "the examples"
    exits 0 exe --help
    same "" "$(grep '^  rkm04 serve' <<<"$said" | grep -v -e --tcp -e --rfc2217 -e --port)" "examples of rkm04.exe --help"
}

# Wine's server has a descriptor for each socket of all programs.
test_256_buses_need_few_sockets() {
    (ulimit -n 1500 2>/dev/null) || skip_case "Wine needs 1500 descriptors: \`ulimit -Hn' is $(ulimit -Hn)"
    end_wine "$prefix"
    (ulimit -n 1500 && make_wine "$prefix") || fail "Wine with few descriptors"
    serve_exe buses --tcp 0 --lines 256 --node 1-16
    end_exe buses
    end_wine "$prefix"
}

# kill_exe: end it without a chance to tidy up.
kill_exe() {
    local program
    program=$(pgrep -P "$(pgrep -P "$started")") || fail "it has ended before"
    kill -KILL "$program"
    soon "it is dead" ended "$started"
}

# stored_program_survives HOW: store a program, end the unit, start it again on the same image.
stored_program_survives() {
    serve_exe bus --tcp 0 --clock max --flash unit.flash
    port=tcp:$(part bus tcp)
    exits 0 at "$port" set '\ C100 W100 F3000 R'
    exits 0 at "$port" store
    "$1" bus
    serve_exe bus --tcp 0 --clock max --flash unit.flash
    soon "the stored program has run by itself" is_at "tcp:$(part bus tcp)" 3000
    end_exe bus
}

test_a_stored_program_survives_the_end_of_the_unit() { stored_program_survives end_exe; }
test_a_stored_program_survives_a_killed_unit() { stored_program_survives kill_exe; }

test_an_image_from_there_is_one_here() {
    serve_exe bus --tcp 0 --clock max --flash unit.flash
    exits 0 at "tcp:$(part bus tcp)" set '\ C100 F250 R'
    exits 0 at "tcp:$(part bus tcp)" store
    end_exe bus
    same 32768 "$(stat -c %s unit.flash)" "bytes of the image"
    serve here --clock max --flash "$folder/unit.flash"
    soon "the program stored there runs here" position_is here 1 250
}

test_an_image_is_of_one_unit_alone_and_can_be_copied_meanwhile() {
    serve_exe bus --tcp 0 --flash unit.flash
    exits 1 exe serve --tcp 0 --flash unit.flash
    holds "$complained" "another emulator uses the flash image unit.flash" "the message"
    exits 1 exe serve --tcp 0 --flash ./UNIT.flash --record unit.flash # names have no case there
    wine_in "$prefix" cmd /c 'copy unit.flash copy.flash' >copy.out 2>&1 || fail "copy: $(<copy.out)"
    cmp unit.flash copy.flash || fail "the copy"
    end_exe bus
    exits 1 exe serve --tcp 0 --flash unit.flash --record unit.flash
    holds "$complained" "unit.flash" "the message about a file for two"
}

test_an_image_that_was_begun_is_finished_and_another_file_is_left_alone() {
    cd "$folder" || fail "cd"
    head -c 5000 /dev/zero | tr '\0' '\377' >begun.flash
    serve_exe bus --tcp 0 --flash begun.flash
    same 32768 "$(stat -c %s begun.flash)" "bytes of the image"
    end_exe bus
    echo precious >mine.txt
    exits 1 exe serve --tcp 0 --flash mine.txt
    holds "$complained" "mine.txt has 9 bytes and is no flash image" "the message"
    same precious "$(<mine.txt)" "the file"
    exits 1 exe serve --tcp 0 --flash none/unit.flash
    holds "$complained" "cannot open the flash image none/unit.flash" "the message without a folder"
}

# ---- The control socket ------------------------------------------------------------------------------------------------

test_the_control_socket_is_a_TCP_port_with_a_file_for_the_user_alone() {
    local file
    serve_exe bus --tcp 0 --clock stepped
    file=$(part bus control)
    holds "$file" "C:/users/" "the folder of the file"
    file=$prefix/drive_c/${file#C:/}
    same "tcp:$(part bus control_tcp)" "$(cut -d' ' -f1 "$file")" "the address in the file"
    [[ $(stat -c %A "$file") == *--- ]] || fail "others may read the file" # Wine gives the group what the user has
    exits 0 at "tcp:$(part bus tcp)" set '\ C100 F500 R'
    exits 0 "$RKMCTL" --control "$file" advance 10s
    exits 0 "$RKMCTL" --control "$file" state --json
    holds "$said" '"position":500' "the state"
    sed 's/ ./ x/' "$file" >wrong.control
    chmod 600 wrong.control
    exits 1 "$RKMCTL" --control wrong.control state
    exits 0 "$RKMCTL" --control "$file" shutdown
    status_of "$started"
    same 0 "$status" "exit status"
    [[ ! -e $file ]] || fail "the file is still there"
}

test_a_control_file_of_a_killed_unit_is_replaced_and_that_of_another_one_is_not() {
    cd "$folder" || fail "cd"
    serve_exe one --tcp 0 --control tcp:0 --control-file bus.control
    exits 0 "$RKMCTL" --control bus.control state
    exits 1 exe serve --tcp 0 --control tcp:0 --control-file bus.control
    holds "$complained" "another emulator" "the message"
    kill_exe
    serve_exe two --tcp 0 --control tcp:0 --control-file bus.control
    exits 0 "$RKMCTL" --control bus.control state
    end_exe two
    [[ ! -e bus.control ]] || fail "the file is still there"
    echo precious >mine.control
    exits 1 exe serve --tcp 0 --control tcp:0 --control-file mine.control
    same precious "$(<mine.control)" "a file of another kind"
}

# ---- A COM port --------------------------------------------------------------------------------------------------------

# begin_pair: COM$1 leads to one end of a pair of ptys; the other one is $folder/end.
begin_pair() {
    command -v socat >/dev/null || skip_case "there is no socat"
    start pair socat "pty,raw,echo=0,link=$folder/com" "pty,raw,echo=0,link=$folder/end"
    pair=$started
    soon "the pair is there" test -e "$folder/com" -a -e "$folder/end"
    ln -sfn "$folder/com" "$prefix/dosdevices/com$1"
}

test_a_unit_at_a_COM_port_is_used_to_the_last_step() {
    begin_pair 41
    serve_exe bus --port COM41 --record there.record
    same COM41 "$(part bus port)" "the port in READY"
    same "01.02,06.03.2009" "$(at "$folder/end" version 2>ctl.err)" "the version"
    same "motor 1: ok" "$(at "$folder/end" set '\C100 S100 V1000 A2000 F500 R' 2>ctl.err)" "a program"
    soon "the last step" is_at "$folder/end" 500
    end_exe bus
    exits 0 "$RKM04" replay there.record
    holds "$said" "the same" "the recording"
    serve_exe bus --port '\\.\COM41' --device pmc-1hs
    end_exe bus
    serve_exe bus --port COM41 --exit-when-idle=1
    status_of "$started"
    holds "$(<bus.err)" "no client has used the bus for 1 s" "the end of an idle unit"
}

test_a_Windows_program_and_a_unit_are_at_the_two_ends_of_a_pair() {
    local check
    [[ -f $PORT_CLIENT ]] || skip_case "the programs for Windows are not built"
    begin_pair 47
    ln -sfn "$folder/end" "$prefix/dosdevices/com48"
    serve_exe bus --port COM47
    wine_in "$prefix" "$PORT_CLIENT" COM48 version motion timeouts gap overlapped queue 2>wine.err | tr -d '\r' >checks.err
    for check in version motion timeouts gap overlapped queue; do
        grep -qx "ok $check" checks.err || fail "$check at COM48"
    done
    end_exe bus
}

test_a_client_of_the_COM_port_that_floods_and_does_not_read_holds_nothing_up() {
    begin_pair 42
    serve_exe bus --port COM42 --record there.record
    unit=$started
    start flood timeout "$limit" sh -c "yes '~~~~' | tr -d '\\n' >'$folder/end'"
    soon "bytes come" grep -q '"in"' there.record
    started=$unit
    end_exe bus
}

test_a_COM_port_that_goes_away_ends_the_unit() {
    begin_pair 43
    serve_exe bus --port COM43
    kill "$pair"
    status_of "$started"
    same 1 "$status" "exit status"
    holds "$(<bus.err)" "COM43 has disappeared" "the log"
}

test_a_COM_port_that_is_none_is_refused() {
    ln -sfn /dev/null "$prefix/dosdevices/com44"
    begin_pair 45
    for wrong in COM44 COM46 none; do
        exits 1 exe serve --port "$wrong"
        holds "$complained" "$wrong" "the message"
    done
    exits 1 exe serve --port COM45 --rts toggles
    holds "$complained" "--rts toggles: COM45 has no RTS" "the message about a pty"
    exits 2 exe serve --port COM45 --lines 2
}

run_cases "$@"
