#!/bin/bash
# SPDX-License-Identifier: MIT
# The firmware for Arm's MPS2 board that is a PMC, under QEMU: both faces, and its pulses against those of the emulator.

. "$(dirname "$0")/lib.sh"

. "$(dirname "$0")/qemu/board.sh"

for tool in qemu-system-arm arm-none-eabi-gcc make; do
    command -v "$tool" >/dev/null || skip_all "$tool not found: apt-get install qemu-system-arm gcc-arm-none-eabi make"
done

# power_up NAME OPTIONS...: a board with the firmware built with these options; what is written to the pins goes to $folder/pins.
# Its time is that of its instructions, so that what it does does not depend on the load of this machine. At 600 baud the bytes
# of a frame may come with gaps of 25 ms between them.
power_up() {
    firmware=${BUILD:-/tmp}/firmware_$1
    make_in "$firmware" make -s -C "$tree/src/port/mps2_an385" OUT="$firmware" "${@:2}" >"$folder/make.out" 2>&1 ||
        fail "the firmware is not built: $(<"$folder/make.out")"
    board qemu-system-arm -M mps2-an385 -icount shift=5 -d unimp,guest_errors -D "$folder/pins"
}

answers() { "$RKMCTL" --timeout 1000 -p "$line" "${face[@]}" pmc position >"$folder/answer" 2>&1; }

pmc() { "$RKMCTL" --timeout 20000 -p "$line" "${face[@]}" pmc "$@"; }

stands_at() { [[ $(pmc position) == "x: $1"$'\n'"y: $2" ]]; }

# `tell LINE`: a line of text that has no answer. ask LINE ANSWER: one that has.
tell() { stty -F "$line" raw -echo; printf '%s\r' "$1" >&9; }

ask() {
    tell "$1"
    same "$2" "$(heard)" "$1"
}

# `heard`: an answer.
heard() {
    local byte='' text=''
    until [[ $byte == $'\r.' || $byte == . ]]; do # the end of the answer, or no byte
        text+=${byte%.}
        byte=$(timeout --foreground "$limit" head -c 1 <&9; echo .)
    done
    printf %s "${text%$'\n'}"
}

# pins: what was written to the pins of X, Y and the outputs, as the emulator's trace has it, a line each: those of X, those of Y,
# the outputs, each in the order of time.
pins() {
    sed -n 's/^cmsdk-ahb-gpio: .*write .*offset 0x\([0-9a-f]*\), value 0x0*\([0-9a-f]*\))$/\1 \2/p' "$folder/pins" | awk '
        $1 == "404" && $2 == "1" { print "m1 step" }
        $1 == "408" && $2 == "2" { print "m2 step" }
        $1 == "440" { print "m1 dir " ($2 == "" ? -1 : 1) }
        $1 == "480" { print "m2 dir " ($2 == "" ? -1 : 1) }
        $1 == "7fc" && n++ > 1 { print "do " ($2 == "" ? 0 : $2) }' | # the first two are the start of the board
        sort -s -k 1,1
}

# traced FILE: the same of the emulator with this program.
traced() {
    "$RKM04" exec --device pmc-2hs --trace - "$1" 2>"$folder/exec.err" | awk -F, '
        $3 == "step" { print $2 " step" }
        $3 == "dir" { print $2 " dir " $4 }
        $3 == "do" { print "do " $4 }' | sort -s -k 1,1
}

pulses() { pins | grep -c "^m$1 step"; }

pulses_are() { [[ $(pulses 1) == "$1" && $(pulses 2) == "$2" ]]; }

pins_are_as_traced() {
    pins >"$folder/pins.seen"
    cmp "$folder/pins.traced" "$folder/pins.seen" >"$folder/cmp.err" 2>&1
}

test_the_board_speaks_lines_of_text() {
    face=()
    power_up pmc DEVICE=pmc
    ask VER "VER PMC-2HS 1.00"
    tell "SPD 2000,100"
    ask SPD "SPD 2000,100"
    tell "PIC 300,-20"
    soon "both axes have arrived" stands_at 300 -20
    soon "the last pulse has left" pulses_are 300 20
    tell "SPD 60"
    tell "JOG -X"
    soon "X moves" eval '(($(pulses 1) > 320))'
    ask "INR X" "INR X 1"
    tell "STO X"
    soon "X has stopped" eval '[[ $(pmc position) == "$(pmc position)" ]]'
    ask "ERD X" "ERD 00"
    same "" "$(grep -v 'cmsdk-ahb-gpio' "$folder/pins")" "what QEMU found wrong with the firmware"
}

test_a_firmware_has_one_axis_and_another_speed_from_a_reset_on() {
    face=()
    power_up pmc-1hs DEVICE=pmc-1hs
    ask VER "VER PMC-1HS 1.00"
    ask SCI "SCI 9600"
    tell "SCI 115200"
    ask SCI "SCI 9600"
    tell RST
    soon "the line has the new speed" eval 'tell SCI; [[ $(heard) == "SCI 115200" ]]'
    ask POS "POS 00000000"
}

test_the_board_makes_the_pulses_of_the_emulator() {
    face=(--face modbus)
    cat >"$folder/a.pmc" <<'END'
X: 00 OUT OUT0 ON
X: 01 INC 300 V3 5
X: 02 INC -12 V2
X: 03 OUT OUT0 OFF
X: 04 END
Y: 00 TIM 2
Y: 01 INC -200 V3
Y: 02 OTP OUT1 3 WAIT
Y: 03 INC 70 V4
Y: 04 END
END
    power_up pmc_modbus DEVICE=pmc FACE=modbus BAUD=600
    exits 0 pmc program put "$folder/a.pmc"
    exits 0 pmc store
    exits 0 pmc run xy
    traced "$folder/a.pmc" >"$folder/pins.traced"
    soon "both programs have ended" stands_at 288 -130
    soon "every pulse and every change of direction and of outputs has come" pins_are_as_traced
    monitor system_reset >"$folder/monitor.out"
    soon "the unit answers again" answers
    stands_at 0 0 || fail "the counters after a reset: $(pmc position)"
    exits 0 pmc program get
    same "$(<"$folder/a.pmc")" "$said" "the program after a reset"
}

# Two axes at 80 000 pulses/s are faster than this board: its time gets slower, and no pulse is dropped.
test_pulses_that_are_too_fast_come_later() {
    face=()
    power_up pmc DEVICE=pmc
    tell "SPD 8000,8000"
    tell "PIC 8000,-8000"
    soon "both axes have arrived" stands_at 8000 -8000
    soon "the last pulse has left" pulses_are 8000 8000
}

run_cases "$@"
