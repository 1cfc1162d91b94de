# SPDX-License-Identifier: MIT
"""What requests, polling, tests with fixtures and explorations cost; one JSON object a line.

    PYTHONPATH=build/release/python python3 python/bench/bench_port.py

Compares a request over rkm04:// with one over a pty of `rkm04 serve`, and with pyvisa-sim and lewis where they are installed
(pip install pyvisa pyvisa-sim lewis). Times are real; `cpu` is the processor time of this process.
"""
from __future__ import annotations

import json
import os
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Callable, Iterator

import serial

import rkm04

ROOT = Path(__file__).parents[2]
VERSION = bytes.fromhex("7E010001998D7E")
ANSWER = 24
sys.path.insert(0, str(ROOT / "examples" / "python"))


def report(name: str, **figures: Any) -> None:
    """Print a result."""
    print(json.dumps({"bench": name, **figures}), flush=True)


def measure(name: str, call: Callable[[], Any], number: int) -> None:
    """Report what a call costs: median of real time, mean of processor time."""
    for _ in range(min(number, 20)):
        call()
    times = []
    cpu = time.process_time()
    for _ in range(number):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    cpu = time.process_time() - cpu
    report(name, us=round(statistics.median(times) * 1e6, 1), cpu_us=round(cpu / number * 1e6, 1), number=number)


def ask(port: serial.SerialBase) -> None:
    """A version request and its answer."""
    port.write(VERSION)
    if len(port.read(ANSWER)) != ANSWER:
        raise RuntimeError("no answer")


def bench_inprocess() -> None:
    """A request over rkm04://."""
    with rkm04.Bus(journal=False) as bus:
        url = rkm04.publish(bus)
        with serial.serial_for_url(url, baudrate=19200, timeout=1) as port:
            measure("request over rkm04://", lambda: ask(port), 5000)
        rkm04.unpublish(url)


def bench_pty(clock: str, number: int) -> None:
    """A request over the pty of an `rkm04 serve`."""
    program = Path(rkm04.__file__).parent / "bin" / "rkm04"
    with tempfile.TemporaryDirectory() as folder:
        link = f"{folder}/bus"
        server = subprocess.Popen([str(program), "serve", "--clock", clock, "--link", link], stdout=subprocess.PIPE,
                                  stderr=subprocess.DEVNULL)
        try:
            assert server.stdout is not None and server.stdout.readline().startswith(b"READY")
            with serial.Serial(link, 19200, timeout=5) as port:
                measure(f"request over a pty, --clock {clock}", lambda: ask(port), number)
        finally:
            server.terminate()
            server.wait()


def bench_pyvisa_sim() -> None:
    """A query of pyvisa-sim's default device."""
    try:
        import pyvisa
        import pyvisa_sim  # noqa: F401
    except ImportError:
        return report("query of pyvisa-sim", skipped="pyvisa-sim is not installed")
    manager = pyvisa.ResourceManager("@sim")
    device: Any = manager.open_resource("ASRL1::INSTR", read_termination="\n", write_termination="\r\n")
    measure("query of pyvisa-sim", lambda: device.query("?IDN"), 1000)
    manager.close()


def free_port() -> int:
    """A TCP port that is free now."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def connect(port: int) -> Iterator[socket.socket]:
    """Try to connect for a while."""
    end = time.monotonic() + 20
    while time.monotonic() < end:
        try:
            yield socket.create_connection(("127.0.0.1", port), 5)
            return
        except OSError:
            time.sleep(0.1)


def bench_lewis() -> None:
    """A request to lewis's example motor over TCP."""
    program = shutil.which("lewis", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
    if program is None:
        return report("request to lewis", skipped="lewis is not installed")
    port = free_port()
    server = subprocess.Popen([program, "-k", "lewis.examples", "example_motor", "-c", "0", "-p",
                               f"stream: {{bind_address: 127.0.0.1, port: {port}}}"], stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL)
    try:
        for line in connect(port):
            def query() -> None:
                line.sendall(b"P?\r\n")
                while not line.recv(100).endswith(b"\n"):
                    pass

            measure("request to lewis over TCP", query, 200)
            line.close()
            return None
        report("request to lewis", skipped="it does not listen")
    finally:
        server.terminate()
        server.wait()


def bench_five_minutes() -> None:
    """A motion of five minutes, polled five times a second by the library of examples/python."""
    from rkm_host import Axis, Unit

    def poll() -> None:
        with rkm04.Bus() as bus, rkm04.virtual_time(bus), Unit(rkm04.publish(bus, "bench")) as unit:
            unit.set_command(1, "S100 V100")
            Axis(unit, motor=1, speed=100).move_by(30000)
        rkm04.unpublish("bench")

    measure("five minutes, polled", poll, 10)


def bench_pytest() -> None:
    """Tests with the fixtures, and an exploration of a test with ten exchanges."""
    head = "import pytest, rkm04, serial\n"
    body = f"""    with serial.serial_for_url(rkm04_port, baudrate=19200, timeout=0.1) as port:
        for _ in range(10):
            port.write(bytes.fromhex("{VERSION.hex()}"))
            port.read({ANSWER})
"""
    texts = {"one": f"{head}@pytest.mark.parametrize('n', range(COUNT))\n"
                    f"def test_it(rkm04_bus, rkm04_port, rkm04_time, n):\n{body}",
             "explored": f"{head}@rkm04.explore(faults=['lost byte', 'flipped bit'], at='each byte', budget=COUNT)\n"
                         f"def test_it(rkm04_bus, rkm04_port, rkm04_time):\n{body}"}
    for name, text in texts.items():
        times = []
        for count in (1, 601):
            with tempfile.TemporaryDirectory() as folder:
                Path(folder, "test_it.py").write_text(text.replace("COUNT", str(count)))
                begin = os.times()
                subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", folder], check=True, cwd=folder,
                               stdout=subprocess.DEVNULL)
                end = os.times()
                times.append((end.elapsed - begin.elapsed, end.children_user + end.children_system - begin.children_user
                              - begin.children_system))
        real, cpu = (times[1][0] - times[0][0]) / 600, (times[1][1] - times[0][1]) / 600
        if name == "one":
            report("test with fixtures and ten exchanges", ms=round(real * 1e3, 2), cpu_ms=round(cpu * 1e3, 2))
        else:
            report("exploration of ten exchanges", runs_per_s=round(1 / real), runs_per_cpu_s=round(1 / cpu))


def main() -> None:
    """All of it."""
    bench_inprocess()
    bench_pty("max", 1000)
    bench_pty("real", 100)
    bench_pyvisa_sim()
    bench_lewis()
    bench_five_minutes()
    bench_pytest()


if __name__ == "__main__":
    main()
