# SPDX-License-Identifier: MIT
"""Exploration: a test is run again with faults at every place."""

import io
import re
import xml.etree.ElementTree as ElementTree

import pytest
import serial

import rkm04
from helpers import VERSION, VERSION_ANSWER
from rkm04 import _system
from rkm04._explore import KINDS, Facts, Fault, Options, Passed, Progress, format_faults, parse_faults, places, plan

MOVE_TWICE = '''
import rkm04, serial

@rkm04.explore(faults=["no answer", "lost byte"], budget=100)
def test_it(rkm04_bus, rkm04_port, rkm04_time):
    frame = bytes.fromhex("{frame}")
    with serial.serial_for_url(rkm04_port, baudrate=19200, timeout=0.1) as port:
        port.write(frame)
        if len(port.read(10)) < 10:
            port.write(frame)
    rkm04_bus.wait(motor=1, state="idle", limit="5s")
    assert rkm04_bus.unit(1).motor(1).position in (0, 10)
'''


@pytest.fixture
def twice(pytester):
    with rkm04.Bus() as bus:
        bus.unit(1).motor(1).set("F10 R")
        frame = bus.dialogue[0].events[0]["bytes"]
    pytester.makepyfile(test_it=MOVE_TWICE.format(frame=frame))
    return pytester


def test_a_retry_after_a_lost_answer_executes_a_program_twice(twice):
    result = twice.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=1)
    result.stdout.re_match_lines([
        r"-+ rkm04: dialogue -+",
        r"-+ rkm04: exploration -+",
        r"3 runs with faults \(of 3 possible\): 2 failed",
        r"smallest set of faults under which the test fails: 1",
        r"  - answer 1 \(2 Set Command m1 -> flag 0\) is not sent",
        r"fails with: .*20.*",
        "  " + re.escape(_system.command_with("RKM04_REPLAY", "no_answer skip=0 count=1", "pytest test_it.py::test_it")),
        r"it also fails with:",
        r"  - byte 6 of 10 of answer 1 .* is lost",
    ])


def test_the_line_repeats_exactly_this_run(twice, monkeypatch):
    monkeypatch.setenv("RKM04_REPLAY", "no_answer skip=0 count=1")
    result = twice.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=1)
    assert "rkm04: exploration" not in result.stdout.str()
    result.stdout.fnmatch_lines("*fault 1: no_answer: spent, has acted 1 times")
    monkeypatch.setenv("RKM04_REPLAY", "none")
    twice.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=1)


def test_shards_share_the_runs_and_their_reports_can_be_put_together(twice):
    runs = []
    for part in (1, 2, 3):
        report = twice.path / f"part{part}.xml"
        twice.runpytest_inprocess("-p", "no:cacheprovider", "--rkm04-shard", f"{part}/3", f"--junitxml={report}")
        case = ElementTree.parse(report).getroot().find(".//testcase")
        assert case.get("name") == f"test_it[part {part} of 3]"
        runs.append(int(case.find(".//property[@name='rkm04_runs']").get("value")))
    assert runs == [1, 1, 1]


@pytest.mark.parametrize("shard", ["0/3", "4/3", "3", "x/y"])
def test_a_wrong_shard_is_refused(pytester, shard):
    result = pytester.runpytest_inprocess("--rkm04-shard", shard)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(f"*--rkm04-shard {shard}: expected I/N with 1 <= I <= N, as in 3/16")


def test_explored_tests_can_be_chosen(twice):
    twice.makepyfile(test_other="def test_other():\n    pass\n")
    result = twice.runpytest_inprocess("-p", "no:cacheprovider", "--strict-markers", "-m", "rkm04_explored", "--collect-only",
                                       "-q")
    assert [line for line in result.outlines if "::" in line] == ["test_it.py::test_it"]


def test_a_wrong_replay_line_is_refused(twice, monkeypatch):
    monkeypatch.setenv("RKM04_REPLAY", "no_answer skip")
    result = twice.runpytest_inprocess("-p", "no:cacheprovider")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines("*RKM04_REPLAY: 'skip': expected NAME=VALUE*")


def test_workers_of_xdist_share_the_runs(twice):
    pytest.importorskip("xdist")
    result = twice.runpytest_subprocess("-n", "2", "-p", "no:cacheprovider")
    outcomes = result.parseoutcomes()
    assert outcomes.get("failed") == 2 and outcomes.get("passed") == 6
    result.stdout.fnmatch_lines("*RKM04_REPLAY='*' pytest test_it.py::test_it")


