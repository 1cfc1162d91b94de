#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for QEMU's RISC-V machine: the template of a port with its places filled in. The machine has no pins; `pins' of the
# firmware stands for them, and QEMU's monitor shows it.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/qemu/board.sh"

firmware riscv_virt "qemu-system-misc gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf" \
    qemu-system-riscv32 riscv64-unknown-elf-gcc
pins=$((16#$(riscv64-unknown-elf-nm "$firmware/firmware.elf" | awk '$3 == "pins" { print $1 }')))

virt() { board qemu-system-riscv32 -M virt -bios none -d guest_errors,unimp -D "$folder/errors"; }

# pin NUMBER: the word of `struct pins' with this number, in decimal.
pin() { monitor "xp /1dw $((pins + 4 * $1))" | tr -d '\r' | sed -n 's/^[0-9a-f]*: *\(-\{0,1\}[0-9]*\).*/\1/p'; }

pin_is() { [[ $(pin "$1") == "$2" ]]; }

test_L1_the_board_answers_as_an_RKM04_does() {
    virt
    same "01.02,06.03.2009" "$(unit version)" "the version"
    exits 1 unit set 'F100 Q'
    same "" "$(<"$folder/errors")" "what QEMU found wrong with the firmware"
}

test_R8_every_step_is_a_pulse_and_the_pins_follow() {
    virt
    exits 0 unit -m 1 set '\ S100 V1000 A2000 F300 R T03'
    exits 0 unit -m 3 set '\ S200 V2000 A4000 F50 R B200 R'
    soon "motor 1 has arrived" stands_at 1 300
    soon "motor 3 has arrived" stands_at 3 -150
    same 300 "$(pin 4)" "pulses of motor 1"
    same 250 "$(pin 6)" "pulses of motor 3"
    same 0 "$(pin 5)" "pulses of motor 2"
    same 1 "$(pin 1)" "directions: 1 forward, 3 back"
    soon "DO 03 is on, the LEDs are off" eval 'pin_is 2 4 && pin_is 3 0'
}

test_U5_a_stored_program_starts_when_the_board_is_reset() {
    virt
    exits 0 unit -m 4 set '\ C100 F120 R'
    exits 0 unit -m 4 store
    soon "motor 4 has arrived" stands_at 4 120
    exits 0 unit -m 4 set '\ C100'
    monitor system_reset >"$folder/monitor.out"
    soon "the program has run again" pin_is 7 120
    soon "the unit answers again" answers
    same "C100 F120 R" "$(unit -m 4 command)" "the program"
}

test_L4_a_full_memory_comes_whole_through_small_buffers() {
    virt
    full_memory_comes_back
}

run_cases "$@"
