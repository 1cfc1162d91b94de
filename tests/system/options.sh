#!/bin/bash
# SPDX-License-Identifier: MIT
# Wrong options: exit status 2 and a message that names what was expected; --help and --version: 0, on stdout.

. "$(dirname "$0")/lib.sh"

# refused PART COMMAND...: usage error whose message has the part in it and whose output is empty.
refused() {
    exits 2 "${@:2}"
    holds "$complained" "$1" "'${*:2}' says what is wrong"
    same "" "$said" "stdout of '${*:2}'"
}

test_options_of_a_device_stand_below_its_head() {
    exits 0 "$RKM04" exec --help
    holds "$(sed -n '/device cib /,/device pmc-1hs /p' <<<"$said")" "comm-timeout=MS" "options of the CIB module"
    holds "$(sed -n '/device pmc-1hs /,/device pmc-2hs /p' <<<"$said")" "rep-counts=WHAT" "options of the PMC-1HS"
}

test_help_and_version_go_to_stdout() {
    local command
    for command in "$RKM04 --help" "$RKM04 serve --help" "$RKM04 exec --help" "$RKM04 test --help" \
        "$RKM04 replay --help" "$RKM04 lsp --help" "$RKMCTL --help" ${RKM04_WINDOW:+"$RKMCTL window --help"}; do
        # shellcheck disable=SC2086
        exits 0 $command
        holds "${said,,}" usage "'$command'"
        same "" "$complained" "stderr of '$command'"
    done
    for command in "$RKM04 --version" "$RKMCTL --version" ${RKM04_WINDOW:+"$RKMCTL window --version"} \
        "$RKM04 "{serve,exec,test,replay,check,fmt,explain,estimate,plot,lsp,devices,signals}" --version"; do
        # shellcheck disable=SC2086
        exits 0 $command
        holds "$said" 0.1.0 "'$command'"
    done
}

# long_options COMMAND...: the ones its --help lists, but those that every program has.
long_options() {
    "$@" --help | grep -o -E -e '--[a-z][a-z-]+' | grep -v -x -e --help -e --usage -e --version | sort -u
}

test_the_manual_pages_know_every_option_and_no_other() {
    local pages sub
    pages=$(dirname "$0")/../../docs/man
    in_page() {
        sed 's/\\f[A-Z]//g; s/\\//g' "$pages/$1" | grep -o -E -e '--[a-z][a-z-]+' | grep -v -x -e --help -e --version |
            sort -u
    }
    same "$(for sub in serve exec test replay plot devices; do long_options "$RKM04" "$sub"; done | sort -u)" \
        "$(in_page rkm04.1)" "options in rkm04.1"
    for sub in check fmt explain estimate lsp; do
        same "$(long_options "$RKM04" "$sub")" "$(in_page "rkm04-$sub.1")" "options in rkm04-$sub.1"
    done
    same "$(long_options "$RKMCTL")" "$(in_page rkmctl.1)" "options in rkmctl.1"
    [[ -z ${RKM04_WINDOW-} ]] ||
        same "$(long_options "$RKMCTL" window)" "$(in_page rkmctl-window.1)" "options in rkmctl-window.1"
}

test_help_hint_and_manual_page_name_every_subcommand() {
    local sub named hint
    named=$("$RKM04" --help | sed -nE 's/^  ([a-z]+)  .*/\1/p')
    exits 2 "$RKM04" frobnicate
    hint=$complained
    for sub in $named; do
        [[ $hint =~ \ $sub(,|\ ) ]] || fail "no $sub: $hint"
        grep -q "^\.B rkm04 $sub\$" "$(dirname "$0")/../../docs/man/rkm04.1" || fail "no rkm04 $sub in rkm04.1"
        exits 0 "$RKM04" "$sub" --help
        holds "$said" "Examples:" "examples of $sub"
    done
    holds "$named" lsp "subcommands"
}

test_no_or_an_unknown_subcommand_is_a_usage_error() {
    exits 2 "$RKM04"
    refused frobnicate "$RKM04" frobnicate
    exits 2 "$RKMCTL"
    refused frobnicate "$RKMCTL" -p "$folder/bus" frobnicate
}

