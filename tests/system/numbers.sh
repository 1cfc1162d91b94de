#!/bin/bash
# SPDX-License-Identifier: MIT
# Numbers of options, addresses and commands that do not fit: refused, never taken for another number.

. "$(dirname "$0")/lib.sh"

# What each allowed number must not be mistaken for: it plus 2^16, 2^32, 2^64, and spellings that only C functions know.
strange=(65537 4294967297 18446744073709551617 99999999999999999999999999 +1 -1 ' 1' '1 ' 0x1 1e0 1.0 '' one)

# refused COMMAND...: wrong usage.
refused() {
    exits 2 timeout "$limit" "$@"
    [[ -n $complained ]] || fail "'$*': nothing is said"
}

test_numbers_of_the_emulator() {
    local number option
    for number in "${strange[@]}"; do
        for option in --node --lines --speed-change-latency --turnaround --tcp --rfc2217 --tcp=127.0.0.1: --rfc2217=[::1]: \
            --baud --exit-when-idle --min-coverage --ready-fd --seed --clock=x; do
            case $option$number in # these it does take
                --turnaround65537 | --seed65537 | --exit-when-idle65537 | --clock=x1.0 | --min-coverage1.0) continue ;;
            esac
            [[ $option == *[:x] ]] || option+==
            refused "$RKM04" serve --link "$folder/bus%l" "$option$number"
        done
        refused "$RKM04" serve --link "$folder/bus" --node "1-$number"
    done
    [[ -z $(ls "$folder"/bus* 2>/dev/null) ]] || fail "files were made"
}

test_numbers_of_the_client() {
    local number
    for number in "${strange[@]}"; do
        refused "$RKMCTL" -p "tcp:127.0.0.1:$number" version
        refused "$RKMCTL" -p "$folder/bus" -n "$number" version
        refused "$RKMCTL" -p "$folder/bus" -m "$number" position
        [[ $number == 65537 ]] || refused "$RKMCTL" -p "$folder/bus" --timeout "$number" version
        refused "$RKMCTL" -p "$folder/bus" --message-max "$number" version
        refused "$RKMCTL" -c "$folder/control" --line "$number" state
    done
}

test_numbers_of_commands_to_the_emulator() {
    local number control
    serve bus --clock stepped
    control=(-c "$folder/bus.control" --timeout 10000)
    for number in "${strange[@]}"; do
        refused "$RKMCTL" "${control[@]}" switch "$number"
        refused "$RKMCTL" "${control[@]}" di "$number=1"
        refused "$RKMCTL" "${control[@]}" "events" "motor=$number" --limit 1ms
        refused "$RKMCTL" "${control[@]}" wait "m$number.idle" --limit 1ms
        [[ $number == 65537 || $number == 4294967297 ]] || refused "$RKMCTL" "${control[@]}" "events" "count=$number" --limit 1ms
        [[ $number == 65537 ]] || refused "$RKMCTL" "${control[@]}" fault clear "$number"
        [[ $number == 65537 ]] || refused "$RKMCTL" "${control[@]}" trace stop "$number"
    done
    for number in 18446744073709551617 -1 0x1 1e0; do
        exits 2 "$RKMCTL" "${control[@]}" advance "$number"
    done
}

run_cases "$@"
