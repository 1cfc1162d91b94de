# SPDX-License-Identifier: MIT
"""The pytest plugin: fixtures, marker, failure reports, assertions; each test runs a pytest of its own."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import rkm04
from rkm04 import _system

REQUEST = 'port.write(bytes.fromhex("7E010001998D7E")); assert len(port.read(24)) == 24'
PTY = pytest.param("pty", marks=pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows"))
HEAD = "import pytest, rkm04, serial, time\n"


@pytest.fixture
def run(pytester):
    """Run a pytest on one test file; returns its result."""
    def run(text, *arguments):
        pytester.makepyfile(test_it=HEAD + text)
        pytester.makeini("[pytest]\nasyncio_default_fixture_loop_scope = function\n")
        return pytester.runpytest_inprocess("-p", "no:cacheprovider", *arguments)

    return run


def test_bus_port_and_time(run):
    result = run(f"""
def test_it(rkm04_bus, rkm04_port, rkm04_time):
    with serial.serial_for_url(rkm04_port, baudrate=19200, timeout=1) as port:
        {REQUEST}
        begin = time.monotonic()
        time.sleep(60)
        assert time.monotonic() - begin == pytest.approx(60)
    assert rkm04_bus.now > 60_000_000
""")
    result.assert_outcomes(passed=1)


def test_each_test_has_a_fresh_bus(run):
    result = run("""
@pytest.mark.parametrize("n", [1, 2])
def test_it(rkm04_bus, n):
    assert rkm04_bus.unit(1).motor(1).position == 0 and rkm04_bus.now == 0
    rkm04_bus.unit(1).motor(1).set("F10 R")
    rkm04_bus.wait(motor=1, position=10)
""")
    result.assert_outcomes(passed=2)


def test_marker_sets_up_the_bus(run, pytester):
    pytester.path.joinpath("axis.yaml").write_text("motors:\n  1:\n    stops: {low: -50, high: 800}\n", encoding="utf-8")
    result = run("""
pytestmark = pytest.mark.rkm04(framing="plain", units=9)

@pytest.mark.rkm04(units=3, plant="axis.yaml")
def test_it(rkm04_bus):
    assert [unit.name for unit in rkm04_bus.units] == ["3"]
    assert rkm04_bus.unit(3).motor(1).true_position == 0
    rkm04_bus.host.write(bytes.fromhex("03000101"))
    assert rkm04_bus.host.wait_byte("50ms") and rkm04_bus.host.read(1) == b"\\x03"
""")
    result.assert_outcomes(passed=1)


def test_marker_with_an_unknown_argument(run):
    result = run("""
@pytest.mark.rkm04(unit=3)
def test_it(rkm04_bus):
    pass
""")
    assert result.ret != 0
    result.stdout.fnmatch_lines("*marker rkm04: unknown argument 'unit': expected one of units, plant, framing*")


def test_a_failure_shows_dialogue_units_faults_and_recording(run, pytester):
    result = run("""
def test_it(rkm04_bus):
    rkm04_bus.faults.inject("no_answer", count=1, skip=1)
    rkm04_bus.unit(1).motor(1).set("V1000 F100 R W5000")
    rkm04_bus.wait(motor=1, position=50)
    assert False
""", "--rkm04-trace", "traces")
    result.assert_outcomes(failed=1)
    result.stdout.re_match_lines([
        r"-+ rkm04: dialogue -+",
        r' +\d+ +\d+  host > 1 +2 Set Command m1 "V1000 F100 R W5000" \| 7E 01 00 02 31 .* 7E',
        r" +\d+ +\d+  1 > host +2 Set Command m1 -> flag 0 \| 7E 00 01 02 31 00 00 .* 7E",
        r"-+ rkm04: units -+",
        r"unit 1 at \d+ us: on; inputs on: none; outputs on: none",
        r"  motor 1: moving in R \(command 3\) at 50.*",
        r"-+ rkm04: injected faults -+",
        r"fault 1: no_answer: armed, has acted 0 times",
        r"-+ rkm04: recording -+",
        r"traces[/\\]test_it.py-test_it.record",
        r"repeat it: rkm04 replay --wire bus.log --trace run.vcd traces[/\\]test_it.py-test_it.record",
    ])
    assert pytester.path.joinpath("traces/test_it.py-test_it.record").read_text(encoding="utf-8").startswith('{"rkm04_record":1')
    program = Path(rkm04.__file__).parent / "bin" / "rkm04"
    command = [f"{program}{_system.PROGRAM_SUFFIX}", "replay", "--wire", "bus.log", "traces/test_it.py-test_it.record"]
    subprocess.run(command, cwd=pytester.path, check=True, timeout=60, env={**os.environ, "LD_PRELOAD": ""})
    assert '2 Set Command m1 "V1000 F100 R W5000"' in pytester.path.joinpath("bus.log").read_text(encoding="utf-8")
    assert "$timescale" in pytester.path.joinpath("traces/test_it.py-test_it.vcd").read_text(encoding="utf-8")


def test_a_recording_on_another_drive_is_shown_with_its_whole_path(run, monkeypatch, pytester):
    """As on Windows, where there is no way from drive to drive."""
    def relpath(path, start=None):
        raise ValueError("path is on mount 'C:', start on mount 'Z:'")

    monkeypatch.setattr("rkm04._report.os", SimpleNamespace(path=SimpleNamespace(relpath=relpath)))
    result = run("""
