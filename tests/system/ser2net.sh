#!/bin/bash
# SPDX-License-Identifier: MIT
# The client side of ser2net's library (gensiot of gensio-bin) against --rfc2217.

. "$(dirname "$0")/lib.sh"

if ! command -v gensiot >/dev/null; then
    skip_all "there is no gensiot; apt-get install gensio-bin"
fi

has_answered() { [[ $(od -An -v -tx1 "$folder/client.out" | tr -d ' \n') == "$1" ]]; }

test_a_client_with_ser2net_s_library_opens_talks_closes_and_opens_again() {
    local address i
    start bus "$RKM04" serve --framing plain --rfc2217 0
    soon "the unit is ready" ready bus
    address=$(sed -n 's/^READY .*"rfc2217":"\([^"]*\)".*/\1/p' "$folder/bus.out")
    mkfifo "$folder/keys"
    for i in 1 2 3; do
        gensiot -i 'stdio(self)' "telnet(rfc2217),tcp,${address%:*},${address##*:}" \
            <"$folder/keys" >"$folder/client.out" 2>"$folder/client.err" &
        processes+=("$!")
        exec 3>"$folder/keys"
        say_bytes 3 "01 00 01 ff"
        soon "the answer to the unknown message" has_answered 010004ffff0000
        say_bytes 3 "01 00 02 04 31"
        soon "the position" has_answered 010004ffff000001000d04310a20202020202020202030
        exec 3>&-
        status_of "${processes[-1]}"
    done
}

run_cases "$@"
