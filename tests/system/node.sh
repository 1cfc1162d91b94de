#!/bin/bash
# SPDX-License-Identifier: MIT
# Host software with node-serialport on the pty; npm installs it into the build folder, once (tools/setup.sh).

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/setup.sh"

client=$(dirname "$0")/node/client.js
modules=${BUILD-${TMPDIR-/tmp}}/node-serialport
export NODE_PATH=$modules/node_modules
setup_serialport "$modules" || skip_all "there is no node with npm, or npm cannot install serialport (see $modules/npm.log)"

test_node_serialport_opens_talks_closes_and_opens_again() {
    serve bus --framing plain --clock max
    exits 0 node "$client" talk "$folder/bus"
}

test_node_serialport_changes_the_speed() {
    serve bus --framing plain
    exits 0 node "$client" update "$folder/bus"
}

test_node_serialport_keeps_a_second_one_out() {
    serve bus --framing plain
    exits 0 node "$client" lock "$folder/bus"
}

run_cases "$@"
