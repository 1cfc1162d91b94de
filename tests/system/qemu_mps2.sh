#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for Arm's MPS2 board under QEMU: an RKM04 on a serial port. QEMU puts the board's UART on a pty and logs what is
# written to the pins, since it has nothing there.

. "$(dirname "$0")/lib.sh"

. "$(dirname "$0")/qemu/board.sh"

firmware mps2_an385 "qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi" qemu-system-arm arm-none-eabi-gcc

# Power up; what is written to the pins goes to $folder/pins.
mps2() { board qemu-system-arm -M mps2-an385 -d unimp,guest_errors -D "$folder/pins"; }

# written OFFSET VALUE: how often this was written to a GPIO; its registers from 400 and 800 on name the pins in the offset.
written() { grep -c "write .*offset 0x$1, value 0x0*$2)" "$folder/pins"; }

pulses() { written "$(printf '%x' $((0x400 + (4 << ($1 - 1)))))" "$((1 << ($1 - 1)))"; }

test_L1_the_board_answers_as_an_RKM04_does() {
    mps2
    same "01.02,06.03.2009" "$(unit version)" "the version"
    exits 1 unit set 'F100 Q'
    holds "$complained$said" "Q" "an unknown command"
    same "" "$(grep -v 'cmsdk-ahb-gpio' "$folder/pins")" "what QEMU found wrong with the firmware"
}

test_readings_are_set_when_the_firmware_is_built() {
    make -s -C "$tree/src/port/mps2_an385" OUT="$folder/built" READINGS='.negative_position = RKM04_NEGATIVE_POSITION_NO' \
        >"$folder/make.out" 2>&1 || fail "the firmware is not built: $(<"$folder/make.out")"
    firmware=$folder/built
    mps2
    exits 1 unit set '=-5'
    exits 0 unit set '=5'
}

test_R8_every_step_is_a_pulse_at_the_motor_s_pin() {
    mps2
    exits 0 unit -m 1 set '\ S100 V1000 A2000 F700 R'
    exits 0 unit -m 3 set '\ S200 V2000 A4000 F50 R B400 R'
    soon "motor 1 has arrived" stands_at 1 700
    soon "motor 3 has arrived" stands_at 3 -350
    soon "the last pulse has left" eval '[[ $(pulses 1) == 700 && $(pulses 3) == 450 ]]'
    same 0 "$(pulses 2)" "pulses of motor 2"
    soon "the last pulse has ended" eval '[[ $(written 404 0) == 700 ]]'
    ((700 == $(pulses 1) && 450 == $(pulses 3))) || fail "more pulses came: $(pulses 1), $(pulses 3)"
    same 1 "$(written 500 40)" "changes of direction of motor 3 to forward"
    same 1 "$(written 500 0)" "changes of its direction to back"
}

test_U2_commands_switch_the_outputs() {
    mps2
    exits 0 unit -m 2 set '\ T01 T08'
    soon "DO 01 and DO 08 are on" eval '[[ $(written 7fc 81) == 1 ]]'
    exits 0 unit -m 2 set 'C01'
    soon "DO 01 is off" eval '[[ $(written 7fc 80) == 1 ]]'
}

test_U5_a_stored_program_starts_when_the_board_is_reset() {
    mps2
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
    mps2
    full_memory_comes_back
}

test_U7_the_driver_is_on_for_each_answer_and_off_again() {
    mps2
    soon "the driver is off" eval '(($(written 804 0) > 1))'
    local on
    on=$(written 804 100)
    unit -m 0 position >"$folder/positions"
    unit -m 1 command >"$folder/program"
    soon "two more answers, then off" driver_rests $((on + 2))
}

driver_rests() {
    (($(written 804 100) >= $1)) && grep 'offset 0x804' "$folder/pins" | tail -1 | grep -q 'value 0x00000000'
}

run_cases "$@"
