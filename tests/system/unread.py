# SPDX-License-Identifier: MIT
"""unread.py: `rkm04 serve` whose log or READY line is not read. The units answer all the same, and SIGTERM ends it.

    RKM04=… RKMCTL=… unread.py CASE | --list"""
import json
import os
import pty
import re
import socket
import subprocess
import sys
import tempfile
import termios
import threading

from control_client import Client, soon

LIMIT = 60  # seconds until something counts as never coming


def full_pipe():
    """A pipe in which there is no room: (end for reading, end for writing)."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    for size in (4096, 1):
        try:
            while True:
                os.write(writing, b"." * size)
        except BlockingIOError:
            pass
    os.set_blocking(writing, True)
    return reading, writing


def read_all(descriptor):
    """What comes until the last writer is gone."""
    text = b""
    while True:
        more = os.read(descriptor, 1 << 16)
        if not more:
            return text.decode()
        text += more


class Emulator:
    processes = []

    def __init__(self, *options, stdout=None, stderr=None, **more):
        self.folder = tempfile.TemporaryDirectory()
        self.link = os.path.join(self.folder.name, "bus")
        self.control = self.link + ".control"
        link = self.link + "%l" if "--lines" in options else self.link
        command = [os.environ["RKM04"], "serve", "--link", link, "--control", self.control, *options]
        out, err = (open(os.path.join(self.folder.name, name), "wb") for name in ("out", "err"))
        with out, err:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out if stdout is None else stdout,
                                            stderr=err if stderr is None else stderr, **more)
            self.processes.append(self.process)

    def text(self, name):
        with open(os.path.join(self.folder.name, name), encoding="utf-8") as file:
            return file.read()

    def ready(self):
        soon("READY", lambda: self.text("out").startswith("READY ") or self.process.poll() is not None)
        assert self.process.poll() is None, self.text("err")

    def answers(self, link=None):
        """A unit answers on the bus, and so does the control socket."""
        link = link or self.link
        soon("link and control socket", lambda: self.process.poll() is not None or
             os.path.exists(link) and os.path.exists(self.control))
        assert self.process.poll() is None, self.text("err")
        for command in (["-p", link, "version"], ["-c", self.control, "state"]):
            subprocess.run([os.environ["RKMCTL"], *command], check=True, timeout=LIMIT, stdout=subprocess.DEVNULL)

    def end(self):
        self.process.terminate()
        status = self.process.wait(timeout=LIMIT)
        assert status == 0, f"exit status {status}: {self.text('err')}"
        self.folder.cleanup()


def a_log_that_nobody_reads_stops_nothing():
    _, writing = full_pipe()
    emulator = Emulator(stderr=writing)
    emulator.ready()
    emulator.answers()
    emulator.end()


def many_buses_are_ready_though_nobody_reads_their_log():
    _, writing = full_pipe()
    emulator = Emulator("--lines", "100", "--node", "1-8", stderr=writing)
    emulator.ready()
    emulator.answers(emulator.link + "99")
    emulator.end()


def a_stopped_terminal_stops_nothing():
    master, slave = pty.openpty()
    emulator = Emulator(stderr=slave)
    emulator.ready()
    termios.tcflow(slave, termios.TCOOFF)  # as Ctrl-S does
    for _ in range(3):
        emulator.answers()
    emulator.end()
    os.close(master)
    os.close(slave)


def what_the_log_drops_is_counted():
    """Every line that was due is there, or counted where it is missing."""
    count = 60000
    reading, writing = full_pipe()
    emulator = Emulator(stderr=writing)
    os.close(writing)
    emulator.ready()
    client = Client(emulator.control)
    request = json.dumps({"jsonrpc": "2.0", "method": "clock", "params": {"clock": "x1.125"}}).encode() + b"\n"
    for _ in range(count // 1000):
        client.send(request * 1000)
        client.call("units")
    client.close()
    emulator.process.terminate()
    text = read_all(reading).lstrip(".")
    assert emulator.process.wait(timeout=LIMIT) == 0
    there = len(re.findall(r"^\[.*\] clock x1\.125$", text, re.M))
    notes = re.findall(r"^rkm04 serve: (\d+) lines of the log were dropped", text, re.M)
    assert 0 < there < count, f"{there} lines in {len(text)} bytes"
    assert notes, text[-2000:]
    assert there + sum(map(int, notes)) >= count, (there, notes)
    assert re.fullmatch(r"(\[[^\n]*\n|rkm04 serve: [^\n]*\n)*", text), "a line is not whole"


def READY_that_nobody_reads_stops_nothing():
    _, writing = full_pipe()
    emulator = Emulator(stdout=writing)
    emulator.answers()
    emulator.end()
    _, writing = full_pipe()
    emulator = Emulator("--ready-fd", str(writing), pass_fds=[writing])
    emulator.answers()
    emulator.end()


def READY_is_one_write():
    """A socket for datagrams keeps apart what is written apart."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    for end in (ours, theirs):
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 19)
    ours.settimeout(LIMIT)
    emulator = Emulator("--lines", "100", "--node", "1-8", stdout=theirs.fileno())
    text = ours.recv(1 << 20).decode()
    assert text.startswith("READY {") and text.endswith("}\n"), text[-100:]
    assert len(json.loads(text[6:])["lines"]) == 100
    emulator.end()
    ours.setblocking(False)
    try:
        assert False, ours.recv(100)
    except BlockingIOError:
        pass


def a_reader_of_READY_that_has_gone_is_no_failure():
    reading, writing = os.pipe()
    os.close(reading)
    for options in ({"stdout": writing}, {"pass_fds": [writing]}):
        emulator = Emulator(*(("--ready-fd", str(writing)) if "pass_fds" in options else ()), **options)
        emulator.answers()
        emulator.end()


def the_log_has_its_lines_in_order_and_whole():
    """A pipe that is read gets all of them."""
    reading, writing = os.pipe()
    emulator = Emulator("--lines", "100", "--node", "1-8", stderr=writing)
    os.close(writing)
    said = []
    reader = threading.Thread(target=lambda: said.append(read_all(reading)), daemon=True)
    reader.start()
    emulator.ready()
    emulator.process.terminate()
    reader.join(LIMIT)
    lines = said[0].splitlines()
    assert emulator.process.wait(timeout=LIMIT) == 0
    assert [line for line in lines if "units 1, 2" in line][99].split("line ")[1].startswith("99:"), lines[99]
    assert not [line for line in lines if "dropped:" in line]
    assert "SIGTERM" in "".join(lines[-101:]), lines[-3:]


CASES = [name for name, case in list(globals().items())
         if callable(case) and getattr(case, "__module__", "") == __name__ and name not in ("Emulator", "full_pipe", "read_all")]

if __name__ == "__main__":
    if sys.argv[1] == "--list":
        print("\n".join(CASES))
    else:
        try:
            globals()[sys.argv[1]]()
        finally:
            for process in Emulator.processes:
                process.kill()