def test_it(rkm04_bus):
    assert False
""", "--rkm04-trace", "traces")
    result.assert_outcomes(failed=1)
    assert str(pytester.path.joinpath("traces", "test_it.py-test_it.record")) in result.stdout.str()


def test_a_fault_that_has_never_acted_fails_the_test(run):
    result = run("""
def test_idle(rkm04_bus):
    rkm04_bus.faults.inject("no_answer", count=1)

def test_acts(rkm04_bus):
    rkm04_bus.faults.inject("no_answer", count=1)
    with pytest.raises(rkm04.NoAnswerError):
        rkm04_bus.exchange(1, rkm04.request("Version"))

def test_idle_on_a_url():
    with serial.serial_for_url("rkm04://?node=1") as port:
        port.bus.faults.inject("drop", skip=5)
""")
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(["*injected fault 1 (no_answer) has never acted*", "*injected fault 1 (drop) has never acted*"])


def test_buses_of_urls_end_with_the_test(run):
    result = run("""
@pytest.mark.parametrize("n", [1, 2])
def test_it(n):
    with serial.serial_for_url("rkm04://?node=1") as port:
        assert port.bus.now == 0
        port.bus.advance(1000)
""")
    result.assert_outcomes(passed=2)


def test_real_time_comes_back_after_the_test(run):
    result = run("""
def test_virtual(rkm04_time):
    assert type(time.sleep).__name__ == "function"

def test_real():
    assert type(time.sleep).__name__ == "builtin_function_or_method"
""")
    result.assert_outcomes(passed=2)


def test_comparisons_of_the_dialogue_are_explained(run):
    result = run("""
def test_count(rkm04_bus):
    rkm04_bus.unit(1).motor(1).set("F100 R")
    rkm04_bus.exchange(1, rkm04.request("Version"))
    assert rkm04_bus.dialogue.count("Set Command", motor=1) == 2

def test_list(rkm04_bus):
    rkm04_bus.exchange(1, rkm04.request("Version"))
    assert rkm04_bus.dialogue == ["1 Version | 1 Version -> \\"another\\""]

def test_sent(rkm04_bus):
    rkm04_bus.unit(1).motor(1).set("F100 R")
    assert rkm04_bus.dialogue.sent("Set Command", motor=1, text="F1000 R")
""")
    result.assert_outcomes(failed=3)
    result.stdout.fnmatch_lines([
        "*assert 1 == 2: exchanges with 'Set Command', motor=1, of 2 in all",
        'E*2 Set Command m1 "F100 R" | 7E*',
        "*the dialogue is another one*",
        '*- 1 Version | 1 Version -> "another"*',
        "*+ 1 Version | 1 Version -> *01.02,06.03.2009*",
        "*no exchange with 'Set Command', motor=1, text='F1000 R'; the last of 1: 2 Set Command m1 \"F100 R\"*",
    ])


def test_a_dialogue_is_a_list_of_words(run):
    result = run("""
def test_it(rkm04_bus):
    rkm04_bus.unit(1).motor(1).set("F100 R")
    assert rkm04_bus.dialogue == ['2 Set Command m1 "F100 R" | 2 Set Command m1 -> flag 0']
    assert rkm04_bus.dialogue.count("Set Command") == 1
