#!/bin/bash
# SPDX-License-Identifier: MIT
# What a newcomer sees who starts a unit for the first time: hints that work, a control socket in every mode, a log that is quiet.

. "$(dirname "$0")/lib.sh"
tools=$(cd "$(dirname "$0")/../../tools" && pwd)

# A copy of the tools whose build is the programs under test, started by tools/run with what it needs already there.
prepare_run() {
    mkdir -p "$folder/top/tools" "$folder/top/build/release" "$folder/bin"
    cp "$tools/run" "$tools/setup.sh" "$folder/top/tools"
    ln -s "$RKM04" "$RKMCTL" "$folder/top/build/release"
    {
        echo '#!/bin/sh'
        # shellcheck disable=SC2016
        echo 'case $1 in --build) for i in 1 30 60 100; do printf "[%3d%%] Building\n" $i; done;; esac'
    } >"$folder/bin/cmake"
    chmod +x "$folder/bin/cmake"
}

# run_tool OPTIONS...: tools/run; what is typed comes from the descriptor 8.
run_tool() {
    mkfifo "$folder/typed"
    PATH=$folder/bin:$PATH "$folder/top/tools/run" "$@" >"$folder/run.out" 2>"$folder/run.err" <"$folder/typed" &
    started=$!
    processes+=("$started")
    exec 8>"$folder/typed"
    soon "there are hints" shown 1
}

shown() {
    [[ $(grep -c '^Ctrl-C ends' "$folder/run.out") == "$1" ]]
}

