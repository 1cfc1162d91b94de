# SPDX-License-Identifier: MIT
# tools/setup.sh: what has to be installed. Sourced by tools/run and tools/test; needs nothing but bash.
#
#   setup_packages run|test|quick    install the Debian packages that are missing, or say which ones are needed elsewhere

# Needed to build and run the emulator and its client.
run_packages=(gcc libc6-dev make cmake pkg-config libuv1-dev libjansson-dev libseccomp-dev libyaml-dev libncurses-dev
    libedit-dev libwebsockets-dev libwebsockets-evlib-uv)
# Needed on top of that to make the Debian package.
package_packages=(dpkg-dev file)
# Needed on top of that by the tests.
test_packages=("${package_packages[@]}" check libgmp-dev valgrind socat procps clang cppcheck g++ python3-serial python3-pyte
    python3-pymodbus python3-serial-asyncio libmodbus-dev mbpoll
    python3-dev python3-venv librsvg2-bin fonts-dejavu-core zsh fish gensio-bin ser2net iproute2 tshark sigrok-cli gtkwave
    lintian systemd chromium vim gcc-mingw-w64-x86-64-win32 wine64 maven)
# Needed by the tests with npm packages, if the machine has no node and npm of its own.
node_packages=(nodejs npm)
# Needed by the tests that are about another processor than this machine's, which `quick` leaves out.
foreign_packages=(gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm
    gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-system-misc)

say() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }

# Is this Debian 12 or later? (OS_RELEASE: another file than /etc/os-release, for the tests.)
is_debian() {
    local ID='' VERSION_ID=''
    [[ -r ${OS_RELEASE:=/etc/os-release} ]] && . "$OS_RELEASE"
    [[ $ID == debian && ( -z $VERSION_ID || ${VERSION_ID%%.*} -ge 12 ) ]] && command -v dpkg-query apt-get >/dev/null
}

# Names of those packages given that are not installed.
missing_packages() {
    local installed package
    installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null)
    for package in "$@"; do
        grep -qx "$package installed" <<<"$installed" || echo "$package"
    done
}

# What cannot be found, however it was installed: one line each.
missing_tools() {
    local tool
    for tool in cc make cmake pkg-config; do
        command -v "$tool" >/dev/null || echo "$tool"
    done
    for tool in libuv jansson libseccomp yaml-0.1 ncursesw libwebsockets $([[ $1 != run ]] && echo check gmp); do
        pkg-config --exists "$tool" 2>/dev/null || echo "library $tool (pkg-config)"
    done
    if [[ $1 != run ]]; then
        for tool in socat ps $([[ $1 == test ]] && echo arm-none-eabi-gcc); do
            command -v "$tool" >/dev/null || echo "$tool"
        done
    fi
}

# Go on if the tools are there all the same, otherwise give up.
check_tools() {
    local missing
    missing=$(missing_tools "$1")
    [[ -z $missing ]] && return
    say "not found: ${missing//$'\n'/, }"
    exit 1
}

install_packages() {
    local as_root=()
    if [[ $(id -u) != 0 ]]; then
        if ! command -v sudo >/dev/null; then
            say "missing: $*"
            say "as root, do: apt-get install --no-install-recommends $*"
            return 1
        fi
        as_root=(sudo)
    fi
    say "installing $*"
    # The list of packages first: on a fresh machine it is empty. What apt prints goes to stderr, stdout is for results.
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q update </dev/null >&2 &&
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends install "$@" </dev/null >&2
}

setup_packages() {
    local packages=("${run_packages[@]}") missing
    if [[ $1 != run ]]; then
        packages+=("${test_packages[@]}")
        command -v node >/dev/null && command -v npm >/dev/null || packages+=("${node_packages[@]}")
    fi
    [[ $1 == test ]] && packages+=("${foreign_packages[@]}")
    if ! is_debian; then
        say "this is not Debian 12 or later; needed are what these Debian packages hold: ${packages[*]}"
        check_tools "$1"
        return
    fi
    mapfile -t missing < <(missing_packages "${packages[@]}")
    ((${#missing[@]} == 0)) && return
    install_packages "${missing[@]}" || {
        say "could not install ${missing[*]}"
        check_tools "$1"
    }
}

# setup_node_packages SOURCE FOLDER MODULE: the npm packages of SOURCE/package-lock.json in the folder, MODULE among them; nothing
# is compiled. Tests that run at the same time want the same: one at a time.
setup_node_packages() {
    command -v node >/dev/null && command -v npm >/dev/null && mkdir -p "$2" || return
    (
        exec 9>"$2.lock" && flock 9
        cmp -s "$1/package-lock.json" "$2/package-lock.json" &&
            NODE_PATH=$2/node_modules node -e "require('$3')" 2>/dev/null && exit
        cp "$1/package.json" "$1/package-lock.json" "$2" &&
            timeout 500 npm ci --prefix "$2" --no-audit --no-fund --ignore-scripts </dev/null >"$2/npm.log" 2>&1 &&
            NODE_PATH=$2/node_modules node -e "require('$3')" 2>>"$2/npm.log"
    )
}

# setup_serialport FOLDER: node-serialport, as tests/system/node/package-lock.json has it, in the folder.
setup_serialport() {
    local source
    source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../tests/system/node" && pwd) || return
    setup_node_packages "$source" "$1" serialport
}

# setup_window FOLDER: playwright-core and axe-core, as tests/system/window/package-lock.json has them, in the folder.
setup_window() {
    local source
    source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../tests/system/window" && pwd) || return
    setup_node_packages "$source" "$1" axe-core
}

# setup_pico FOLDER: rp2040js, as tests/system/pico/package-lock.json has it, in the folder.
setup_pico() {
    local source
    source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../tests/system/pico" && pwd) || return
    setup_node_packages "$source" "$1" rp2040js
}

# list_skips LOG: what the tests in ctest's log have left out, and why, a line each.
list_skips() {
    awk '/^[0-9]+\/[0-9]+ Testing: / { test = $3 }
        sub(/^ *skipped: /, "") { print (count++ ? "" : "Skipped:\n") "  " test ": " $0 }
        END { if (!count) print "Nothing was skipped." }' "$1"
}

# Hand the output of a build on as progress: one line that changes on a terminal, otherwise a line for each quarter.
show_progress() {
    local line percent shown=-1
    while IFS= read -r line; do
        [[ $line =~ ^\[\ *([0-9]+)%\] ]] || continue
        percent=${BASH_REMATCH[1]}
        if [[ -t 2 ]]; then
            printf '\r%s: building: %3d %%' "${0##*/}" "$percent" >&2
        elif ((percent / 25 > shown)); then
            shown=$((percent / 25))
            say "building: $percent %"
        fi
    done
    [[ -t 2 ]] && printf '\r\033[K' >&2
}

# Build a preset with its progress; the compiler's output is shown if it fails.
build_preset() {
    local log status
    log=$(mktemp) || exit 1
    say "building ($1)"
    { cmake --preset "$1" && cmake --build --preset "$1" -j "$(nproc)"; } 2>&1 </dev/null | tee "$log" | show_progress
    status=${PIPESTATUS[0]}
    if ((status != 0)); then
        cat "$log" >&2
        say "the build failed"
    fi
    rm -f "$log"
    return $status
}