""")
    result.assert_outcomes(passed=1)


@pytest.mark.skipif(not importlib.util.find_spec("pytest_asyncio"), reason="needs pytest-asyncio")
def test_with_pytest_asyncio(run):
    seconds = 5 if sys.platform == "win32" else 600  # there pyserial-asyncio asks the port each 0.5 ms
    result = run(f"""
import asyncio, serial_asyncio

@pytest.mark.asyncio
async def test_it(rkm04_bus, rkm04_port, rkm04_time):
    reader, writer = await serial_asyncio.open_serial_connection(url=rkm04_port, baudrate=19200)
    writer.write(bytes.fromhex("7E010001998D7E"))
    assert len(await asyncio.wait_for(reader.readexactly(24), 1)) == 24
    await asyncio.sleep({seconds})
    assert rkm04_bus.now > {seconds} * 1_000_000
    writer.close()
""")
    result.assert_outcomes(passed=1)


@pytest.mark.skipif(not importlib.util.find_spec("xdist"), reason="needs pytest-xdist")
def test_with_pytest_xdist(pytester):
    pytester.makepyfile(test_it=HEAD + f"""
@pytest.mark.parametrize("n", range(8))
def test_it(rkm04_bus, rkm04_port, rkm04_time, n):
    with serial.serial_for_url(rkm04_port, baudrate=19200, timeout=1) as port:
        {REQUEST}
        time.sleep(60)
""")
    result = pytester.runpytest_subprocess("-n", "2", "-p", "no:cacheprovider")
    result.assert_outcomes(passed=8)


@pytest.mark.parametrize("transport", [PTY, "rfc2217", "tcp"])
def test_the_same_test_runs_over_a_running_emulator(run, pytester, transport):
    result = run("""
@pytest.mark.rkm04(units="2", clock="max")
def test_it(rkm04_bus, rkm04_port, rkm04_time):
    assert rkm04_time is None and not rkm04_port.startswith("rkm04:")
    with serial.serial_for_url(rkm04_port, baudrate=19200, timeout=10) as port:
        port.write(bytes.fromhex("7E020001FD627E"))
        assert len(port.read(24)) == 24
    assert rkm04_bus.dialogue.sent("Version", node=2)
    assert False
""", f"--rkm04-transport={transport}", "--rkm04-trace", "traces")
    result.assert_outcomes(failed=1)
    result.stdout.re_match_lines([
        r" +\d+ +\d+  host > 2 +1 Version \| 7E 02 00 01 .. .. 7E",
        r"unit 2 at \d+ us: on; .*",
        r"traces[/\\]test_it.py-test_it.record",
    ])
    assert "$timescale" in pytester.path.joinpath("traces/test_it.py-test_it.vcd").read_text(encoding="utf-8")


def test_a_pty_is_refused_where_there_are_none(run, monkeypatch):
    monkeypatch.setattr(_system, "HAS_PTYS", False)
    result = run("def test_it(rkm04_port): pass", "--rkm04-transport=pty")
    assert result.ret != 0
    result.stderr.fnmatch_lines("*no ptys on Windows: expected inprocess, rfc2217 or tcp")


def test_a_failure_in_a_fixture_shows_the_dialogue_too(run):
    result = run("""
@pytest.fixture
def position(rkm04_bus):
    rkm04_bus.unit(1).motor(1).set("F10 R")
    assert False

def test_it(position):
    pass
""")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines('*host > 1 * 2 Set Command m1 "F10 R" | 7E*')


def test_a_program_that_is_not_python(run):
    result = run("""
import subprocess
from rkm04._programs import find_program

def test_it(rkm04_serve):
    port = rkm04_serve.link or "tcp:" + rkm04_serve.ready["tcp"]
    subprocess.run([find_program("rkmctl"), "-p", port, "-m", "3", "set", "=42"], check=True, timeout=60)
    assert rkm04_serve.unit(1).motor(3).wait(position=42, limit="5s")
    rkm04_serve.faults.inject("no_answer", count=1)
""")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines("*injected fault 1 (no_answer) has never acted*")


def test_help_names_the_options(pytester):
    result = pytester.runpytest_inprocess("--help")
    text = " ".join(result.stdout.str().split())
    assert "--rkm04-transport={inprocess,pty,rfc2217,tcp}" in text
    assert "--rkm04-trace=DIR" in text and "--rkm04-shard=I/N" in text
    assert re.search(r"@pytest.mark.rkm04\(units, plant", pytester.runpytest_inprocess("--markers").stdout.str())
