#!/bin/bash
# SPDX-License-Identifier: MIT
# What flash keeps: a stored program is there after a restart and starts by itself (U5, P6).

. "$(dirname "$0")/lib.sh"

# restart SIGNAL: end the unit and start it anew on the same image.
restart() {
    kill "-$1" "$started"
    soon "the unit has ended" ended "$started"
    serve bus --clock max --flash "$folder/flash"
}

stored_program_survives() {
    serve bus --clock max --flash "$folder/flash"
    exits 0 ctl bus -m 2 set '\ C100 W100 F3000 R'
    exits 0 ctl bus -m 2 store
    soon "motor 2 has arrived" position_is bus 2 3000
    exits 0 ctl bus -m 2 set 'B1000 R'
    soon "motor 2 is back at 2000" position_is bus 2 2000
    restart "$1"
    soon "the stored program has run by itself" position_is bus 2 3000
    exits 0 ctl bus -m 2 command
    holds "$said" 'C100 W100 F3000 R' "the program loaded"
    [[ $said != *B1000* ]] || fail "a command that was never stored came back: $said"
}

test_U5_a_stored_program_starts_by_itself_after_a_restart() { stored_program_survives TERM; }
test_U5_a_stored_program_survives_a_killed_unit() { stored_program_survives KILL; }

test_P6_storing_an_empty_program_empties_the_slot() {
    serve bus --clock max --flash "$folder/flash"
    exits 0 ctl bus -m 1 set '\ C100 F700 R'
    exits 0 ctl bus -m 1 store
    exits 0 ctl bus -m 1 set '\'
    exits 0 ctl bus -m 1 store
    restart TERM
    exits 0 ctl bus -m 1 command
    [[ $said != *F700* ]] || fail "the emptied slot held: $said"
}

test_P6_motor_0_stores_all_four() {
    local motor
    serve bus --clock max --flash "$folder/flash"
    exits 0 ctl bus -m 0 set '\ C100 F250 R'
    exits 0 ctl bus -m 0 store
    restart TERM
    for motor in 1 2 3 4; do
        soon "motor $motor has run its program" position_is bus "$motor" 250
    done
}

test_without_an_image_the_unit_says_that_flash_is_not_kept() {
    serve bus
    grep -qi flash "$folder/bus.err" || fail "no word about flash in the start message: $(<"$folder/bus.err")"
}

test_an_image_that_cannot_be_trusted_is_reported_and_not_obeyed() {
    head -c 32768 /dev/urandom >"$folder/flash"
    serve bus --flash "$folder/flash"
    grep -qi -e flash -e slot "$folder/bus.err" || fail "nothing said about the image: $(<"$folder/bus.err")"
    exits 0 ctl bus -m 1 command
    soon "the program memory is empty" position_is bus 1 0
}

test_an_image_that_cannot_be_opened_is_an_error() {
    exits 1 "$RKM04" serve --link "$folder/bus" --flash "$folder/no/such/flash"
    holds "$complained" "$folder/no/such/flash" "the message names the image"
    [[ ! -L $folder/bus ]] || fail "a link was left behind"
}

run_cases "$@"
