#!/bin/bash
# SPDX-License-Identifier: MIT
# Host software with node-serialport on the pty. Where node does not know it, npm installs it into the build folder, once.

. "$(dirname "$0")/lib.sh"

client=$(dirname "$0")/node_client.js
modules=${BUILD-${TMPDIR-/tmp}}/node-serialport

knows_serialport() { node -e 'require("serialport")' 2>/dev/null; }

# Versions of node-serialport with a binary for this machine: nothing is compiled.
get_serialport() {
    command -v node >/dev/null && command -v npm >/dev/null || return
    knows_serialport && return
    export NODE_PATH=$modules/node_modules
    knows_serialport && return
    mkdir -p "$modules" && timeout 120 npm install --prefix "$modules" --no-audit --no-fund --ignore-scripts serialport@13 \
        >"$modules/npm.log" 2>&1 </dev/null && knows_serialport
}

if ! get_serialport; then
    echo "skipped: there is no node with serialport, and npm cannot install it${NODE_PATH:+ (see $modules/npm.log)}"
    exit 77
fi

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
