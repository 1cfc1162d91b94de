#!/bin/bash
# SPDX-License-Identifier: MIT
# rkmctl without --port and --control: it finds the one emulator that is running, or says which there are. In a network namespace
# of its own, where no emulator of another test can be seen.

if [[ -z ${FIND_ALONE-} ]]; then
    map=()
    [[ $(id -u) == 0 ]] || map=(--map-root-user)
    FIND_ALONE=1 exec unshare --net "${map[@]}" "$0" "$@"
fi
. "$(dirname "$0")/lib.sh"

# Nothing of the environment says where an emulator is.
unset RKM04_PORT RKM04_CONTROL RKM04_NODE RKM04_TIMEOUT
export XDG_RUNTIME_DIR=/nonexistent

test_without_an_emulator_it_says_what_to_do() {
    export TMPDIR=$folder
    exits 2 "$RKMCTL" version
    holds "$complained" "no emulator of yours is running: expected --port" "what is said"
    exits 1 "$RKMCTL" state
    holds "$complained" "expected --control, or a running \`rkm04 serve'" "the same for the control socket"
}

test_the_one_that_is_running_is_found() {
    export TMPDIR=$folder
    serve bus --node 3
    exits 0 "$RKMCTL" -n 3 version
    exits 0 env RKM04_NODE=3 "$RKMCTL" position
    same "motor 1: 0" "$said" "the position"
    exits 0 "$RKMCTL" state
    exits 2 env RKM04_NODE=17 "$RKMCTL" position
    holds "$complained" "RKM04_NODE" "a wrong address in the environment"
}

test_the_environment_says_how_long_an_answer_is_waited_for() {
    export TMPDIR=$folder
    serve bus
    exits 3 env RKM04_TIMEOUT=201 "$RKMCTL" -n 2 version
    holds "$complained" "within 201 ms" "what is said"
    exits 3 env RKM04_TIMEOUT=100000 "$RKMCTL" -n 2 --timeout 202 version
    holds "$complained" "within 202 ms" "the option goes first"
    exits 2 env RKM04_TIMEOUT=soon "$RKMCTL" version
    holds "$complained" "RKM04_TIMEOUT" "a wrong time in the environment"
    exits 0 env RKM04_TIMEOUT=soon "$RKMCTL" state
}

test_of_several_one_is_to_be_chosen() {
    export TMPDIR=$folder
    serve one
    serve two
    exits 2 "$RKMCTL" version
    holds "$complained" "--port $folder/one" "the first"
    holds "$complained" "--port $folder/two" "the second"
    exits 0 env RKM04_PORT="$folder/two" "$RKMCTL" version
    exits 1 "$RKMCTL" state
    holds "$complained" "--control $folder/two.control" "the control socket"
}

test_each_command_has_help() {
    local command
    for command in $("$RKMCTL" --help | sed -n '/^Commands/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
        exits 0 "$RKMCTL" "$command" --help
        holds "$said" "Usage: rkmctl [OPTION...] $command" "help for $command"
        holds "$said" "  rkmctl " "an example"
    done
}

run_cases "$@"
