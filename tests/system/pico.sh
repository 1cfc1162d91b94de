#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for the Raspberry Pi Pico in rp2040js, in virtual time. What the emulator is made to do on top of rp2040js:
# tests/system/pico/{board,parts}.mjs.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/pico/board.sh"

# drive TASK ARGUMENTS...: what it reports is in $said.
drive() {
    exits 0 timeout 500 node "$tree/tests/system/pico/drive.mjs" "$1" "$firmware/firmware.elf" "${@:2}"
}

# figure NAME: of the report.
figure() { sed -n "s/^$1 //p" <<<"$said"; }

test_L1_U4_the_unit_answers_at_the_address_that_S1_sets() { drive answers; }

test_U7_the_driver_is_on_for_an_answer_and_off_within_a_quarter_of_a_millisecond() { drive driver; }

test_L4_a_request_longer_than_all_queues_comes_whole() { drive longRequest; }

test_U5_a_stored_program_starts_after_a_reset_and_survives_a_power_cut_at_every_step() { drive store; }

test_R8_every_pulse_of_the_manual_s_programs_comes_at_its_tick() {
    drive manual "$build/tests/pico_replay" "$tree"/examples/manual/*.yaml
    holds "$said" pulses "the report"
}

test_R7_four_motors_at_full_speed_are_never_late() {
    drive load 4
    (($(figure worst_interrupt_cycles) < 12500)) || fail "the interrupt takes $(figure worst_interrupt_cycles) cycles"
    (($(figure free_cpu_per_mille) > 600)) || fail "the processor is free for $(figure free_cpu_per_mille) per mille"
}

test_a_firmware_is_sealed_and_written_as_uf2() {
    local image=$tree/tools/pico-image
    exits 0 python3 - "$firmware" <<'END'
import struct, sys
uf2 = open(sys.argv[1] + "/firmware.uf2", "rb").read()
elf = open(sys.argv[1] + "/firmware.elf", "rb").read()
blocks = [uf2[at:at + 512] for at in range(0, len(uf2), 512)]
assert blocks and len(uf2) % 512 == 0
data = b""
for number, block in enumerate(blocks):
    magic, magic2, flags, address, length, at, count, family = struct.unpack_from("<8I", block)
    assert (magic, magic2, flags, length) == (0x0A324655, 0x9E5D5157, 0x2000, 256)
    assert (at, count, family) == (number, len(blocks), 0xE48BFF56) and block[508:] == b"\x30\x6f\xb1\x0a"
    assert address == 0x10000000 + 256 * number
    data += block[32:288]
begin, size, count = struct.unpack_from("<I", elf, 28)[0], *struct.unpack_from("<HH", elf, 42)
for number in range(count):
    kind, offset, _, address, length = struct.unpack_from("<5I", elf, begin + number * size)
    if kind == 1:
        assert data[address - 0x10000000:][:length] == elf[offset:offset + length]
END
    head -c 4000 "$firmware/firmware.elf" >"$folder/short.elf"
    exits 1 "$image" --seal "$folder/short.elf"
    holds "$complained" "incomplete" "the message"
    exits 1 "$image" --uf2 "$folder/out.uf2" /bin/sh
    holds "$complained" "not an ELF file for a 32-bit Arm processor" "the message"
    exits 2 "$image" --uf2 "$folder/out.uf2"
    cp "$firmware/firmware.elf" "$folder/changed.elf"
    printf '\1' | dd of="$folder/changed.elf" bs=1 seek=$((0xf10)) conv=notrunc 2>"$folder/dd.err"
    exits 1 "$image" --uf2 "$folder/out.uf2" "$folder/changed.elf"
    holds "$complained" "CRC" "the message"
    [[ ! -e $folder/out.uf2 ]] || fail "a file was written"
}

run_cases "$@"