test_values_out_of_range_are_usage_errors_of_serve() {
    local link=(--link "$folder/bus")
    refused 16 "$RKM04" serve "${link[@]}" --node 0
    refused 16 "$RKM04" serve "${link[@]}" --node 17
    refused 16 "$RKM04" serve "${link[@]}" --node one
    refused 16 "$RKM04" serve "${link[@]}" --node 1x
    refused 16 "$RKM04" serve "${link[@]}" --node ''
    refused hdlc "$RKM04" serve "${link[@]}" --framing morse
    refused 19200 "$RKM04" serve "${link[@]}" --baud 9600
    refused max "$RKM04" serve "${link[@]}" --clock slow
    refused max "$RKM04" serve "${link[@]}" --clock x0
    refused max "$RKM04" serve "${link[@]}" --clock x-1
    refused 2000 "$RKM04" serve "${link[@]}" --speed-change-latency 2001
    refused 2000 "$RKM04" serve "${link[@]}" --speed-change-latency -1
    refused 255 "$RKM04" serve "${link[@]}" --version-text "$(printf 'x%.0s' {1..256})"
    exits 2 "$RKM04" serve --no-such-option
    exits 2 "$RKM04" serve --node
    exits 2 "$RKM04" serve an-argument-too-many
    exits 2 "$RKM04" serve --link "$folder/bus" --port "$folder/device"
    [[ ! -L $folder/bus ]] || fail "a refused command line has left a link"
}

test_values_out_of_range_are_usage_errors_of_the_client() {
    local port=(-p "$folder/bus")
    refused 16 "$RKMCTL" "${port[@]}" -n 17 version
    refused 16 "$RKMCTL" "${port[@]}" -n -1 version
    refused 4 "$RKMCTL" "${port[@]}" -m 5 position
    refused hdlc "$RKMCTL" "${port[@]}" --framing morse version
    exits 2 "$RKMCTL" "${port[@]}" --timeout soon version
    exits 2 "$RKMCTL" "${port[@]}" set
    exits 2 "$RKMCTL" "${port[@]}" raw 0g
    exits 2 "$RKMCTL" "${port[@]}" raw 012
    exits 2 "$RKMCTL" "${port[@]}" version of what
    exits 2 "$RKMCTL" "${port[@]}" -m 0 table
    exits 2 "$RKMCTL" -p tcp:localhost version
}

test_what_cannot_be_printed_is_a_failure() {
    local command
    printf 'S100 F5 R\n' >"$folder/program.rks"
    printf 'steps:\n  - set: F5 R\n' >"$folder/scenario.yaml"
    serve bus --record "$folder/bus.record"
    export RKM04_CONTROL=$folder/bus.control
    for command in '--help' '--version' 'serve --help' 'serve --usage' 'exec --help' 'test --help' 'replay --help' \
        "exec $folder/program.rks" "exec --json $folder/program.rks" "exec --trace - $folder/program.rks" \
        "test --no-records $folder/scenario.yaml" "test --json --no-records $folder/scenario.yaml" \
        "replay $folder/bus.record" "replay --json $folder/bus.record" "serve --link $folder/other"; do
        # shellcheck disable=SC2086
        exits 1 to_full "$RKM04" $command
    done
    for command in '--help' '--usage' '--version' "-p $folder/bus version" "-p $folder/bus --json position" state \
        '--json state' di \
        'watch --once' clock 'call units'; do
        # shellcheck disable=SC2086
        exits 1 to_full "$RKMCTL" $command
    done
}

test_tools_whose_help_cannot_be_written_fail() {
    local tool tools
    tools=$(cd "$(dirname "$0")/../../tools" && pwd)
    for tool in conformance coverage differential digest-all fuzz mutate port-figures run soak test; do
        exits 0 "$tools/$tool" --help
        holds "${said,,}" "usage: " "$tool --help"
        exits 1 to_full "$tools/$tool" --help
    done
}

to_full() { "$@" >/dev/full; }

run_cases "$@"