def test_a_test_that_fails_without_faults_is_not_explored(pytester):
    pytester.makepyfile("import rkm04\n@rkm04.explore()\ndef test_it(rkm04_bus):\n    assert False\n")
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=1)
    assert "rkm04: exploration" not in result.stdout.str()


def test_all_fixtures_are_fresh_in_each_run(pytester):
    pytester.makepyfile("""
import pytest, rkm04
made = []

@pytest.fixture
def mine(rkm04_bus):
    made.append("up")
    yield rkm04_bus.exchange(1, rkm04.request("Version"))
    made.append("down")

@rkm04.explore(faults=["late answer"], late="1ms")
def test_it(mine, rkm04_bus):
    assert mine.number == 1 and rkm04_bus.now < 100_000

def test_after():
    assert made == ["up", "down"] * 2
""")
    pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=2)


# ---- The function ----


def exchange(bus):
    """A test that copes with no lost byte."""
    with serial.serial_for_url(rkm04.publish(bus, "explored"), baudrate=19200, timeout=0.1) as port:
        port.write(VERSION)
        answer = port.read(24)
    rkm04.unpublish("explored")
    assert answer == VERSION_ANSWER


def test_as_a_function():
    with pytest.raises(rkm04.ExplorationFailed, match="smallest set of faults .*: 1") as failed:
        rkm04.explore(exchange, faults=["lost byte"], at="each byte")
    result = failed.value.exploration
    assert result.runs == result.total == 7 + 24
    assert len(result.failures) == 31
    assert rkm04.explore(exchange, faults=["late answer"], late="10ms").runs == 1


def test_a_function_that_fails_without_faults_raises_its_own_error():
    def fails(bus):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        rkm04.explore(fails)


def test_a_run_that_waits_in_vain_fails():
    def move(bus):
        url = rkm04.publish(bus, "explored")
        try:
            with serial.serial_for_url(url, baudrate=19200, timeout=1) as port:
                port.write(VERSION)
                answer = b""
                while len(answer) < 24:
                    answer += port.read(1)
        finally:
            rkm04.unpublish("explored")

    with pytest.raises(rkm04.ExplorationFailed, match=r"fails with: TimeLimitError: .* before 60 s"):
        rkm04.explore(move, faults=["no answer"], limit="60s")


def test_pairs_find_what_needs_two_faults():
    def retries_once(bus):
        for _ in range(2):
            try:
                bus.exchange(1, rkm04.request("Version"), "50ms")
                return
            except rkm04.NoAnswerError:
                pass
        raise AssertionError("no answer")

    def poll(bus):
        for _ in range(3):
            retries_once(bus)

    assert rkm04.explore(poll, faults=["no answer"]).runs == 3
    with pytest.raises(rkm04.ExplorationFailed) as failed:
        rkm04.explore(poll, faults=["no answer"], pairs=True)
    assert len(failed.value.exploration.failures[0].faults) == 2


def test_power_cycle_and_flash():
    def store(bus):
        motor = bus.unit(1).motor(1)
        url = rkm04.publish(bus, "explored")
        try:
            with serial.serial_for_url(url, baudrate=19200, timeout=0.1) as port:
                motor.set("W5")
                assert bus.unit(1).exchange(rkm04.request("Store Flash", 1)).flag == 0
                port.read(1)
                assert motor.program == "W5"
        finally:
            rkm04.unpublish("explored")

    def failures(*faults, **more):
        try:
            rkm04.explore(store, faults=faults, **more)
        except rkm04.ExplorationFailed as failed:
            return [str(run.faults[0]) for run in failed.exploration.failures]
        return []

    assert any(text.startswith("flash operation=write skip=0") for text in failures("flash fails"))
    assert failures("power fails in store")
    assert failures("power cycle") == []  # the program is in flash by then, or is sent later


def test_an_input_that_flickers():
    def wait_for_input(bus):
        bus.unit(1).motor(1).set("O03 F10 R")
        bus.advance("1s")
        assert bus.unit(1).motor(1).position == 0

    with pytest.raises(rkm04.ExplorationFailed) as failed:
        rkm04.explore(wait_for_input, faults=["input flickers"], inputs=[2, 3])
    assert {run.faults[0].values["input"] for run in failed.value.exploration.failures} == {3}


