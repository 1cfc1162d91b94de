# SPDX-License-Identifier: MIT
"""A bus behind the control socket of a running emulator."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import rkm04


@pytest.fixture(scope="module")
def bus():
    with rkm04.serve(units="1,2", clock="stepped") as bus:
        yield bus


@pytest.fixture(scope="module")
def tcp_bus():
    with rkm04.serve(units="1,2", clock="stepped", arguments=["--control", "tcp:0"]) as bus:
        yield bus


@pytest.fixture(params=["in process", "served", "over TCP"])
def either(request, bus, tcp_bus):
    bus = tcp_bus if request.param == "over TCP" else bus
    if request.param == "in process":
        with rkm04.Bus(units="1,2", timed=False) as own:
            yield own
    else:
        for unit in bus.units:
            unit.reset()
        bus.faults.clear()
        yield bus


def test_the_same_test_runs_against_either(either):
    motor = either.unit(2).motor(1)
    before = either.now
    motor.set("S100 V1000 A2000 F100 R T03")
    assert motor.program == "S100 V1000 A2000 F100 R T03"
    motor.wait(state="idle", limit="5s")
    assert motor.position == 100 and either.unit(2).do[3] == 1
    assert 300_000 < either.now - before < 500_000
    with pytest.raises(rkm04.ProgramError, match="unknown command 'Q'"):
        motor.set("Q")
    either.unit(1).di[5] = 1
    assert either.unit(1).di[5] == 1 and either.unit(2).di[5] == 0
    with pytest.raises(rkm04.WaitError, match=r"motor 1 position == 5 \(is 100\)"):
        either.wait(unit=2, motor=1, position=5, limit="1s")


def test_dialogue_and_events_of_either(either):
    either.dialogue.clear()
    with either.events("motion", unit=1) as motions:
        either.unit(1).motor(4).set("F10 R")
        either.wait(unit=1, motor=4, position=10)
    assert [event["value"] for event in motions][0] == 1
    assert either.dialogue.sent("Set Command", motor=4, text="F10 R", node=1)[0].answer.flag == 0


def test_faults_of_either(either):
    fault = either.faults.inject("no_answer", count=1)
    with pytest.raises(rkm04.NoAnswerError, match="expected an answer of node 1 to 1 Version"):
        either.exchange(1, rkm04.request("Version"), "10ms")
    assert fault.acted == 1
    assert either.exchange(1, rkm04.request("Version")).text.startswith("01.02")


def test_snapshot_of_either(either):
    either.unit(1).motor(1).set("F100 R")
    either.advance("50ms")
    position = either.unit(1).motor(1).position
    either.snapshot("under way")
    either.advance("1s")
    either.restore("under way")
    assert either.unit(1).motor(1).position == position < 100


def test_connect(bus):
    with rkm04.connect(bus.ready["control"]) as other:
        assert other.link == bus.link
        assert [unit.name for unit in other.units] == ["1", "2"]
        assert other.clock == "stepped"
    assert bus.unit(1).power  # who leaves does not end it


def test_nothing_there_says_so(tmp_path):
    with pytest.raises(rkm04.Error, match="expected the control socket of a running rkm04 serve at .*nothing"):
        rkm04.connect(tmp_path / "nothing")


def test_connect_with_a_control_file(tcp_bus, tmp_path):
    file = tcp_bus.ready["control"]
    with rkm04.connect(file) as other:
        assert other.unit(2).motor(1).position == tcp_bus.unit(2).motor(1).position
        assert other.link == tcp_bus.link
    with open(file, encoding="ascii") as content:
        address, token = content.read().split()
    for text, found in [(f"{address} {token[:-1]}x", "token: wrong"), (f"{address}", "another file"), ("", "another file"),
                        (f"tcp:127.0.0.1:1 {token}", "refused"), ("diary of a user", "another file")]:
        (tmp_path / "wrong").write_text(text, encoding="ascii")
        with pytest.raises(rkm04.Error, match=found):
            rkm04.connect(tmp_path / "wrong")


WITHOUT_EXTENSION = """
import socket, sys
import serial  # which takes what the system has
sys.modules["termios"] = None
del socket.AF_UNIX
import rkm04
with rkm04.connect(sys.argv[1]) as bus:
    bus.unit(1).di[4] = 1
    before = bus.now
    bus.advance("1.5ms")
    print(bus.now - before, bus.unit(1).di[4], bus.unit(2).motor(1).position)
    try:
        bus.exchange(1, rkm04.request("Version"))
    except rkm04.Error as error:
        print(error)
