#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for boards with an STM32F405 under QEMU, as netduinoplus2: an RKM04 on a serial port. QEMU logs what is written to
# the pins, since it has none.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/qemu/board.sh"

firmware stm32f405 "qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi" qemu-system-arm arm-none-eabi-gcc

# Power up; what is written to the pins goes to $folder/pins.
stm32() { board qemu-system-arm -M netduinoplus2 -d unimp,guest_errors -D "$folder/pins"; }

# written PORT VALUE: how often this was written to the register that sets pins by its lower half and clears by its upper.
written() { grep -c "GPIO$1: .*write .*offset 0x018, value 0x$2)" "$folder/pins"; }

pulses() { written A "$(printf '%08x' $((1 << ($1 - 1))))"; }

test_L1_the_board_answers_as_an_RKM04_does() {
    stm32
    same "01.02,06.03.2009" "$(unit version)" "the version"
    exits 1 unit set 'F100 Q'
    holds "$complained$said" "Q" "an unknown command"
    same "" "$(grep -v '^\(GPIO[ABC]\|RCC\): ' "$folder/pins")" "what QEMU found wrong with the firmware"
}

test_U4_the_address_is_set_when_the_firmware_is_built() {
    make -s -C "$tree/src/port/stm32f405" OUT="$folder/built" NODE=7 CRYSTAL=12 >"$folder/make.out" 2>&1 ||
        fail "the firmware is not built: $(<"$folder/make.out")"
    make -s -C "$tree/src/port/stm32f405" OUT="$folder/bad" CRYSTAL=40 >"$folder/make.out" 2>&1 && fail "a crystal of 40 MHz"
    holds "$(<"$folder/make.out")" "BOARD_CRYSTAL: expected 4 to 26 (MHz)" "the message"
    firmware=$folder/built
    answers() { "$RKMCTL" -n 7 --timeout 500 -p "$line" version >"$folder/version" 2>&1; }
    stm32
}

test_R8_every_step_is_a_pulse_at_the_motor_s_pin() {
    stm32
    exits 0 unit -m 1 set '\ S100 V1000 A2000 F700 R'
    exits 0 unit -m 3 set '\ S200 V2000 A4000 F50 R B400 R'
    soon "motor 1 has arrived" stands_at 1 700
    soon "motor 3 has arrived" stands_at 3 -350
    soon "the last pulse has left" eval '[[ $(pulses 1) == 700 && $(pulses 3) == 450 ]]'
    same 0 "$(pulses 2)" "pulses of motor 2"
    soon "the last pulse has ended" eval '[[ $(written A 00010000) == 700 ]]'
    ((700 == $(pulses 1) && 450 == $(pulses 3))) || fail "more pulses came: $(pulses 1), $(pulses 3)"
    same 1 "$(written A 00000040)" "changes of direction of motor 3 to forward"
    same 1 "$(written A 00400000)" "changes of its direction to back"
}

test_U2_commands_switch_the_outputs() {
    stm32
    exits 0 unit -m 2 set '\ T01 T08'
    soon "DO 01 and DO 08 are on" eval '[[ $(written B 7e008100) == 1 ]]'
    exits 0 unit -m 2 set 'C01'
    soon "DO 01 is off" eval '[[ $(written B 7f008000) == 1 ]]'
}

test_U6_the_LEDs_show_which_motors_move() {
    stm32
    exits 0 unit -m 4 set '\ S100 V100 F20 R'
    soon "the LED of motor 4 is on" eval '(($(written C 00001000) > 0))'
    soon "motor 4 has arrived" stands_at 4 20
    soon "its LED is off" eval 'grep "GPIOC: .*offset 0x018" "$folder/pins" | tail -1 | grep -q 10000000'
    same 0 "$(written B 00000010)" "how often the LED of motor 2 is on"
}

test_U5_a_stored_program_starts_when_the_board_is_reset() {
    stm32
    exits 0 unit -m 4 set '\ C100 F120 R'
    exits 0 unit -m 4 store
    soon "motor 4 has arrived" stands_at 4 120
    exits 0 unit -m 4 set '\ C100'
    soon "its counter is 0" stands_at 4 0
    monitor system_reset >"$folder/monitor.out"
    soon "the program has run again" eval '[[ $(pulses 4) == 240 ]]'
    soon "the unit answers again" answers
    stands_at 4 120 || fail "motor 4 stands at $(unit -m 4 position)"
    same "C100 F120 R" "$(unit -m 4 command)" "the program"
}

test_L4_a_full_memory_comes_whole_through_small_buffers() {
    stm32
    full_memory_comes_back
}

test_U7_the_driver_is_on_for_each_answer_and_off_again() {
    stm32
    unit -m 0 position >"$folder/positions"
    unit -m 1 command >"$folder/program"
    # it is on before the first byte of an answer; three were given, one of them to `answers'
    soon "the driver was on three times" eval '(($(written B 00000001) >= 3))'
    soon "the driver is off" driver_is_off
}

driver_is_off() { grep 'GPIOB: .*offset 0x018, value 0x0*1\(0000\)\?)' "$folder/pins" | tail -1 | grep -q 0x00010000; }

# While the flash is erased the chip cannot read it.
test_only_what_copies_the_firmware_lies_in_flash() {
    local symbols files=("$firmware"/firmware.{elf,bin,hex})
    symbols=$(arm-none-eabi-nm "${files[0]}" | grep -i ' [tdr] ' | grep -v '^2000' | sed 's/.* //' | sort | xargs)
    same "__main_veneer reset" "$symbols" "functions and data that are not in RAM"
    arm-none-eabi-objcopy -I ihex -O binary "${files[2]}" "$folder/hex.bin"
    cmp "${files[1]}" "$folder/hex.bin" >"$folder/cmp.err" 2>&1 || fail "firmware.bin and firmware.hex differ"
    local stack entry
    read -r stack entry < <(od -An -tx4 -N8 "${files[1]}")
    same "$(address stack_top) $(address reset)" "$stack $(printf '%08x' $((16#$entry - 1)))" "stack and entry of the image"
}

address() { arm-none-eabi-nm "$firmware/firmware.elf" | sed -n "s/ . $1\$//p"; }

run_cases "$@"
