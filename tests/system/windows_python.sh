#!/bin/bash
# SPDX-License-Identifier: MIT
# The Python package on Windows, as users install it: the wheel in a Python for Windows, which runs under Wine.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}"
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
[[ -f ${RKM04_EXE%/*}/python/rkm04/_sim.pyd ]] ||
    skip_all "there is no Python for Windows; apt-get install maven, and reach Maven Central"
has_wine || skip_all "there is no Wine; apt-get install wine64"
root=$(cd "$(dirname "$0")/../.." && pwd)
: "${BUILD:=$root/build/dev}"
host=$BUILD/python-env
said=$("$root/tools/python-env" "$host" python3) || { echo "$said"; exit 77; }
export RKM04_WINDOWS_BUILD=${RKM04_EXE%/*}
windows_python=$RKM04_WINDOWS_BUILD/python-for-windows
wheel=$("$root/tools/python-wheel" --windows "$BUILD/python-wheel-windows" "$host/bin/python" | tail -n 1)
[[ -f $wheel ]] || { echo "there is no wheel"; exit 1; }
version=$("$RKM04" --version)

# One prefix and one installation for all cases: both take their time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"
chmod 755 "$prefix"

# python_exe ARGUMENTS...: it wants pipes, and takes the programs of the package.
python_exe() {
    { unset RKM04 RKMCTL; wine_in "$prefix" "$windows_python/python.exe" "$@" </dev/null 2>&1; } | tr -d '\r'
    return "${PIPESTATUS[0]}"
}

export PYTHONDONTWRITEBYTECODE=1
packages=$prefix/packages
said=$(python_exe -m pip install -q --no-index --no-compile --find-links "$windows_python/wheels" --target "$packages" "$wheel" \
    pytest pytest-asyncio pyserial-asyncio pymodbus)
[[ -z $said && -f $packages/rkm04/_sim.pyd ]] || { echo "pip cannot install $wheel: $said"; exit 1; }
export PYTHONPATH=Z:$packages # from any drive

test_the_wheel_is_for_every_Python_of_64_bits_and_needs_libraries_of_Windows_alone() {
    same "rkm04-${version#* }-cp39-abi3-win_amd64.whl" "${wheel##*/}" "its name"
    x86_64-w64-mingw32-objdump -p "$packages/rkm04/_sim.pyd" | sed -n 's/.*DLL Name: //p' >"$folder/libraries.out"
    holds "$(<"$folder/libraries.out")" python3.dll "the stable ABI"
    same "" "$(grep -vxiE '(advapi32|kernel32|msvcrt|python3|ws2_32)[.]dll' "$folder/libraries.out")" "libraries of others"
}

test_the_wheel_runs_what_the_README_shows() {
    sed -n '/<!-- python -->/,/^[^ ]/{/^    /s/^    //p}' "$root/README.md" >"$folder/example.py"
    grep -q 'rkm04.Bus' "$folder/example.py" || fail "there is no example in README.md"
    cd "$folder" && python_exe -W error example.py >"$folder/example.err" || fail "the example has failed"
}

test_the_first_test_of_the_document_passes() {
    sed -n '/^Write it into `test_axis.py`/,/^The wheel has/{/^    /s/^    //p}' "$root/docs/WINDOWS.md" >"$folder/test_axis.py"
    cd "$folder" && python_exe -m pytest -p no:cacheprovider >pytest.err || fail "it fails"
    holds "$(<pytest.err)" "2 passed" "the result"
}

test_what_cannot_be_fetched_is_said_and_what_is_another_one_is_refused() {
    mkdir "$folder/bin"
    printf '#!/bin/sh\nexit 1\n' >"$folder/bin/mvn"
    chmod +x "$folder/bin/mvn"
    PATH=$folder/bin:$PATH exits 77 "$root/tools/windows-python" "$folder/python"
    holds "$said" "skipped: org.bytedeco:cpython" "the message"
    cat >"$folder/bin/mvn" <<'END'
#!/bin/sh
for word; do case $word in -Dmaven.repo.local=*) m2=${word#*=} ;; esac; done
mkdir -p "$m2/org/bytedeco" && echo another >"$m2/org/bytedeco/cpython.jar"
END
    PATH=$folder/bin:$PATH exits 1 "$root/tools/windows-python" "$folder/python"
    holds "$complained" "is another one than" "the message"
    [[ ! -e $folder/python/made.lock ]] || fail "it counts as made"
}

test_the_wheel_has_the_programs() {
    for program in rkm04 rkmctl; do
        same "$program ${version#* }" "$(wine_in "$prefix" "$packages/bin/$program.exe" --version 2>/dev/null </dev/null | cat)" \
            "version of $program"
    done
    said=$(wine_in "$prefix" "$packages/bin/rkm04.exe" exec none.rks </dev/null 2>&1 | cat; exit "${PIPESTATUS[0]}")
    same 1 $? "exit status of rkm04"
    holds "$said" "none.rks" "the message"
}

test_a_program_that_does_not_know_the_package_opens_the_url() {
    cd "$folder" && python_exe -c 'import serial
port = serial.serial_for_url("rkm04://?node=1", 19200, timeout=1)
port.write(bytes.fromhex("7E010001998D7E"))
assert len(port.read(24)) == 24' >"$folder/url.err" || fail "pyserial does not find rkm04://"
}

test_paths_have_letters_of_any_language_whatever_the_code_page() {
    cd "$folder" && python_exe -c 'import ctypes, rkm04
assert ctypes.windll.kernel32.GetACP() != 65001
with rkm04.Bus() as bus:
    bus.trace("žluťoučký kůň.csv")
    bus.unit(1).motor(1).set("F10 R")
    bus.wait(motor=1, state="idle")' >paths.err || fail "a trace"
    grep -q step "žluťoučký kůň.csv" || fail "the trace is elsewhere: $(ls)"
}

# package_tests ARGUMENTS...: of the tests of the package. Each starts and ends within the limit of wine_in.
package_tests() {
    cd "$root/python/tests" && python_exe -m pytest -q -p no:cacheprovider "$@" >"$folder/pytest.err" ||
        fail "$* fails: $(grep -E '^(FAILED|ERROR)' "$folder/pytest.err")"
}

test_a_bus_in_the_process() { package_tests test_{bus,cib,cnc872,libraries,memory,methods,pmc,port,pyserial_suite}.py; }

test_virtual_time_and_the_plugin_of_pytest() { package_tests test_{explore,plugin,virtual_time}.py; }

test_an_emulator_that_serve_starts_and_the_example() {
    package_tests test_remote.py test_examples.py -k 'test_remote or tcp or test_served'
}

run_cases "$@"
