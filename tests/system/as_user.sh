#!/bin/bash
# SPDX-License-Identifier: MIT
# The tests of the pty as an ordinary user: the system lets root open what a client has taken for itself (TIOCEXCL). Run as root,
# this becomes the user 65534 (`nobody`); an ordinary user stays what he is.

set -u
: "${RKM04:=rkm04}" "${RKMCTL:=rkmctl}" "${PTY_CLIENT:=pty_client}" "${CC:=cc}"
cases="pty.sh pyserial.sh"
here=$(dirname "$0")

if [[ $(id -u) == 0 ]]; then
    command -v setpriv >/dev/null || { echo "failed: needs setpriv (util-linux) to be another user"; exit 1; }
    # Another user may not be allowed into the folder of the build.
    place=$(mktemp -d) || exit 1
    trap 'rm -rf "$place"' EXIT
    cp "$RKM04" "$RKMCTL" "$PTY_CLIENT" "$here"/*.{sh,py,c} "$place"
    chmod -R a+rX "$place"
    RKM04=$place/${RKM04##*/} RKMCTL=$place/${RKMCTL##*/} PTY_CLIENT=$place/${PTY_CLIENT##*/} HOME=/ \
        setpriv --reuid=65534 --regid=65534 --clear-groups -- env -u XDG_RUNTIME_DIR "$place/as_user.sh"
    exit
fi

failed=0
for script in $cases; do
    "$here/$script"
    status=$?
    [[ $status == 0 || $status == 77 ]] || failed=1
done
exit $failed
