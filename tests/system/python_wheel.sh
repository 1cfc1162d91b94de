#!/bin/bash
# SPDX-License-Identifier: MIT
# The Python package as users install it: a wheel in an empty environment, outside the sources, with the oldest and the newest
# Python at hand.
. "$(dirname "$0")/lib.sh"

root=$(cd "$(dirname "$0")/../.." && pwd)
: "${BUILD:=$root/build/dev}"
env=$BUILD/python-env
python=$(sed -n 's/^_\?Python_EXECUTABLE:.*=//p' "$BUILD/CMakeCache.txt" | head -n 1)
[[ -n $python ]] || skip_all "the extension was not built: there were no headers of Python (Debian: python3-dev)"
said=$("$root/tools/python-env" "$env" "$python") || { echo "$said"; exit 77; }
export CFLAGS=-Wpadded # a compiler that warns of more than those that were at hand: no reason not to install
wheel=$("$root/tools/python-wheel" "$BUILD/python-wheel" "$env/bin/python" | tail -n 1)
version=$(sed -n 's/.*RKM04_VERSION "\(.*\)".*/\1/p' "$root/include/rkm04/limits.h")
export PYTHONDONTWRITEBYTECODE=1
unset PYTHONPATH

# Every Python from 3.9 on that is here, "VERSION PATH", the oldest first.
pythons() {
    local path version
    for path in $(compgen -c python3. | sort -u) "${PYENV_ROOT:-$HOME/.pyenv}"/versions/*/bin/python3; do
        [[ $path == *-config ]] && continue
        version=$("$path" -c 'import sys, venv, ensurepip; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || continue
        [[ $version == 3.9 || $version == 3.[1-9][0-9] ]] && echo "$version $path"
    done | sort -t. -k2,2n -u
}

install_wheel() {
    "$1" -m venv "$folder/env" || fail "no environment"
    "$folder/env/bin/pip" install -q --no-index --find-links "$env/wheels" "$wheel" >"$folder/pip.err" 2>&1 ||
        fail "the wheel needs more than pyserial"
}

test_wheel_runs_what_readme_shows() {
    install_wheel "$python"
    sed -n '/<!-- python -->/,/^[^ ]/{/^    /s/^    //p}' "$root/README.md" >"$folder/example.py"
    grep -q 'rkm04.Bus' "$folder/example.py" || fail "there is no example in README.md"
    cd "$folder" && "$folder/env/bin/python" -W error example.py 2>"$folder/example.err" || fail "the example has failed"
}

test_wheel_has_the_programs() {
    install_wheel "$python"
    same "$("$folder/env/bin/rkm04" --version)" "rkm04 $version" "version of rkm04"
    same "$("$folder/env/bin/rkmctl" --version)" "rkmctl $version" "version of rkmctl"
    cd "$folder" && "$folder/env/bin/python" -c 'import rkm04
with rkm04.serve() as bus:
    assert bus.exchange(1, rkm04.request("Version")).text == "01.02,06.03.2009"' || fail "serve does not work"
    same "$(env/bin/python -c 'import rkm04, sys; print("pytest" in sys.modules, rkm04.__version__)')" "False $version" "import"
}

test_wheel_lets_a_program_that_does_not_know_it_open_the_url() {
    install_wheel "$python"
    cd "$folder" && "$folder/env/bin/python" -c 'import serial
port = serial.serial_for_url("rkm04://?node=1", 19200, timeout=1)
port.write(bytes.fromhex("7E010001998D7E"))
assert len(port.read(24)) == 24' || fail "pyserial does not find rkm04://"
}

# tests_with "VERSION PATH": the tests of the package with the wheel.
tests_with() {
    local number=${1%% *}
    "$root/tools/python-env" "$env-$number" "${1#* }" >"$folder/env.err" || skip_case "$(tail -n 1 "$folder/env.err")"
    "$env-$number/bin/pip" install -q --no-deps --force-reinstall "$wheel" >"$folder/pip.err" 2>&1 || fail "not installed"
    cd "$root/python/tests" && "$env-$number/bin/python" -m pytest -q -p no:cacheprovider . >"$folder/pytest.err" 2>&1 ||
        fail "the tests fail with Python $number"
}

test_tests_pass_with_the_oldest_python() {
    tests_with "$(pythons | head -n 1)"
}

test_tests_pass_with_the_newest_python() {
    tests_with "$(pythons | tail -n 1)"
}

run_cases "$@"
