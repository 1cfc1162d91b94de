#!/bin/bash
# SPDX-License-Identifier: MIT
# What other users of the machine can do to an emulator, and what its programs are built with (docs/SECURITY.md).
# The cases with another user need root: they take the user `nobody` for him.

. "$(dirname "$0")/lib.sh"
: "${BUILD:=build/dev}"

# A folder that everybody may write to, as /tmp; $folder itself may be entered by all. Returns false, having said so, if we are
# not root.
everybodys_folder() {
    if [[ $(id -u) != 0 ]] || ! command -v setpriv >/dev/null; then
        echo "  skipped: needs root and setpriv, to be another user"
        return 1
    fi
    chmod 755 "$folder"
    shared=$folder/shared
    mkdir -m 1777 "$shared"
}

# as_other COMMAND...: as a user who is not us.
other=(setpriv --reuid=65534 --regid=65534 --clear-groups --)
as_other() {
    "${other[@]}" "$@"
}

# refused WHAT PART COMMAND...: exit status 1, and the message has the part.
refused() {
    local what=$1 part=$2
    shift 2
    exits 1 timeout "$limit" "$@"
    holds "$complained" "$part" "$what"
    same "" "$said" "$what: a READY line"
}

test_a_lock_file_of_another_user_is_not_taken() {
    everybodys_folder || return 0
    echo precious >"$folder/precious"
    ln -s "$folder/precious" "$shared/bus"
    as_other sh -c "echo 'rkm04 process 1, pty $folder/precious' >'$shared/bus.lock'; chmod 666 '$shared/bus.lock'"
    refused "the link" "$shared/bus.lock" "$RKM04" serve --link "$shared/bus"
    [[ -L $shared/bus ]] || fail "the other user's lock file made us remove a link"
    as_other touch "$shared/socket.lock"
    refused "the control socket" "$shared/socket.lock" "$RKM04" serve --link "$shared/mine" --control "$shared/socket"
    same 65534 "$(stat -c %u "$shared/socket.lock")" "owner of the lock file that was left alone"
}

test_links_in_place_of_our_files_are_not_followed() {
    local name
    echo precious >"$folder/precious"
    for name in bus.lock bus bus.control.lock bus.control; do
        ln -s "$folder/precious" "$folder/$name"
        exits 1 timeout "$limit" "$RKM04" serve --link "$folder/bus" --control "$folder/bus.control"
        holds "$complained" "$folder/bus" "the message about $name"
        same precious "$(<"$folder/precious")" "the file behind $name"
        [[ -L $folder/$name ]] || fail "$name is gone"
        rm "$folder/$name"
    done
}

test_a_lock_file_with_a_second_name_is_not_written_to() {
    : >"$folder/empty"
    ln "$folder/empty" "$folder/bus.lock"
    refused "the link" "not a lock file that you have made" "$RKM04" serve --link "$folder/bus"
    same 0 "$(stat -c %s "$folder/empty")" "size of the file"
}

test_a_pipe_in_place_of_a_lock_file_makes_nobody_wait() {
    mkfifo "$folder/bus.lock"
    refused "the link" "$folder/bus.lock" "$RKM04" serve --link "$folder/bus"
}

test_a_flash_image_is_not_made_after_a_dangling_link() {
    ln -s "$folder/elsewhere" "$folder/unit.flash"
    refused "the flash image" "$folder/unit.flash" "$RKM04" serve --link "$folder/bus" --flash "$folder/unit.flash"
    [[ ! -e $folder/elsewhere ]] || fail "it was made where the link leads"
}

test_a_snapshot_does_not_follow_the_link_of_another_user() {
    echo precious >"$folder/precious"
    ln -s "$folder/precious" "$folder/here.snapshot.new"
    serve bus --control "$folder/bus.control"
    exits 0 "$RKMCTL" -c "$folder/bus.control" snapshot file="$folder/here.snapshot"
    same precious "$(<"$folder/precious")" "the file behind the link"
    [[ -f $folder/here.snapshot && ! -L $folder/here.snapshot ]] || fail "there is no snapshot"
}

