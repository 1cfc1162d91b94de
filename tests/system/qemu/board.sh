# SPDX-License-Identifier: MIT
# board.sh: what the tests of boards under QEMU share. Sourced after lib.sh. QEMU puts the board's UART on a pty.

tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)

# firmware PORT PACKAGES TOOL...: build the firmware of a port; its folder is $firmware. Skips the tests if a tool is missing.
firmware() {
    local port=$1 packages=$2 tool
    for tool in "${@:3}"; do
        command -v "$tool" >/dev/null && continue
        skip_all "$tool not found: apt-get install $packages"
    done
    firmware=${BUILD:-/tmp}/firmware_$port
    make_in "$firmware" make -s -C "$tree/src/port/$port" OUT="$firmware" >/dev/null || exit 1
}

# board QEMU...: power up a board; its line is $line, its monitor $folder/monitor.
board() {
    start qemu "$@" -kernel "$firmware/firmware.elf" -display none -serial pty -monitor "unix:$folder/monitor,server,nowait"
    soon "QEMU has a pty" line_found
    exec 9<>"$line" # or QEMU looks for a client only once a second
    soon "the unit answers" answers
}

line_found() {
    line=$(sed -n 's/^char device redirected to \([^ ]*\) .*/\1/p' "$folder/qemu.out" "$folder/qemu.err" 2>/dev/null | head -1)
    [[ -n $line ]]
}

# monitor COMMAND: what QEMU says to it, until it asks for the next one.
monitor() {
    timeout "$limit" python3 - "$folder/monitor" "$*" <<'END'
import socket, sys
monitor = socket.socket(socket.AF_UNIX)
monitor.connect(sys.argv[1])
for command in (sys.argv[2].encode() + b"\n", b""):
    said = b""
    while not said.endswith(b"(qemu) "):
        more = monitor.recv(4096)
        if not more:
            break
        said += more
    monitor.sendall(command)
print(said.decode(errors="replace"))
END
}

# unit ARGUMENTS...: the client on the board's line.
unit() {
    "$RKMCTL" --timeout 20000 --message-max 1024 -p "$line" "$@"
}

answers() { "$RKMCTL" --timeout 500 -p "$line" version >"$folder/version" 2>&1; }

stands_at() { [[ $(unit -m "$1" position) == "motor $1: $2" ]]; }

# A program of 699 commands, and the answer when it is read: longer than all the queues on the way.
full_memory_comes_back() {
    local i
    for i in {1..232}; do
        echo 'F16000000 V16000 A60000'
    done >"$folder/program.rks"
    exits 0 unit -m 2 set '\ O01' # waits for an input that never comes
    exits 0 unit -m 2 send "$folder/program.rks"
    echo "O01 [ $(tr '\n' ' ' <"$folder/program.rks")]" >"$folder/expected"
    unit -m 2 command >"$folder/answer"
    cmp "$folder/expected" "$folder/answer" >"$folder/cmp.err" 2>&1 || fail "another program came back"
}
