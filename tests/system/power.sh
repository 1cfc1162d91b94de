#!/bin/bash
# SPDX-License-Identifier: MIT
# The emulator is killed in each of its writes to the flash image, or the disk is full: a slot holds its old or its new program
# (U5, P6). power_shim.c kills. RKM04_TEST_LONG=1 kills at every call in three ways, also while a full memory is stored.

. "$(dirname "$0")/lib.sh"
: "${CC:=cc}"
long=${RKM04_TEST_LONG-}

old='W1 W2 W3 W4'
new='W5 W6'

# image MOTOR PROGRAM NAME: an image with OLD in every slot becomes $folder/base; what a motor says then and with PROGRAM in
# memory goes to $said_old and $said_new.
image() {
    $CC -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -shared -fPIC -o "$folder/shim.so" "$(dirname "$0")/power_shim.c" -ldl ||
        fail "the shim cannot be compiled"
    serve bus --clock max --flash "$folder/base"
    exits 0 ctl bus -m 0 set "\\ $old"
    exits 0 ctl bus -m 0 store
    said_old=$(ctl bus -m 1 command)
    exits 0 ctl bus -m 1 set "\\ $1"
    said_new=$(ctl bus -m 1 command)
    kill "$started"
    soon "the unit has ended" ended "$started"
}

# under_shim AT DONE: the unit on a copy of the base image, killed in call AT.
under_shim() {
    cp "$folder/base" "$folder/flash"
    : >"$folder/calls"
    SHIM_LOG=$folder/calls SHIM_KILL_AT=$1 SHIM_DONE=$2 LD_PRELOAD=$folder/shim.so ASAN_OPTIONS=verify_asan_link_order=0 \
        start bus "$RKM04" serve --link "$folder/bus" --clock max --flash "$folder/flash"
    soon "unit bus is ready" ready bus
}

# store MOTOR PROGRAM: ask for it; the unit may be killed meanwhile.
store() {
    exits 0 ctl bus -m "$1" set "\\ $2"
    ctl bus -m "$1" store >"$folder/store.out" 2>"$folder/store.err"
}

# calls_of MOTOR PROGRAM: number of calls that the start and the store take, in $first (of the store) and $last.
calls_of() {
    under_shim 0 0
    first=$(($(wc -l <"$folder/calls") + 1))
    store "$1" "$2" || fail "the store failed without a cut: $(<"$folder/store.err")"
    last=$(wc -l <"$folder/calls")
    ((last > first + 4)) || fail "calls $first to $last of the store: the shim does not see them"
    kill "$started"
    soon "the unit has ended" ended "$started"
}

# what_is_there MOTOR WHAT: the slot holds the old or the new program: $found.
what_is_there() {
    local said wanted
    said=$(ctl bus -m "$1" command)
    said=${said/motor $1:/motor 1:}
    case $said in
    "$said_old") found=old ;;
    "$said_new") found=new ;;
    *) fail "$2: motor $1 has '$said', neither '$said_old' nor '$said_new'" ;;
    esac
}

# cut MOTOR PROGRAM AT DONE: kill in that call, restart, look at the slots.
cut() {
    local motor what="killed in call $3 after $4 %" before=new
    under_shim "$3" "$4"
    store "$1" "$2" && fail "$what: the store was answered with success"
    soon "$what: the unit has ended" ended "$started"
    [[ ! -s $folder/bus.err ]] || ! grep -q Sanitizer "$folder/bus.err" || fail "$what: the unit has a fault"
    serve bus --clock max --flash "$folder/flash"
    for motor in $([[ $1 == 0 ]] && echo 1 2 3 4 || echo "$1"); do
        what_is_there "$motor" "$what"
        [[ $found == old || $before == new ]] || fail "$what: motor $motor is new, the one before it old"
        before=$found
    done
    kill "$started"
    soon "the unit has ended" ended "$started"
    cuts=$((cuts + 1))
}

# cuts MOTOR PROGRAM STEP: at every STEP-th call of the store.
cuts() {
    local at done cuts=0 first last
    image "$2"
    calls_of "$1" "$2"
    cut "$1" "$2" "$first" 0
    for ((at = first; at <= last; at += long ? 1 : $3)); do
        for done in 50 ${long:+0 100}; do
            cut "$1" "$2" "$at" "$done"
        done
    done
    echo "  killed $cuts times"
}