test_the_default_folder_of_another_user_is_not_used() {
    everybodys_folder || return 0
    as_other mkdir -m 777 "$shared/rkm04-0"
    refused "the folder" "$shared/rkm04-0" env -u XDG_RUNTIME_DIR TMPDIR="$shared" "$RKM04" serve
    same 65534 "$(stat -c %u "$shared/rkm04-0")" "owner of the folder that was left alone"
}

test_the_client_does_not_believe_the_emulator_of_another_user() {
    everybodys_folder || return 0
    as_other mkdir -m 777 "$shared/rkm04-0"
    start foreign "${other[@]}" "$RKM04" serve --link "$shared/rkm04-0/bus0" --control "$shared/rkm04-0/bus0.control"
    soon "the other user's emulator is ready" ready foreign
    exits 1 env -u XDG_RUNTIME_DIR -u RKM04_CONTROL TMPDIR="$shared" "$RKMCTL" state
    holds "$complained" "another user's emulator" "the message"
    exits 0 "$RKMCTL" -c "$shared/rkm04-0/bus0.control" state # who names it means it
}

test_another_user_cannot_connect_to_the_control_socket() {
    everybodys_folder || return 0
    serve bus --control "$shared/bus.control"
    same 600 "$(stat -c %a "$shared/bus.control")" "mode of the socket"
    exits 1 as_other "$RKMCTL" -c "$shared/bus.control" state
    holds "$complained" "another user" "the message"
    exits 0 "$RKMCTL" -c "$shared/bus.control" state
}

test_the_default_link_lies_in_a_folder_for_its_owner_alone() {
    start bus env -u XDG_RUNTIME_DIR TMPDIR="$folder" "$RKM04" serve
    soon "the unit is ready" ready bus
    same 700 "$(stat -c %a "$folder/rkm04-$(id -u)")" "mode of the folder"
}

test_no_privileges_are_needed() {
    everybodys_folder || return 0
    as_other mkdir "$shared/own"
    start bus "${other[@]}" "$RKM04" serve --link "$shared/own/bus" --tcp 0 --flash "$shared/own/unit.flash"
    soon "the unit is ready" ready bus
    same 0000000000000000 "$(sed -n 's/^CapEff:\t//p' "/proc/$started/status")" "capabilities of the emulator"
    exits 0 as_other "$RKMCTL" -p "$shared/own/bus" version
}

test_TCP_listens_to_this_machine_unless_asked() {
    local address
    start bus "$RKM04" serve --tcp 0 --rfc2217 0
    soon "the unit is ready" ready bus
    for address in $(grep -oE '[0-9.]+:[0-9]+"' "$folder/bus.out"); do
        [[ $address == 127.0.0.1:* ]] || fail "it listens at $address"
    done
    # The kernel's own view: state 0A is LISTEN; an address of all machines is 00000000.
    local sockets
    sockets=$(find "/proc/$started/fd" -lname 'socket:*' -printf '%l\n' | tr -dc '0-9\n' | paste -sd '|')
    cat /proc/net/tcp /proc/net/tcp6 | awk -v "ours=^($sockets)$" '$4 == "0A" && $10 ~ ours {print $2}' >"$folder/listening"
    same 2 "$(grep -c '^0100007F:' "$folder/listening")" "listeners at 127.0.0.1"
    same 2 "$(wc -l <"$folder/listening")" "listeners at all"
}

test_a_plant_without_end_or_with_more_after_its_text_is_refused() {
    refused "a plant without end" "longer than 1 MiB" "$RKM04" serve --link "$folder/bus" --plant /dev/zero
    printf 'motors: {}\n\0more' >"$folder/plant.yaml"
    refused "a plant with a 0 in it" "character 0" "$RKM04" serve --link "$folder/bus" --plant "$folder/plant.yaml"
}