# Every command among the hints, but the panel, works as it is printed.
follow_hints() {
    local commands line
    mapfile -t commands < <(grep '^  .*rkmctl ' "$folder/run.out")
    ((${#commands[@]} >= 1)) || fail "no command in the hints"
    for line in "${commands[@]}"; do
        [[ $line == *' watch' ]] && line+=' --once'
        if [[ $line == *' --open' ]]; then # the window: without a browser, until it has its address
            local unit=$started
            start window bash -c "exec ${line% --open}"
            soon "the window serves" grep -q '^WINDOW http://' "$folder/window.out"
            kill "$started" && wait "$started" || fail "exit status $? of the window"
            started=$unit
            continue
        fi
        exits 0 bash -c "$line"
    done
    grep -q OTHER_END "$folder/run.out" && fail "a word to be replaced"
    return 0
}

test_the_hints_of_a_unit_on_a_pty_work_as_printed() {
    prepare_run
    run_tool --link "$folder/a bus"
    follow_hints
    grep -q ' version$' "$folder/run.out" || fail "no request to the unit"
}

test_where_Wine_is_installed_a_hint_says_how_Windows_programs_find_the_unit() {
    prepare_run
    printf '#!/bin/sh\n' >"$folder/bin/wine"
    chmod +x "$folder/bin/wine"
    run_tool --link "$folder/bus"
    grep -q -- '--wine ~/.wine:COM5' "$folder/run.out" || fail "no word of --wine"
    grep -q 'LD_PRELOAD=.*/rkm04-modem-lines.so wine PROGRAM.exe$' "$folder/run.out" || fail "no command"
}

test_the_hints_of_a_unit_on_TCP_work_as_printed() {
    prepare_run
    run_tool --tcp 127.0.0.1:0 --node 3 --framing plain
    follow_hints
    grep -q ' -p tcp:127.0.0.1:[0-9]* -n 3 --framing plain version$' "$folder/run.out" || fail "no address of the unit"
}

test_the_hints_of_a_unit_on_RFC_2217_or_a_device_name_what_works() {
    local device port
    prepare_run
    run_tool --rfc2217 127.0.0.1:0
    follow_hints
    grep -q 'rfc2217://127.0.0.1:[0-9]' "$folder/run.out" || fail "no address"
    kill -TERM "$started"
    status_of "$started"
    rm "$folder/typed"
    start bridge socat "PTY,raw,echo=0,link=$folder/near" "PTY,raw,echo=0,link=$folder/far"
    soon "the device is there" test -e "$folder/far"
    run_tool --port "$folder/far"
    follow_hints
    grep -q "The units are on $folder/far" "$folder/run.out" || fail "no device"
}

test_Enter_shows_the_hints_again_and_nothing_is_left_at_the_end() {
    prepare_run
    run_tool
    echo >&8
    soon "the hints are there again" shown 2
    kill -TERM "$started"
    status_of "$started"
    same 0 "$status" "exit status"
    soon "no process reads the terminal any more" nobody_reads
    grep -q 'building: 100 %' "$folder/run.err" || fail "no progress of the build"
}

# No process has the pipe open that stands for the terminal.
nobody_reads() {
    ! (echo >&8) 2>/dev/null
}

test_every_way_to_start_has_a_control_socket_of_its_own() {
    local way control found=' '
    start bridge socat "PTY,raw,echo=0,link=$folder/near" "PTY,raw,echo=0,link=$folder/far"
    soon "the device is there" test -e "$folder/far"
    for way in '' '--tcp 0' '--tcp 0' '--rfc2217 0' "--port $folder/far"; do
        # shellcheck disable=SC2086
        start unit "$RKM04" serve $way
        soon "the unit is ready" ready unit
        control=$(sed -n 's/^READY .*"control":"\([^"]*\)".*/\1/p' "$folder/unit.out")
        [[ $control == "$XDG_RUNTIME_DIR"/* ]] || fail "serve $way: control socket '$control'"
        [[ $found == *" $control "* ]] && fail "serve $way: two have $control"
        found+="$control "
        exits 0 "$RKMCTL" -c "$control" state
    done
}

test_a_path_of_any_length_in_READY_is_taken_by_the_client() {
    local long
    long=$folder/$(printf 'x%.0s' {1..90})/$(printf 'y%.0s' {1..90})
    mkdir -p "$long"
    serve bus --control "$long/control"
    exits 0 "$RKMCTL" -c "$long/control" state
    exits 1 "$RKMCTL" -c "$long/other" state
    holds "$complained" "$long/other" "the message names the path"
    start other "$RKM04" serve --link "$long/bus"
    soon "the unit is ready" ready other
    exits 0 "$RKMCTL" -c "$long/bus.control" state
}

test_clients_that_come_and_go_are_logged_with_verbose_only() {
    local address
    start bus "$RKM04" serve --link "$folder/bus" --tcp 127.0.0.1:0
    soon "the unit is ready" ready bus
    address=$(sed -n 's/^READY .*"tcp":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    exits 0 ctl bus version
    exits 0 "$RKMCTL" -p "tcp:$address" version
    kill -TERM "$started"
    status_of "$started"
    grep 'client' "$folder/bus.err" && fail "a client in the log"
    start bus "$RKM04" serve --link "$folder/bus" --verbose
    soon "the unit is ready" ready bus
    exits 0 ctl bus version
    soon "both are in the log" grep -q 'client has closed' "$folder/bus.err"
    grep -q 'client has opened' "$folder/bus.err" || fail "no client in the log"
}

test_a_mistyped_command_is_answered_with_all_there_are_and_the_nearest() {
    exits 2 "$RKM04" bogus
    holds "$complained" "expected serve, exec, check, fmt, explain, estimate, lsp, test, replay, plot, devices or signals" "all"
    [[ $complained != *mean* ]] || fail "nothing is near: $complained"
    exits 2 "$RKM04" reply
    holds "$complained" "did you mean \`replay'?" "the nearest"
    exits 2 "$RKM04"
    holds "$complained" "expected serve, exec, check, fmt, explain, estimate, lsp, test, replay, plot, devices or signals" "all"
    exits 2 "$RKMCTL" positon
    holds "$complained" "did you mean \`position'?" "the nearest of a unit"
    exits 2 "$RKMCTL" wiat
    holds "$complained" "did you mean \`wait'?" "the nearest of an emulator"
}

# slip NEAREST COMMAND...: a wrong command line, whose answer proposes what is meant.
slip() {
    exits 2 "${@:2}"
    holds "$complained$said" "did you mean \`$1'?" "the answer to ${*:2}"
}

test_a_slip_in_any_name_is_answered_with_the_nearest() {
    local ctl=("$RKMCTL" -c "$folder/bus.control")
    serve bus --clock stepped
    slip --node "$RKM04" serve --nde 3
    slip --turnaround "$RKM04" serve --node 3 --turnaruond=5
    slip --json "$RKM04" devices --jsn
    slip --json "$RKM04" exec --config --jsnn --jsn
    slip --timeout "$RKMCTL" --timout 3 version
    slip --help "$RKM04" --hlp
    slip step "${ctl[@]}" events setp
    slip drop "${ctl[@]}" fault inject drp
    slip direction "${ctl[@]}" fault inject drop direcion=both
    slip jammed "${ctl[@]}" plant motor=1 jamed=true
    slip unit "${ctl[@]}" call di.set mask=1 unt=1
    slip idle "${ctl[@]}" wait m1.state=idl
    slip position "${ctl[@]}" wait 'm1.positon>=5'
    slip powered "${ctl[@]}" wait pwered=1
    printf 'steps:\n  - st: F1 R\n' >"$folder/step.yaml"
    slip set "$RKM04" test "$folder/step.yaml"
    printf 'steps:\n  - wait: {motor: 1, sate: idle}\n' >"$folder/condition.yaml"
    slip state "$RKM04" test "$folder/condition.yaml"
    exits 2 "$RKM04" serve --nde 3 --trun 4
    [[ $complained != *mean*mean* ]] || fail "two are proposed: $complained"
    exits 2 "$RKM04" serve --node 17
    [[ $complained != *mean* ]] || fail "one is proposed for a right name: $complained"
}

# says COMMAND...: it is refused, and the last argument is named as what it seems to be.
says() {
    local guess=$1
    shift
    "$RKM04" "$@" >/dev/null 2>"$folder/complained" </dev/null && fail "rkm04 $* takes it"
    grep -qF "note: ${*: -1} seems to be $guess" "$folder/complained" || fail "rkm04 $*: expected that it seems to be $guess"
}

test_a_file_of_another_kind_is_named() {
    cd "$folder" || fail "cd"
    printf 'S100 V5000 A5000 F100 R' >a.rks
    printf 'name: x\nsteps:\n  - {advance: 1s}\n' >scenario.txt
    printf '<?xml version="1.0"?>\n<ChannelConfig/>\n' >mill.xml
    printf '; c\nMODULE_MAIN\nMODULE_MAIN_END\n' >mill.plc
    exits 0 "$RKM04" exec --trace pulses.csv a.rks
    exits 0 "$RKM04" exec --trace pulses.vcd a.rks
    printf '{"rkm04_record":1,"nodes":[1]}\n' >bus.record
    cp pulses.csv csv.txt
    head -c 1000 /dev/zero >flash.bin
    for command in check fmt explain estimate exec plot; do
        says "a scenario, for \`rkm04 test'" "$command" scenario.txt
        says "a VCD trace" "$command" pulses.vcd
    done
    says "a recording, for \`rkm04 replay'" test bus.record
    says "a trace as CSV, for \`rkm04 plot'" replay csv.txt
    says "a scenario, for \`rkm04 test'" replay scenario.txt
    says "no text" replay flash.bin
    says "a PLC program of a CNC872" exec --device cnc872 --config mill.plc
    says "a configuration of a CNC872" exec --device cnc872 --plc mill.xml
    says "a configuration of a CNC872" exec --device cnc872 --nc mill.xml
    exits 0 "$RKM04" check a.rks mill.xml mill.plc
    same "" "$complained" "what fits"
}

test_help_is_a_word_too() {
    local whole
    exits 0 "$RKM04" serve --help
    whole=$said
    exits 0 "$RKM04" help serve
    same "$whole" "$said" "rkm04 help serve"
    exits 0 "$RKMCTL" --help
    whole=$said
    exits 0 "$RKMCTL" help
    same "$whole" "$said" "rkmctl help"
    exits 0 "$RKMCTL" wait --help
    whole=$said
    exits 0 "$RKMCTL" help wait
    same "$whole" "$said" "rkmctl help wait"
    exits 2 "$RKMCTL" help wiat
    holds "$complained" "did you mean \`wait'?" "a slip"
}

# Lines fit a terminal of 80 columns, and each command names its exit statuses.
test_help_fits_a_terminal_and_has_the_exit_status() {
    local command
    for command in '' serve exec check fmt explain estimate lsp test replay plot devices signals; do
        # shellcheck disable=SC2086
        exits 0 "$RKM04" $command --help
        holds "$said" "Exit status: " "rkm04 $command --help"
        same "" "$(grep -E '^.{81}' <<<"$said")" "long lines of rkm04 $command --help"
    done
    exits 0 "$RKMCTL" --help
    same "" "$(grep -E '^[a-z]+$|^.{81}' <<<"$said")" "lines of rkmctl --help that are broken in their middle, or long"
    for command in $(sed -n 's/^  \([a-z]*\) .*/\1/p' <<<"$said"); do
        [[ $command == rkmctl ]] && continue
        exits 0 "$RKMCTL" "$command" --help
        holds "$said" "Exit status: " "rkmctl $command --help"
        same "" "$(grep -E '^.{81}' <<<"$said" | grep -v '^Usage')" "long lines of rkmctl $command --help"
    done
}

test_a_command_for_another_device_names_it() {
    serve bus --clock stepped
    exits 1 "$RKMCTL" -c "$folder/bus.control" cnc get PO_STOP
    holds "$complained" "there is no method \`cnc.get' of the device rkm04: cnc872 has it" "the answer"
    exits 1 "$RKMCTL" -c "$folder/bus.control" cib status
    holds "$complained" "of the device rkm04: cib has it" "the answer"
}

test_a_character_that_cannot_be_seen_is_named() {
    local space=$'\xc2\xa0' none=$'\xe2\x80\x8b'
    local name='a no-break space (U+00A0)' other='a zero-width space (U+200B)'
    printf 'steps:\n  - wait: {motor%s: 1}\n' "$space" >"$folder/condition.yaml"
    printf '%ssteps:\n  - advance: 1s\n' "$none" >"$folder/steps.yaml"
    printf '{"t":0,%s"in":"7e"}\n' "$space" >"$folder/bad.record"
    "$RKM04" test --no-records "$folder/condition.yaml" >"$folder/said" 2>&1
    holds "$(<"$folder/said")" "$name" "a condition in YAML"
    "$RKM04" test --no-records "$folder/steps.yaml" >"$folder/said" 2>&1
    holds "$(<"$folder/said")" "$other" "YAML"
    "$RKM04" replay "$folder/bad.record" >"$folder/said" 2>&1
    holds "$(<"$folder/said")" "$name" "a recording"
    serve bus
    "$RKMCTL" --control "$folder/bus.control" wait "m1.position>=${space}5" >"$folder/said" 2>&1
    holds "$(<"$folder/said")" "$name" "a condition"
    "$RKMCTL" --control "$folder/bus.control" call di.set "{\"mask\":${space}1}" >"$folder/said" 2>&1
    holds "$(<"$folder/said")" "$name" "JSON"
    exits 2 "$RKM04" serve --node "1$space"
    holds "$complained" "$name" "a value of an option"
    exits 2 "$RKM04" exec "--un${none}til=1s" "$folder/none.rks"
    holds "$complained" "$other" "the name of an option"
    exits 2 "$RKMCTL" -p "$folder/bus" -m "1$space" position
    holds "$complained" "$name" "an option of rkmctl"
    [[ $complained != *"$name"*"$name"* ]] || fail "it is named twice: $complained"
    exits 2 "$RKMCTL" -p "$folder/bus" --framing "hdlc$none" version
    holds "$complained" "$other" "another option of rkmctl"
}

test_state_tells_what_is_in_flash_now() {
    serve bus --clock stepped --flash "$folder/flash"
    exits 0 ctl bus set 'W5'
    exits 0 "$RKMCTL" -c "$folder/bus.control" state
    holds "$said" "flash empty" "before"
    exits 0 ctl bus store
    exits 0 "$RKMCTL" -c "$folder/bus.control" state
    holds "$said" "flash stored" "behind store"
    exits 0 "$RKMCTL" -c "$folder/bus.control" reset
    exits 0 "$RKMCTL" -c "$folder/bus.control" state
    holds "$said" "flash loaded" "behind power-up"
}

run_cases "$@"
