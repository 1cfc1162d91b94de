#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for Arm's MPS2 board that is a CIB module, under QEMU, with a Modbus master (pymodbus).

. "$(dirname "$0")/lib.sh"

. "$(dirname "$0")/qemu/board.sh"
here=$(cd "$(dirname "$0")" && pwd)

for python in python3 /usr/bin/python3 none; do
    "$python" -c 'import pymodbus, serial' 2>/dev/null && break
done
[[ $python != none ]] || skip_all "there is no pymodbus; apt-get install python3-pymodbus"
for tool in qemu-system-arm arm-none-eabi-gcc; do
    command -v "$tool" >/dev/null || skip_all "$tool not found: apt-get install qemu-system-arm gcc-arm-none-eabi"
done
firmware=${BUILD:-/tmp}/firmware_cib
make_in "$firmware" make -s -C "$tree/src/port/mps2_an385" DEVICE=cib SILENCE=100000 OUT="$firmware" >/dev/null || exit 1

client() { timeout 200 "$python" -W ignore "$here/cib_client.py" "$1" "$line"; }

answers() { client type >"$folder/answer" 2>&1; }

# What is written to the pins goes to $folder/pins.
power_up() { board qemu-system-arm -M mps2-an385 -d unimp,guest_errors -D "$folder/pins"; }

# patterns: the levels of DO1-DO8 one after the other, as they were written.
patterns() {
    sed -n 's/.*write .*offset 0x7fc, value 0x0*\([0-9a-f]*\))/\1/p' "$folder/pins" | tr '\n' ' '
}

test_the_board_moves_a_drive_by_40_rows_of_its_table() {
    local rows='' i
    power_up
    client motion >"$folder/motion" 2>&1 || fail "$(<"$folder/motion")"
    for ((i = 0; i < 10; i++)); do rows+='3 6 c 9 '; done
    soon "the last pulse has left" eval '[[ $(patterns) == *"$rows" ]]'
}

test_the_board_has_every_register() {
    power_up
    client registers_of_1 >"$folder/registers" 2>&1 || fail "$(<"$folder/registers")"
}

run_cases "$@"
