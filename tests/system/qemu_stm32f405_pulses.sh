#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for boards with an STM32F405 under QEMU, in time of its own: all pulses against the core's, the power cut while a
# program is stored, and cases of the conformance kit that soon end and do not ask how far a motion is: QEMU runs on until it is
# stopped.
# docs/CONFORMANCE.md has the command for all of them.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/qemu/board.sh"

here=$tree/tests/system/qemu
build=${BUILD:-/tmp}
firmware stm32f405 "qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi" qemu-system-arm arm-none-eabi-gcc python3
elf=$build/firmware_stm32f405_traced/firmware.elf
make_in "${elf%/*}" make -s -C "$tree/src/port/stm32f405" OUT="${elf%/*}" TRACE="$here/trace.c" >/dev/null || exit 1

# drive TASK ARGUMENTS...: what it reports is in $said.
drive() { exits 0 timeout 500 python3 "$here/drive.py" "$1" "$elf" "${@:2}"; }

test_R8_every_pulse_of_the_manual_s_programs_comes_within_two_us_of_its_tick() {
    drive manual "$build/tests/pico_replay" "$tree"/examples/manual/*.yaml
    holds "$said" "step: " "the report"
}

test_U5_P6_the_old_program_or_the_new_one_is_there_after_a_power_cut_at_every_step() {
    drive store
    holds "$said" "power cut at " "the report"
}

test_the_conformance_kit_passes_and_every_pulse_comes_at_its_tick() {
    exits 0 timeout 500 "$tree/tools/conformance" --latency 60000 \
        --port "board:python3 $here/board.py $elf $build/tests/pico_replay" \
        --only U2 --only U5 --only P6 --only P1 --only M5.3.5 --only M7.22 --only M9.1
    holds "$said" "a_stored_program_starts_when_power_comes" "the report"
    [[ $said != *needs\ inputs* && $said != *needs\ power* ]] || fail "cases were left out: $said"
    [[ $complained =~ step:\ ([0-9]+), ]] && ((BASH_REMATCH[1] > 1000)) || fail "no pulses were compared: $complained"
}

run_cases "$@"