test_P6_a_unit_killed_in_any_write_of_a_store_has_the_old_or_the_new_program() { cuts 3 "$new" 1; }
test_P6_a_unit_killed_while_it_stores_all_motors_has_old_or_new_programs() { cuts 0 "$new" 9; }
test_P6_a_unit_killed_while_it_stores_a_full_memory_has_the_old_or_the_new_program() {
    cuts 2 "$(printf 'W%d ' {1..700})" 40
}

test_U5_a_unit_killed_while_it_makes_its_image_can_be_started_again() {
    $CC -std=c11 -D_GNU_SOURCE -shared -fPIC -o "$folder/shim.so" "$(dirname "$0")/power_shim.c" -ldl || fail "no shim"
    SHIM_KILL_AT=1 SHIM_DONE=40 LD_PRELOAD=$folder/shim.so ASAN_OPTIONS=verify_asan_link_order=0 \
        start bus "$RKM04" serve --link "$folder/bus" --flash "$folder/flash"
    soon "the unit has ended" ended "$started"
    same 13107 "$(stat -c %s "$folder/flash")" "bytes of the image"
    serve bus --flash "$folder/flash"
    same 32768 "$(stat -c %s "$folder/flash")" "bytes of the image"
    exits 0 ctl bus -m 1 store
}

# The process may write the first 16 KiB of a file only: the blocks of motors 1 and 2.
test_P6_a_write_that_the_system_refuses_is_an_error_and_the_old_program_stays() {
    image "$new"
    cp "$folder/base" "$folder/flash"
    start bus bash -c 'trap "" XFSZ; ulimit -f 16; exec "$@"' limited "$RKM04" serve --link "$folder/bus" --clock max \
        --flash "$folder/flash"
    soon "unit bus is ready" ready bus
    exits 0 ctl bus -m 0 set "\\ $new"
    exits 1 ctl bus -m 0 store
    holds "$(<"$folder/bus.err")" "cannot write the flash image" "the log"
    kill "$started"
    soon "the unit has ended" ended "$started"
    serve bus --clock max --flash "$folder/flash"
    slots "new new old old" "after the restart"
}

# slots WANTED WHAT: what the four slots hold.
slots() {
    local motor all=
    for motor in 1 2 3 4; do
        what_is_there "$motor" "$2"
        all+="$found "
    done
    same "$1 " "$all" "$2"
}

# on_small_disk KIB COMMAND: the unit sees a disk of that size at $folder/disk; COMMAND fills it first.
on_small_disk() {
    mkdir -p "$folder/disk"
    start bus unshare --user --map-root-user --mount bash -c "mount -t tmpfs -o size=$1k none '$folder/disk' && $2"'; exec "$@"' \
        small "$RKM04" serve --link "$folder/bus" --clock max --flash "$folder/disk/flash"
}

have_small_disk() {
    unshare --user --map-root-user --mount mount -t tmpfs -o size=8k none "$folder" 2>/dev/null && return
    echo "  (not here: no file system may be mounted)"
    return 1
}

test_U5_an_image_that_does_not_fit_the_disk_is_an_error() {
    have_small_disk || return 0
    on_small_disk 16 true
    status_of "$started"
    same 1 "$status" "the exit status"
    holds "$(<"$folder/bus.err")" "the disk is full" "the message"
}

# Only the blocks with the old programs are there, the others are holes: room for them is wanted when they are written.
test_P6_on_a_full_disk_a_store_is_refused_and_works_when_there_is_room() {
    have_small_disk || return 0
    local disk block fill="truncate -s 32768 '$folder/disk/flash'"
    image "$new"
    for block in 0 2 4 6; do
        fill+=" && dd if='$folder/base' of='$folder/disk/flash' bs=4096 count=1 skip=$block seek=$block conv=notrunc status=none"
    done
    on_small_disk 20 "$fill && head -c 4096 /dev/zero >'$folder/disk/ballast'"
    soon "unit bus is ready" ready bus
    disk=/proc/$started/root$folder/disk
    exits 0 ctl bus -m 0 set "\\ $new"
    exits 1 ctl bus -m 0 store
    holds "$(<"$folder/bus.err")" "No space left" "the log"
    cp "$disk/flash" "$folder/flash"
    rm "$disk/ballast"
    exits 0 ctl bus -m 3 store
    exits 1 ctl bus -m 4 store
    cp "$disk/flash" "$folder/later"
    kill "$started"
    soon "the unit has ended" ended "$started"
    serve bus --clock max --flash "$folder/flash"
    slots "old old old old" "while the disk was full"
    kill "$started"
    soon "the unit has ended" ended "$started"
    serve bus --clock max --flash "$folder/later"
    slots "old old new old" "after one store"
}

run_cases "$@"