def test_a_power_cycle_comes_while_the_program_waits():
    def move(bus):
        url = rkm04.publish(bus, "explored")
        try:
            with serial.serial_for_url(url, baudrate=19200, timeout=1) as port:
                port.write(VERSION)
                port.read(24)
                bus.unit(1).motor(1).set("F50 R")
                port.read(1)
            assert bus.unit(1).motor(1).position == 50
        finally:
            rkm04.unpublish("explored")

    with pytest.raises(rkm04.ExplorationFailed) as failed:
        rkm04.explore(move, faults=["power cycle"])
    assert re.search(r"the power fails after answer 2 \(2 Set Command m1 -> flag 0\)", str(failed.value))


def test_a_terminal_shows_how_far_it_is(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)
    terminal = Terminal()
    progress = Progress("test_it", terminal)
    progress.show(12, 48, 1)
    assert terminal.getvalue() == "\rtest_it: [######                  ] 12/48 runs, 1 failed "
    progress.end()
    assert terminal.getvalue().endswith("\r\033[K")
    silent = io.StringIO()
    Progress("test_it", silent).show(12, 48, 1)
    assert silent.getvalue() == ""


# ---- Places ----


FACTS = Facts([Passed(0, 100, 7, True, "request 1"), Passed(200, 300, 24, False, "answer 1"),
               Passed(400, 500, 9, True, "request 2"), Passed(600, 700, 10, False, "answer 2")], 5000)


def test_places_at_each_byte_and_each_message():
    by_byte = places(Options(faults=["lost byte"], at="each byte"), [FACTS])
    assert [each.values["skip"] for each in by_byte if each.values["direction"] == "to_units"] == list(range(16))
    assert [each.values["skip"] for each in by_byte if each.values["direction"] == "to_master"] == list(range(34))
    by_message = places(Options(faults=["lost byte"]), [FACTS])
    assert [(each.values["direction"], each.values["skip"]) for each in by_message] == [
        ("to_units", 3), ("to_units", 7 + 4), ("to_master", 12), ("to_master", 24 + 5)]
    slots = places(Options(faults=["input flickers"], at="each slot", inputs=[2]), [FACTS])
    assert sorted({each.values["after"] for each in slots}) == [1000, 2000, 3000, 4000]


def test_a_budget_thins_out_evenly():
    options = Options(faults=["lost byte", "flipped bit"], at="each byte", budget=10)
    runs, total = plan(options, [FACTS])
    assert len(runs) == 10 and total == 100
    assert runs == plan(options, [FACTS])[0]
    pairs, _ = plan(Options(faults=["lost byte"], at="each byte", budget=200, pairs=True), [FACTS])
    assert len(pairs) == 200 and {len(run) for run in pairs} == {1, 2}


def test_faults_of_ones_own():
    found = places(Options(faults=[{"kind": "cut", "bytes": 3}]), [FACTS])
    assert [str(each) for each in found] == ["cut skip=0 count=1 bytes=3", "cut skip=1 count=1 bytes=3"]


def test_the_replay_line_is_read_back():
    faults = [Fault("drop", (("direction", "to_units"), ("skip", 3), ("count", 1))), Fault("reset", (("at", 100),), bus=1)]
    assert parse_faults(format_faults(faults)) == faults
    assert parse_faults("none") == parse_faults("") == []
    with pytest.raises(ValueError, match="'skip': expected NAME=VALUE"):
        parse_faults("drop skip")


@pytest.mark.parametrize("options, message", [
    ({"faults": ["lost bite"]}, "'lost bite': expected one of lost byte"),
    ({"at": "everywhere"}, "expected one of each message"),
    ({"budget": 0}, "expected at least 1 run"),
    ({"faults": ["input flickers"]}, "expected the inputs that flicker"),
    ({"faults": "lost byte"}, r"expected a list of kinds, as in \['lost byte'\]"),
    ({"faults": [{"kind": "nope"}]}, "faults: kind: expected one of drop"),
    ({"faults": [{"direction": "to_units"}]}, "faults: .*direction.*: expected a kind"),
    ({"late": "soon"}, "late: expected a time"),
    ({"limit": "soon"}, "limit: expected a time"),
])
def test_wrong_options_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        rkm04.explore(**options)


def test_every_kind_is_described():
    for kind in KINDS:
        assert f'"{kind}"' in rkm04.explore.__doc__
