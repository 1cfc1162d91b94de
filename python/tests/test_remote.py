# SPDX-License-Identifier: MIT
"""A bus behind the control socket of a running emulator."""

import importlib.util
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

import pytest
import serial

import rkm04
from helpers import VERSION, VERSION_ANSWER
from rkm04 import _windows
from rkm04._programs import find_program


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
    with rkm04.connect(bus.ready["control"], link=None if bus.link else bus.port) as other:
        assert (other.link, other.port) == (bus.link, bus.port)
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
if hasattr(socket, "AF_UNIX"):
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
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run([sys.executable, tmp_path / "run.py", tmp_path / "there.control"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": path}, timeout=60, check=False)
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


@pytest.mark.skipif(sys.platform == "win32", reason="Windows' Python has no Unix sockets")
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


@pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows")
def test_an_emulator_that_was_asked_to_end_has_ended(tmp_path):
    command = [find_program("rkm04"), "serve", "--lines", "100", "--link", tmp_path / "bus%l", "--control", tmp_path / "control"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:  # many buses take their time
        assert process.stdout.readline().startswith(b"READY ")
        rkm04.connect(tmp_path / "control").call("shutdown")
        assert os.listdir(tmp_path) == []


def until_answered(request):
    """(number of tries, answer): of an emulator that may be too late on a busy machine."""
    for tries in range(1, 100):
        try:
            return tries, request()
        except rkm04.Error:
            pass
    raise AssertionError("no answer in time, of a hundred")


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="Windows stops no process")
def test_an_emulator_that_is_stopped_is_waited_for_within_the_timeout(stoppable):
    control, process = stoppable
    none = pytest.raises(rkm04.Error, match=r"within 0.3 s of real time, found none")
    with until_answered(lambda: rkm04.connect(control, timeout=0.3))[1] as bus:
        process.send_signal(signal.SIGSTOP)
        for request in [lambda: bus.call("advance", ticks=1_000_000), lambda: bus.now,
                        lambda: rkm04.connect(control, timeout=0.3)]:
            with none:
                request()
        process.send_signal(signal.SIGCONT)
        tries, now = until_answered(lambda: bus.advance("1s"))
        assert now == (1 + tries) * 1_000_000  # late answers are not taken for those of later requests
        process.send_signal(signal.SIGSTOP)
        with none:
            bus.plant.set("\n" * 900_000)
        process.send_signal(signal.SIGCONT)
        with pytest.raises(rkm04.Error, match="expected an answer"):
            bus.advance("1s")


@pytest.fixture
def stoppable():
    with rkm04.serve(clock="stepped") as bus:
        yield bus._process.ready["control"], bus._process.process
        bus._process.process.send_signal(signal.SIGCONT)


@pytest.mark.parametrize("timeout", [0, -1.0, float("nan")])
def test_a_timeout_that_is_none_is_refused(timeout):
    with pytest.raises(ValueError, match="timeout: expected s of real time above 0"):
        rkm04.serve(timeout=timeout)


def test_it_ends_with_the_block():
    with rkm04.serve() as bus:
        process, folder = bus._process.process, bus._process.folder
        assert os.path.exists(folder) and process.poll() is None
    assert process.poll() is not None and not os.path.exists(folder)


def test_its_files_are_whole_at_the_end(tmp_path):
    with rkm04.serve(record=tmp_path / "x.record", arguments=["--allow-folder", str(tmp_path), "--clock", "stepped"]) as bus:
        bus.trace(str(tmp_path / "x.csv"))
        bus.exchange(1, rkm04.request("Set Command", 1, "F10 R"))
        bus.wait(motor=1, state="idle")
    assert (tmp_path / "x.csv").read_text(encoding="utf-8").count("step,") >= 10
    assert '"end"' in (tmp_path / "x.record").read_text(encoding="utf-8").splitlines()[-1]


def test_a_clock_that_runs_by_itself():
    with rkm04.serve(clock="x20") as bus:
        bus.exchange(1, rkm04.request("Set Command", 1, "F1000 R"), limit="600s")
        bus.wait(motor=1, state="idle", limit="600s")
        assert bus.unit(1).motor(1).position == 1000
        before = bus.now
        assert bus.advance("1s") >= before + 1_000_000


# ---- Over TCP, as on Windows -------------------------------------------------------------------------------------------------


def test_pyserial_opens_what_serve_names():
    with rkm04.serve(clock="max") as bus:
        assert bus.tcp_url.startswith("socket://127.0.0.1:") and bus.port in (bus.link, bus.tcp_url)
        for url in (bus.port, bus.tcp_url, bus.rfc2217_url):
            with serial.serial_for_url(url, baudrate=19200, timeout=30) as port:
                port.write(VERSION)
                assert port.read(24) == VERSION_ANSWER


@pytest.fixture
def over_tcp():
    with rkm04.serve(clock="stepped") as bus, rkm04.connect(bus.ready["control"], link=bus.tcp_url) as other:
        yield other


def test_exchanges_over_tcp_leave_the_port_to_the_program(over_tcp):
    version = rkm04.request("Version")
    for _ in range(3):
        assert over_tcp.exchange(1, version).text.startswith("01.02")
        host, _, port = over_tcp.port[len("socket://"):].rpartition(":")
        with socket.create_connection((host, int(port))) as program:
            program.sendall(VERSION)
            while not over_tcp.dialogue.count("Version") % 2 == 0:
                over_tcp.advance("10ms")
            with pytest.raises(rkm04.Error, match="another client has it"):
                over_tcp.exchange(1, version)


def test_exchanges_over_tcp_follow_each_other_at_once(over_tcp):
    times = []
    for _ in range(20):
        begin = time.monotonic()
        over_tcp.exchange(1, rkm04.request("Version"))
        times.append(time.monotonic() - begin)
    # not the second for which the emulator keeps a client that has closed its side; a busy machine may make some of them late
    assert sorted(times)[5] < 0.9, times


def test_what_tcp_does_not_carry_is_refused(over_tcp):
    for call in (lambda: over_tcp.host.configure(baudrate=9600), lambda: over_tcp.host.write(b"x", parity="E"),
                 lambda: over_tcp.host.send_break(), lambda: over_tcp.host.read_ticks()):
        with pytest.raises(rkm04.Error, match="a TCP connection"):
            call()
    with pytest.raises(rkm04.Error, match="expected a link socket://HOST:PORT"):
        rkm04.connect(over_tcp._transport._path, link="socket://here").host
    with pytest.raises(rkm04.Error, match="expected the TCP port of the bus at 127.0.0.1:1, found"):
        rkm04.connect(over_tcp._transport._path, link="socket://127.0.0.1:1").send(1, b"\1")


# ---- The half for Windows, wherever this runs --------------------------------------------------------------------------------


def test_arguments_for_windows():
    own = ["--control", "tcp:0", "--control-file", os.path.join("folder", "control")]
    assert _windows.serve_arguments("folder", ["--late", "skip"]) == own + ["--late", "skip"]
    assert _windows.serve_arguments("folder", ["--control=tcp:4", "-v"]) == ["--control=tcp:4", "-v"]
    assert _windows.serve_arguments("folder", ["--allow-folder", "a", "-v", "--allow-folder=b"]) == own + ["-v"]
    assert _windows.link_in("folder") is None
    with pytest.raises(rkm04.Error, match="no ptys on Windows, found COM5"):
        _windows.open_link(None, "COM5")


def test_a_program_in_place_of_this_one_on_windows():
    with pytest.raises(SystemExit) as end:
        _windows.run_in_place(sys.executable, ["python", "-c", "import sys; sys.exit(7)"])
    assert end.value.code == 7


def test_an_emulator_on_windows_is_asked_to_end_and_terminated_if_it_cannot_be_asked():
    def cannot():
        raise rkm04.Error("no answer")

    asked = []
    sleeper = [sys.executable, "-c", "import time; time.sleep(60)"]
    with subprocess.Popen(sleeper) as process:
        _windows.end_process(process, lambda: asked.append(1))
        assert asked and process.poll() is None
        _windows.end_process(process, cannot)
        assert process.wait(30) != 0
        _windows.end_process(process, lambda: pytest.fail("it has ended"))


def test_commands_are_quoted_as_a_prompt_takes_them():
    assert _windows.quote("traces\\it.record") == "traces\\it.record" and _windows.quote("a b") == '"a b"'
    assert _windows.command_with("RKM04_REPLAY", "drop skip=1", "pytest it.py::it") == \
        'cmd /c "set RKM04_REPLAY=drop skip=1&& pytest it.py::it"'
