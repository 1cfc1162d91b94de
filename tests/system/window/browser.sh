# SPDX-License-Identifier: MIT
# browser.sh: what the tests of the window in a browser share. Sourced after lib.sh. npm installs what drives the browser into the
# build folder, once.

. "$(dirname "${BASH_SOURCE[0]}")/../../../tools/setup.sh"
[[ -n ${RKM04_WINDOW-} ]] || skip_all "built without the window"
CHROMIUM=$(command -v chromium) || skip_all "there is no chromium"
export CHROMIUM RKM04_TIMEOUT=5000 # cases wait for silence, too
drive=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/drive.mjs
modules=${BUILD-${TMPDIR-/tmp}}/node-window
export NODE_PATH=$modules/node_modules
setup_window "$modules" || skip_all "there is no node with npm, or npm cannot install playwright-core (see $modules/npm.log)"

# open_window OPTION...: starts it; $address is what it prints.
open_window() {
    start window "$RKMCTL" window "$@"
    export WINDOW_PID=$started
    soon "the address of the window" grep -qs '^WINDOW http://' "$folder/window.out"
    address=$(sed -n 's/^WINDOW //p' "$folder/window.out")
}

# browse CASE: what a person does in the page. PICTURES names a folder for screenshots; WINDOW_LIMIT seconds are given.
browse() {
    HOME=$folder exits 0 timeout "${WINDOW_LIMIT-500}" node "$drive" "$1" "$address" "$folder" ${PICTURES-}
    [[ -z $said ]] || printf '  %s\n' "$said"
}

# drive CASE: with an emulator and the window.
drive() {
    serve bus
    drive_with "$1" "$folder/bus.control"
}

# drive_with CASE CONTROL: with the window for the emulator with this control socket.
drive_with() {
    open_window -c "$2"
    browse "$1"
}
