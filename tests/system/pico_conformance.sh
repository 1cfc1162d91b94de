#!/bin/bash
# SPDX-License-Identifier: MIT
# The conformance kit against the firmware for the Raspberry Pi Pico in rp2040js, in the board's own time: cases that soon end.
# docs/TESTING.md has the command for all of them. A client with the board in real time.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/pico/board.sh"

# The emulator sets inputs, looks at outputs and switches the power when the kit asks for it; all pulses are compared afterwards.
test_the_conformance_kit_passes_and_every_pulse_comes_at_its_tick() {
    local board="node $tree/tests/system/pico/kit.mjs $firmware/firmware.elf"
    exits 0 timeout 500 "$tree/tools/conformance" --port "board:$board $build/tests/pico_replay" \
        --only M5.3 --only U2 --only U5 --only P6 --only P1
    holds "$said" "a_stored_program_starts_when_power_comes" "the report"
    holds "$said" "outputs_are_switched_by_T_and_C" "the report"
    [[ $said != *needs\ inputs* && $said != *needs\ power* ]] || fail "cases were left out: $said"
    [[ $complained =~ ([0-9]+)\ pulses\ and ]] && ((BASH_REMATCH[1] > 1000)) || fail "no pulses were compared: $complained"
}

test_a_client_talks_to_a_served_board() {
    mkfifo "$folder/hands"
    node "$tree/tests/system/pico/serve.mjs" "$firmware/firmware.elf" >"$folder/board.out" 2>"$folder/board.err" \
        <"$folder/hands" &
    processes+=("$!")
    exec 9>"$folder/hands"
    soon "the board is served" grep -q '^READY ' "$folder/board.out"
    local port
    port=$(sed -n 's/^READY //p' "$folder/board.out")
    same "01.02,06.03.2009" "$("$RKMCTL" --timeout 20000 -p "tcp:$port" version)" "the version"
    exits 0 "$RKMCTL" --timeout 20000 -p "tcp:$port" set '\ O03 T02'
    echo 'input 3 1' >&9
    soon "output 2 is on" output_is 2
    exec 9>&-
}

output_is() {
    echo outputs >&9
    [[ $(tail -n 1 "$folder/board.out") == "$1" ]]
}

run_cases "$@"
