#!/bin/bash
# SPDX-License-Identifier: MIT
# Programs for Windows under the Wine of an ordinary user, who has fewer rights and descriptors. Run as root, some cases of the
# other tests are run as the user 65534 (`nobody`), with a home of his own; an ordinary user runs all of them as himself.

set -u
: "${RKM04:=rkm04}" "${RKMCTL:=rkmctl}" "${RKM04_EXE=}"
here=$(cd "$(dirname "$0")" && pwd)

[[ -f $RKM04_EXE ]] || { echo "skipped: rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"; exit 77; }
[[ $(id -u) == 0 ]] || { echo "skipped: all windows tests run as this user"; exit 77; }
command -v setpriv >/dev/null || { echo "failed: needs setpriv (util-linux) to be another user"; exit 1; }

# Another user may not be allowed into the folders of the sources and the build.
place=$(mktemp -d) || exit 1
trap 'rm -rf "$place"' EXIT
mkdir -p "$place"/{home,tests/system,tools}
cp "$RKM04" "$RKMCTL" "$RKM04_EXE" "${RKM04_EXE%/*}/rkmctl.exe" "$place"
cp "$here"/{windows_*,lib}.sh "$place/tests/system"
cp "$here/../../tools/wine.sh" "$place/tools"
chmod -R a+rX "$place"
chown 65534:65534 "$place/home"

# as_user TEST CASE...
as_user() {
    env -u XDG_RUNTIME_DIR HOME="$place/home" RKM04="$place/${RKM04##*/}" RKMCTL="$place/${RKMCTL##*/}" \
        RKM04_EXE="$place/${RKM04_EXE##*/}" setpriv --reuid=65534 --regid=65534 --clear-groups -- "$place/tests/system/$@"
}

failed=0
as_user windows_serve.sh test_the_control_socket_is_a_TCP_port_with_a_file_for_the_user_alone \
    test_256_buses_need_few_sockets test_a_unit_at_a_COM_port_is_used_to_the_last_step \
    test_what_Windows_does_not_have_is_refused
[[ $? == @(0|77) ]] || failed=1
as_user windows_ctl.sh test_an_emulator_there_is_found_and_asked_and_its_file_is_private
[[ $? == @(0|77) ]] || failed=1
exit $failed