try:
    rkm04.Bus()
except rkm04.Error as error:
    print(error)
"""


def test_without_the_extension_an_emulator_is_reached(tcp_bus, tmp_path):
    """As on Windows: neither termios nor Unix sockets."""
    package = tmp_path / "rkm04"
    package.mkdir()
    for file in pathlib.Path(rkm04.__file__).parent.glob("*.py"):
        shutil.copy(file, package)
    shutil.copy(tcp_bus.ready["control"], tmp_path / "there.control")  # no link beside it
    (tmp_path / "run.py").write_text(WITHOUT_EXTENSION, encoding="utf-8")
    done = subprocess.run([sys.executable, tmp_path / "run.py", tmp_path / "there.control"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(tmp_path)}, timeout=60, check=False)
    said = done.stdout.splitlines()
    assert done.returncode == 0 and said[0] == f"1500 1 {tcp_bus.unit(2).motor(1).position}", done
    assert said[1].startswith("frames need the extension") or said[1].startswith("to send and hear bytes"), said
    assert said[2].startswith("a bus in this process needs the extension"), said


@pytest.mark.parametrize("text, us", [("250us", 250), ("20ms", 20_000), ("1.5s", 1_500_000), ("2min", None),
                                      ("1000000000s", 10 ** 15), ("1000000001s", None),
                                      ("0.000001s", 1), ("1.000s", 1_000_000), ("0.0005ms", None), ("5", None), ("-1s", None),
                                      ("1h", None), ("", None), ("1.s", None), (".5s", None), ("1e3us", None), ("5 ms", None)])
def test_times_are_read_alike_without_the_extension(text, us):
    from rkm04 import _sim

    spec = importlib.util.spec_from_file_location("pure", pathlib.Path(rkm04.__file__).parent / "_sim.py")
    pure = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pure)
    for module in (_sim, pure):
        if us is None:
            with pytest.raises(ValueError):
                module.time(text)
        else:
            assert module.time(text) == us


def test_a_long_path(tmp_path):
    folder = tmp_path / ("x" * 120)
    folder.mkdir()
    with rkm04.serve(arguments=["--control", str(folder / "control")]) as bus, rkm04.connect(folder / "control") as other:
        assert other.now <= bus.now
        with pytest.raises(rkm04.Error, match="expected the link of the bus"):
            other.exchange(1, rkm04.request("Version"))


def test_wrong_options_say_what_rkm04_says():
    with pytest.raises(rkm04.Error, match="expected READY.*framing"):
        rkm04.serve(framing="token-ring")


def test_an_emulator_that_has_ended_says_so():
    with rkm04.serve() as bus:
        bus.call("shutdown")
        with pytest.raises(rkm04.Error, match="expected an answer"):
            while bus.now >= 0:
                pass


def test_it_ends_with_the_block():
    with rkm04.serve() as bus:
        process, link = bus._process.process, bus.link
        assert os.path.exists(link) and process.poll() is None
    assert process.poll() is not None and not os.path.exists(os.path.dirname(link))


def test_a_clock_that_runs_by_itself():
    with rkm04.serve(clock="x20") as bus:
        bus.exchange(1, rkm04.request("Set Command", 1, "F1000 R"), limit="600s")
        bus.wait(motor=1, state="idle", limit="600s")
        assert bus.unit(1).motor(1).position == 1000
        before = bus.now
        assert bus.advance("1s") >= before + 1_000_000