test_a_pipe_in_place_of_a_trace_makes_nobody_wait() {
    local control=(--control "$folder/bus.control" --timeout 5000)
    mkfifo "$folder/pipe.vcd" "$folder/pipe.log"
    serve bus
    exits 1 "$RKMCTL" "${control[@]}" trace start "$folder/pipe.vcd"
    exits 1 "$RKMCTL" "${control[@]}" trace start "$folder/pipe.log"
    exits 0 ctl bus version
}

test_texts_from_outside_are_no_formats() {
    local text='%n%n%s%s%99999d'
    exits 2 "$RKM04" serve --clock "$text"
    holds "$complained" "$text" "an option"
    serve bus --version-text "$text" --control "$folder/bus.control"
    exits 0 ctl bus version
    same "$text" "$said" "the version text"
    exits 2 "$RKMCTL" -c "$folder/bus.control" call "di.set" "$text=1"
    exits 1 "$RKMCTL" -c "$folder/bus.control" restore "$text"
    holds "$complained" "$text" "the name of a snapshot"
    printf '%s\n' "$text: [$text" >"$folder/scenario.yaml"
    exits 2 "$RKM04" test "$folder/scenario.yaml"
    printf '%s\n' "{\"$text\":1}" >"$folder/text.record"
    "$RKM04" replay "$folder/text.record" >"$folder/replay.err" 2>&1
    (($? < 126)) || fail "a record with %n"
}

# The build's own options decide; a build with sanitizers, or without optimisation, is not hardened.
is_hardened() {
    grep -qE '^CMAKE_BUILD_TYPE:[A-Z]*=(Release|RelWithDebInfo|MinSizeRel)$' "$1/CMakeCache.txt" &&
        ! grep -qE '^RKM04_(SANITIZE:BOOL=ON|HARDEN:BOOL=OFF)$' "$1/CMakeCache.txt"
}

# is_guarded PROGRAM: functions begin with the mark for indirect jumps. The note of the program does not show it: it
# needs a C library that is built so, too.
is_guarded() {
    local mark
    case $(uname -m) in
        x86_64) mark=endbr64 ;;
        aarch64) mark='paciasp|bti' ;;
        *) return 0 ;;
    esac
    (($(objdump -d "$1" | grep -cE "$mark") > 20)) || fail "$1: hardly a function begins with $mark"
}

# hardened PROGRAM: readelf finds all of it.
hardened() {
    local head
    head=$(readelf --wide --file-header --program-headers --dynamic "$1") || fail "readelf $1"
    holds "$head" "DYN (" "$1: position independent"
    holds "$head" "GNU_RELRO" "$1: RELRO"
    holds "$head" "NOW" "$1: bound at the start, so that RELRO is full"
    [[ $head =~ GNU_STACK\ +0x0+\ 0x0+\ 0x0+\ 0x0+\ 0x0+\ RW\  ]] || fail "$1: the stack is executable"
    is_guarded "$1"
    head=$(readelf --wide --dyn-syms "$1")
    holds "$head" "__stack_chk_fail" "$1: stack protector"
    holds "$head" "__snprintf_chk" "$1: fortified library calls"
}

test_optimised_builds_are_hardened() {
    local source
    source=$(cd "$(dirname "$0")/../.." && pwd)
    if is_hardened "$BUILD"; then
        hardened "$RKM04"
        hardened "$RKMCTL"
        return
    fi
    # This build is not: the smaller program is built so, with the options of a release.
    cmake -S "$source" -B "$folder/build" -DCMAKE_BUILD_TYPE=Release -DRKM04_TESTS=OFF >"$folder/cmake.err" 2>&1 || fail "cmake"
    cmake --build "$folder/build" --target rkmctl >"$folder/make.err" 2>&1 || fail "the build"
    is_hardened "$folder/build" || fail "a release is not hardened by default"
    hardened "$folder/build/rkmctl"
}

run_cases "$@"
