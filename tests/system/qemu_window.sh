#!/bin/bash
# SPDX-License-Identifier: MIT
# The window's service view with a unit that is no emulator of ours: the firmware for Arm's MPS2 board under QEMU, on a pty.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/qemu/board.sh"
. "$(dirname "$0")/window/browser.sh"

firmware mps2_an385 "qemu-system-arm gcc-arm-none-eabi libnewlib-arm-none-eabi" qemu-system-arm arm-none-eabi-gcc

test_the_service_view_works_with_the_board() {
    board qemu-system-arm -M mps2-an385
    open_window
    WINDOW_PORT=$line browse service
}

run_cases "$@"
