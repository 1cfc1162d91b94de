#!/bin/bash
# SPDX-License-Identifier: MIT
# tools/setup.sh: which packages are installed, and when the package manager is left alone. The package manager here is a
# stand-in that writes down how it was called.

. "$(dirname "$0")/lib.sh"
tools=$(cd "$(dirname "$0")/../../tools" && pwd)

# stand_ins ABSENT APT_STATUS ID: everything is installed but the package ABSENT.
stand_ins() {
    mkdir "$folder/bin"
    printf '#!/bin/sh\necho "$*" >>"%s"\nexit %s\n' "$folder/calls" "$2" >"$folder/bin/apt-get"
    printf '#!/bin/bash\nshift 2\nfor p; do [[ $p == "%s" ]] || echo "$p installed"; done\n' "$1" >"$folder/bin/dpkg-query"
    # shellcheck disable=SC2016
    printf '#!/bin/sh\ncase " $ABSENT_LIBRARIES " in *" $2 "*) exit 1;; esac\n' >"$folder/bin/pkg-config"
    printf '#!/bin/sh\nexec "$@"\n' >"$folder/bin/sudo"
    chmod +x "$folder"/bin/*
    printf 'ID=%s\nVERSION_ID="12"\n' "$3" >"$folder/os-release"
    : >"$folder/calls"
}

# set_up run|test|quick: ends with the status of the set-up; "went on" if the tool would go on.
set_up() {
    OS_RELEASE=$folder/os-release PATH=$folder/bin:$PATH \
        bash -c '. "$1/setup.sh"; setup_packages "$2"; echo "went on"' tools "$tools" "$1"
}

test_with_everything_there_the_package_manager_is_not_called() {
    stand_ins none 0 debian
    exits 0 set_up test
    same "went on" "$said" "stdout"
    same "" "$(<"$folder/calls")" "calls of apt-get"
}

test_only_what_is_missing_is_installed() {
    stand_ins socat 0 debian
    exits 0 set_up test
    holds "$(<"$folder/calls")" "install socat" "calls of apt-get"
    same 2 "$(wc -l <"$folder/calls")" "calls of apt-get: update and install"
}

# npm takes its time, and knows no folder in which another one is at work.
test_packages_of_node_are_installed_by_one_at_a_time() {
    local at
    mkdir "$folder/bin" "$folder/source"
    printf '#!/bin/sh\necho begin >>"%s"; sleep 0.5; mkdir "$3/module"; echo end >>"%s"\n' "$folder/calls" "$folder/calls" \
        >"$folder/bin/npm"
    printf '#!/bin/sh\ntest -d "$(dirname "$NODE_PATH")/module"\n' >"$folder/bin/node"
    chmod +x "$folder"/bin/*
    touch "$folder"/source/package{,-lock}.json
    for at in 1 2 3; do
        PATH=$folder/bin:$PATH start "one$at" bash -c '. "$1/setup.sh"; setup_node_packages "$2/source" "$2/packages" module' \
            one "$tools" "$folder"
    done
    for at in "${processes[@]}"; do
        status_of "$at"
        same 0 "$status" "exit status"
    done
    same "begin end" "$(xargs <"$folder/calls")" "what npm did"
}

test_running_does_not_need_what_only_tests_need() {
    stand_ins socat 0 debian
    exits 0 set_up run
    same "" "$(<"$folder/calls")" "calls of apt-get"
}

test_the_quick_tests_do_not_need_what_is_for_other_processors() {
    stand_ins qemu-system-arm 0 debian
    exits 0 set_up quick
    same "" "$(<"$folder/calls")" "calls of apt-get"
    exits 0 set_up test
    holds "$(<"$folder/calls")" "install qemu-system-arm" "calls of apt-get"
}

test_without_network_it_goes_on_if_the_tools_are_found_all_the_same() {
    stand_ins check 100 debian
    exits 0 set_up test
    same "went on" "$said" "stdout"
    holds "$complained" check "the message names the package"
}

test_without_network_and_without_the_tools_it_gives_up() {
    stand_ins check 100 debian
    export ABSENT_LIBRARIES=check
    exits 1 set_up test
    holds "$complained" check "the message names what is missing"
}

test_another_system_is_told_what_is_needed() {
    stand_ins none 0 fedora
    exits 0 set_up run
    same "went on" "$said" "stdout"
    holds "$complained" "libuv1-dev libjansson-dev" "the message names the packages"
    export ABSENT_LIBRARIES=jansson
    exits 1 set_up run
    holds "$complained" jansson "the message names what is missing"
    same "" "$(<"$folder/calls")" "calls of apt-get"
}

test_what_is_skipped_is_named_with_its_reason() {
    list() { bash -c '. "$1/setup.sh"; list_skips "$2"' tools "$tools" "$folder/log"; }
    printf '%s\n' '1/2 Testing: system_a' 'ok test_x' '2/2 Testing: system_b' 'skipped: there is no foo' >"$folder/log"
    exits 0 list
    same $'Skipped:\n  system_b: there is no foo' "$said" "one skipped"
    printf '%s\n' '1/1 Testing: system_a' '  skipped: test_x: no bar' 'ok test_x' >"$folder/log"
    exits 0 list
    same $'Skipped:\n  system_a: test_x: no bar' "$said" "a case skipped"
    printf '%s\n' '1/1 Testing: system_a' 'ok test_x' >"$folder/log"
    exits 0 list
    same "Nothing was skipped." "$said" "none skipped"
}

test_node_is_installed_only_where_the_machine_has_none() {
    stand_ins npm 0 debian
    printf '#!/bin/sh\n' | tee "$folder/bin/node" >"$folder/bin/npm"
    chmod +x "$folder/bin/node" "$folder/bin/npm"
    exits 0 set_up test
    same "" "$(<"$folder/calls")" "calls of apt-get with a node"
    rm "$folder/bin/npm"
    local tool
    for tool in bash id dirname sed awk grep cat env mktemp; do ln -s "$(command -v $tool)" "$folder/bin"; done
    OS_RELEASE=$folder/os-release PATH=$folder/bin exits 0 \
        bash -c '. "$1/setup.sh"; setup_packages "$2"; echo "went on"' tools "$tools" test
    holds "$(<"$folder/calls")" "install npm" "calls of apt-get without npm"
}

test_the_tools_explain_themselves_and_refuse_what_they_do_not_know() {
    exits 0 "$tools/run" --help
    holds "$said" "Usage: tools/run" "stdout"
    exits 0 "$tools/test" --help
    holds "$said" "Usage: tools/test" "stdout"
    exits 2 "$tools/test" --frobnicate
    holds "$complained" --frobnicate "the message names the option"
    exits 0 "$tools/digest-all" --help
    holds "$said" "Usage: tools/digest-all" "stdout"
    exits 2 "$tools/digest-all" vax
    holds "$complained" vax "the message names the target"
}

run_cases "$@"
