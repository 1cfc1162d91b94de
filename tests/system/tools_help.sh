#!/bin/bash
# SPDX-License-Identifier: MIT
# Every tool describes itself with --help, and refuses what it does not know, at once and with status 2.

. "$(dirname "$0")/lib.sh"
tools=$(cd "$(dirname "$0")/../../tools" && pwd)

# What is sourced by others is no tool.
all_tools() { find "$tools" -maxdepth 1 -type f -perm -u+x ! -name '*.sh' | sort; }

test_every_tool_has_help() {
    local tool
    (($(all_tools | wc -l) >= 25)) || fail "the tools are not where they were"
    for tool in $(all_tools); do
        exits 0 timeout 120 "$tool" --help
        [[ ${said,,} == *usage:* && $said == *"tools/${tool##*/}"* ]] || fail "${tool##*/} --help: $said"
    done
}

# tools/run hands what it does not know on to rkm04 serve.
test_every_tool_refuses_an_option_that_it_does_not_have() {
    local tool
    for tool in $(all_tools | grep -v '/run$'); do
        exits 2 timeout 120 "$tool" --no-such-option
        [[ -n $complained ]] || fail "${tool##*/} does not say what is wrong"
    done
}

test_a_Python_that_cannot_build_a_wheel_is_answered_with_one_that_can() {
    printf '#!/bin/sh\nexit 1\n' >"$folder/python"
    chmod +x "$folder/python"
    exits 1 "$tools/python-wheel" "$folder/dist" "$folder/python"
    holds "$complained" "tools/python-env build/python-env makes one that has: then tools/python-wheel $folder/dist" "the message"
}

run_cases "$@"
