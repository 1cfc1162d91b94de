# SPDX-License-Identifier: MIT
# board.sh: what the tests of the Pico share. Sourced after lib.sh. npm installs rp2040js into the build folder, once
# (tools/setup.sh).

. "$(dirname "${BASH_SOURCE[0]}")/../../../tools/setup.sh"

tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)
build=${BUILD-${TMPDIR-/tmp}}
for tool in arm-none-eabi-gcc node flock; do
    command -v "$tool" >/dev/null ||
        skip_all "$tool not found: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi nodejs npm util-linux"
done
exec 8>"$build/pico.lock" && flock 8 # two of these tests at once
export NODE_PATH=$build/node-pico/node_modules
setup_pico "$build/node-pico" ||
    skip_all "there is no node with npm, or npm cannot install rp2040js (see $build/node-pico/npm.log)"
firmware=$build/firmware_pico
make -s -C "$tree/src/port/pico" OUT="$firmware" >/dev/null || exit 1
exec 8>&-
