#!/bin/bash
# SPDX-License-Identifier: MIT
# The window's service view over ser2net, which has the unit on a serial device, here a pty.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/window/browser.sh"

PATH=$PATH:/usr/sbin
command -v ser2net >/dev/null || skip_all "there is no ser2net; apt-get install ser2net"

listens() {
    address=$(ss -Hltnp 2>/dev/null | sed -n "s/.* \(127\.0\.0\.1:[0-9]*\) .*pid=$started,.*/\1/p")
    [[ -n $address ]]
}

test_the_service_view_works_over_ser2net() {
    local address
    serve bus
    cat >"$folder/ser2net.yaml" <<END
connection: &unit
  accepter: tcp,127.0.0.1,0
  connector: serialdev,$(readlink -f "$folder/bus"),19200n81,local
END
    start ser2net ser2net -n -c "$folder/ser2net.yaml"
    soon "ser2net listens" listens
    export WINDOW_PORT=tcp:$address
    open_window
    browse service
}

run_cases "$@"
