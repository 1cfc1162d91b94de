#!/bin/bash
# SPDX-License-Identifier: MIT
# The link and the flash image belong to one unit: a stale link of a killed unit is replaced, anything else is refused.

. "$(dirname "$0")/lib.sh"

version="01.02,06.03.2009"

test_a_killed_unit_leaves_a_stale_link_that_the_next_one_replaces() {
    serve bus
    kill -9 "$started"
    soon "the unit is dead" ended "$started"
    [[ -L $folder/bus ]] || fail "a killed unit cannot have removed its link"
    serve bus
    exits 0 ctl bus version
    holds "$said" "$version" "the next unit"
    kill "$started"
    status_of "$started"
    [[ ! -L $folder/bus ]] || fail "the link is still there"
}

test_a_second_unit_on_the_same_link_is_refused() {
    serve bus
    exits 1 "$RKM04" serve --link "$folder/bus"
    holds "$complained" "$folder/bus" "the message names the link"
    same "" "$said" "a READY line of the second unit"
    exits 0 ctl bus version
    holds "$said" "$version" "the first unit goes on"
}

test_a_file_in_the_place_of_the_link_is_left_alone() {
    echo precious >"$folder/bus"
    exits 1 "$RKM04" serve --link "$folder/bus"
    holds "$complained" "$folder/bus" "the message names the file"
    same precious "$(<"$folder/bus")" "the file"
}

test_a_link_of_somebody_else_is_left_alone() {
    echo precious >"$folder/file"
    ln -s "$folder/file" "$folder/bus"
    exits 1 "$RKM04" serve --link "$folder/bus"
    holds "$complained" "$folder/bus" "the message names the link"
    same "$folder/file" "$(readlink "$folder/bus")" "the link"
}

test_a_link_that_is_no_longer_its_own_is_not_removed_at_the_end() {
    serve bus
    ln -sfn "$folder/elsewhere" "$folder/bus"
    kill "$started"
    status_of "$started"
    same "$folder/elsewhere" "$(readlink "$folder/bus")" "the link of another"
}

test_a_second_unit_on_the_same_flash_image_is_refused() {
    serve one --flash "$folder/flash"
    exits 1 "$RKM04" serve --link "$folder/two" --flash "$folder/flash"
    holds "$complained" "$folder/flash" "the message names the image"
    [[ ! -e $folder/two && ! -L $folder/two ]] || fail "the refused unit has left a link"
    exits 0 ctl one -m 1 store
}

test_a_link_in_a_folder_that_does_not_exist_is_refused_with_its_name() {
    exits 1 "$RKM04" serve --link "$folder/no/such/bus"
    holds "$complained" "$folder/no/such" "the message names the folder"
}

run_cases "$@"
