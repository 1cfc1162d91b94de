#!/bin/bash
# SPDX-License-Identifier: MIT
# The host programs in C and JavaScript under examples/, each tested by its own command.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/setup.sh"

examples=$(cd "$(dirname "$0")/../../examples" && pwd)
modules=${BUILD-${TMPDIR-/tmp}}/node-serialport
export RKM04 RKMCTL

test_the_program_in_C_with_Check() {
    exits 0 make -C "$examples/c" check BUILD="$folder"
    holds "$said" "Checks: 4, Failures: 0, Errors: 0" "the tests of examples/c"
}

test_the_program_with_node_serialport() {
    setup_serialport "$modules" || skip_case "there is no node with npm, or npm cannot install serialport (see $modules/npm.log)"
    NODE_PATH=$modules/node_modules exits 0 npm --prefix "$examples/node" test
    holds "$said" "# pass 5" "the tests of examples/node"
}

run_cases "$@"
