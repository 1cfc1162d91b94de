#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""soak_serve.py: hours of a real `rkm04 serve` in accelerated time, under everything that hosts, tests and hands do to it.

    RKM04=… soak_serve.py [--hours HOURS] [--speed N] [--seed SEED] [--quiet]

Clients of the pty, of TCP and of the control socket come, flood, say nonsense, do not read, and go, some in the middle of
something; faults, plants, traces, snapshots and clocks are switched on and off. Between rounds everything is put back: then every
unit has to answer rightly, its counters have to add up, and files and memory have to be what they were. Says how far it is on
stderr and writes a line of JSON to stdout. Exit status: 0 all is well, 1 something is not, 2 usage."""
import argparse
import json
import os
import random
import resource
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time
import tty

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system"))
from control_client import Client, Refused  # noqa: E402

UNITS = 16
PATIENCE = 60  # s until something counts as never coming
ROUND_MIN, ROUND_MAX = 10000000, 3600000000  # ticks
# Freed memory goes back to the system at once: glibc would keep as much as the longest queue of a client took, twice.
HONEST_MEMORY = {"ASAN_OPTIONS": "quarantine_size_mb=1", "MALLOC_MMAP_THRESHOLD_": "131072", "MALLOC_TRIM_THRESHOLD_": "131072"}
RESIDENT_SLACK = 16 << 20  # bytes: as the journal for snapshots to files may hold
PLAIN = ["drop", "flip", "duplicate", "insert", "no_answer", "wrong_fcs", "echo"]  # faults that need no parameter
PROGRAMS = [b"\\S50 V900 A3000 F90 R B40 R", b"V3000 F300 R", b"L5 T03 W2 C03 W3 E", b"G-", b"K", b"C75", b"V700", b"[F10 R",
            b"] R",
            b"M01 F200 R U", b"(01 C100 F30 R", b"\\", b"T41 F500 R", b"@1 F2 R D J1", b"X02 G+", b"T40", b"W5 Y F20 Y B50 Y R"]
PLANT = {"units": {"3": {"motors": {"1": {"offset": 20, "stops": {"low": -5, "high": 400}}},
                         "switches": [{"input": 1, "motor": 1, "at_most": 0, "bounce": "30ms"}]}}}


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return crc ^ 0xFFFF


def frame(node, message):
    body = bytes([node, 0]) + message
    body += crc16(body).to_bytes(2, "little")
    for byte in (b"\x7d", b"\x7e"):
        body = body.replace(byte, bytes([0x7D, byte[0] ^ 0x20]))
    return b"\x7e" + body + b"\x7e"


def unframe(data):
    """The message of one frame; None: it is none."""
    body, escaped = bytearray(), False
    for byte in data:
        if byte == 0x7D:
            escaped = True
        else:
            body.append(byte ^ 0x20 if escaped else byte)
            escaped = False
    if len(body) < 5 or crc16(body[:-2]) != int.from_bytes(body[-2:], "little"):
        return None
    return bytes(body[:-2])


class Wrong(Exception):
    """Something is not as it has to be."""


class Line:
    """A host on the pty, over TCP or by RFC 2217."""

    def __init__(self, soak, way="pty"):
        self.way = way
        if way == "pty":
            self.fd = os.open(soak.link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
            tty.setraw(self.fd, termios.TCSANOW)
            self.socket = None
        else:
            self.socket = socket.create_connection(("127.0.0.1", soak.port[way]), timeout=PATIENCE)
            self.socket.setblocking(False)
            self.fd = self.socket.fileno()

    def write(self, data):
        """As much as it takes now."""
        try:
            return os.write(self.fd, data)
        except OSError:
            return 0

    def read(self):
        try:
            return os.read(self.fd, 65536)
        except OSError:
            return b""

    def ask(self, node, message):
        """The answer of a unit, whole and checked."""
        gathered, end = b"", time.monotonic() + PATIENCE
        self.write(frame(node, message))
        while time.monotonic() < end:
            if not select.select([self.fd], [], [], 1)[0]:
                continue
            data = self.read()
            if not data:
                raise Wrong("the line was closed")
            gathered += data
            for part in gathered.split(b"\x7e")[:-1]:
                body = unframe(part)
                if body and body[0] == 0 and body[1] == node and body[2] == message[0]:
                    return body[2:]
        raise Wrong(f"unit {node} does not answer {message!r}; heard {gathered!r}")

    def close(self):
        if self.socket:
            self.socket.close()
        else:
            os.close(self.fd)


class Soak:
    def __init__(self, options):
        self.options = options
        self.dice = random.Random(options.seed)
        self.folder = tempfile.mkdtemp()
        self.link = os.path.join(self.folder, "bus")
        self.clock = f"x{options.speed}"
        self.errors = open(os.path.join(self.folder, "errors"), "w+b")
        self.acts = {}
        self.lines, self.clients, self.traces = [], [], []
        self.process = subprocess.Popen(
            [os.environ["RKM04"], "serve", "--node", "1-16", "--link", self.link, "--tcp", "127.0.0.1:0",
             "--rfc2217", "127.0.0.1:0", "--clock", self.clock, "--control", self.link + ".control",
             "--flash", os.path.join(self.folder, "unit%n.flash")],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=self.errors, text=True,
            env={**os.environ, **HONEST_MEMORY})
        ready = self.process.stdout.readline()
        if not ready.startswith("READY "):
            raise Wrong(f"not ready: {ready!r}")
        self.port = {way: int(json.loads(ready[6:])[way].rsplit(":", 1)[1]) for way in ("tcp", "rfc2217")}
        self.control = Client(self.link + ".control")
        for name in ("a", "b", "c", "begin"):
            self.control.call("snapshot", name=name)
        self.files_begin = self.files()

    # ---- What is looked at

    def now(self):
        return self.control.call("units")["t_us"]

    def files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def memory(self):
        with open(f"/proc/{self.process.pid}/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * resource.getpagesize()

    # ---- Acts

    def one_of(self, some):
        return self.dice.choice(some) if some else None

    def attach(self):
        if len(self.lines) < 8 and os.path.exists(self.link):
            try:
                self.lines.append(Line(self, self.dice.choice(["pty", "pty", "tcp", "rfc2217"])))
            except (OSError, termios.error):
                pass  # unplugged meanwhile

    def detach(self):
        line = self.one_of(self.lines)
        if line:
            line.close()
            self.lines.remove(line)

    def garbage(self):
        line = self.one_of(self.lines)
        if line:
            line.write(self.dice.randbytes(self.dice.randrange(1, 2000)))

    def flood(self):
        line = self.one_of(self.lines)
        request = frame(self.dice.randrange(0, 17), self.dice.choice([b"\x01", b"\x040", b"\x021V500", b"\x051"]))
        for _ in range(50):
            if not line or not line.write(request * 100):
                break

    def request(self):
        line = self.one_of(self.lines)
        if line:
            message = b"\x02" + self.dice.choice(b"01234").to_bytes(1, "big") + self.dice.choice(PROGRAMS)
            if self.dice.random() < 0.4:
                message = bytes([self.dice.randrange(1, 9), self.dice.randrange(48, 53)])
            data = frame(self.dice.randrange(0, 17), message)
            line.write(data if self.dice.random() < 0.9 else data[:len(data) // 2])

    def telnet(self):
        """Commands of RFC 2217, whole or not, known or not: settings, break, purge, suspend."""
        line = self.one_of([line for line in self.lines if line.way == "rfc2217"])
        if line:
            command = bytes([0xFF, 0xFA, 0x2C, self.dice.randrange(16)]) + self.dice.randbytes(self.dice.randrange(5))
            line.write(self.dice.choice([command + b"\xff\xf0"] * 6 + [command, b"\xff\xf3", b"\xff\xfd\x03"]) *
                       self.dice.choice([1, 1, 500]))

    def listen(self):
        for line in self.lines:
            if self.dice.random() < 0.7 and select.select([line.fd], [], [], 0)[0] and not line.read():
                line.close()  # hung up: unplugged
                self.lines.remove(line)
                break

    def try_call(self, method, **params):
        try:
            self.control.call(method, **params)
        except Refused:
            pass

    def fault(self):
        kind = self.dice.choice(PLAIN + ["delay", "cut", "break", "cable", "unplugged", "unplugged", "flash", "power", "input"])
        params = {"kind": kind, "for": f"{self.dice.randrange(1, 20)}s"}
        if kind in ("drop", "flip", "duplicate", "insert"):
            params["probability"] = self.dice.choice([0.001, 0.05])
        elif kind == "delay":
            params["delay"] = self.dice.randrange(1, 3000000)
        elif kind == "cut":
            params["bytes"] = self.dice.randrange(0, 9)
        elif kind in ("break", "cable", "unplugged"):
            params.update(duration="300ms", every="900ms")
        elif kind == "input":
            params.update(input=self.dice.randrange(1, 9), level=self.dice.randrange(0, 2))
        elif kind in ("flash", "power"):
            params["unit"] = self.dice.randrange(1, 17)
        self.try_call("fault.inject", **params)

    def client(self):
        """One of the control socket, that asks something reasonable or not."""
        if len(self.clients) > 20:
            return
        client = Client(self.link + ".control", receive_buffer=4096)
        client.socket.setblocking(False)
        says = [b"", b"{", b"nonsense\n", b'{"jsonrpc":"2.0","id":1,"method":"state","params":{"unit":3}}\n' * 50,
                b'{"jsonrpc":"2.0","id":1,"method":"subscribe"}\n', b'{"jsonrpc":"2.0","id":1,"method":"subscribe"}\n' * 3,
                b'{"jsonrpc":"2.0","id":1,"method":"wait","params":{"unit":2,"until":{"motor":1,"position":123456}}}\n',
                b'{"jsonrpc":"2.0","id":1,"method":"units"}', b"x" * 200000, b"[" * 5000 + b"\n"]
        try:
            client.send(self.dice.choice(says))
        except OSError:
            pass
        self.clients.append(client)

    def client_leaves(self):
        client = self.one_of(self.clients)
        if client:
            client.close()
            self.clients.remove(client)

    def trace(self):
        if len(self.traces) < 5:
            name = "trace" + self.dice.choice([".vcd", ".csv", ".jsonl", ".log", ".pcapng"])
            if not os.path.exists(os.path.join(self.folder, name)):
                self.traces.append((self.control.call("trace.start", file=name)["trace"], name))

    def trace_ends(self):
        trace = self.one_of(self.traces)
        if trace:
            self.traces.remove(trace)
            self.control.call("trace.stop", trace=trace[0])
            os.remove(os.path.join(self.folder, trace[1]))

    def hands(self):
        unit = self.dice.randrange(1, 17)
        what = self.dice.randrange(6)
        if what == 0:
            self.control.call("power", unit=unit, on=self.dice.random() < 0.7)
        elif what == 1:
            self.try_call("reset", unit=unit)
        elif what == 2:
            self.control.call("switch", unit=unit, node=self.dice.randrange(1, 17))
        elif what == 3:
            self.try_call("plant.set", plant=self.dice.choice([PLANT, None]))  # refused where the motor stands beyond its stops
        else:
            self.control.call("di.set", unit=unit, mask=self.dice.randrange(256))

    def snapshot(self):
        name = self.dice.choice("abc")
        if self.dice.random() < 0.5:
            self.try_call("snapshot", name=name)
        elif self.dice.random() < 0.8:
            self.try_call("restore", name=name)
        else:
            self.try_call("snapshot", file="snapshot.record")

    def clocks(self):
        kind = self.dice.choice(["max", "x3", "x200", "stepped"])
        self.control.call("clock", clock=kind)
        if kind == "stepped":
            self.control.call("advance", ticks=f"{self.dice.randrange(1, 5000)}ms")
        self.control.call("clock", clock=self.clock)

    # ---- Rounds

    def chaos(self, ticks):
        acts = ([self.attach] * 3 + [self.detach] * 2 + [self.garbage] * 2 + [self.flood] + [self.request] * 10 +
                [self.telnet] * 2 + [self.listen] * 8 + [self.fault] * 2 +
                [self.client] * 3 + [self.client_leaves] * 2 + [self.trace] + [self.trace_ends] * 2 +
                [self.hands] * 2 + [self.snapshot] + [self.clocks])
        end = self.now() + ticks
        while self.now() < end:
            act = self.dice.choice(acts)
            act()
            self.acts[act.__name__] = self.acts.get(act.__name__, 0) + 1
            if self.dice.random() < 0.2:
                time.sleep(self.dice.random() * 0.02)

    def put_back(self):
        """As at the beginning: no client is there but this one, and the units are as they were."""
        while self.lines:
            self.detach()
        while self.clients:
            self.client_leaves()
        while self.traces:
            self.trace_ends()
        self.control.call("fault.clear")
        self.control.call("clock", clock=self.clock)
        end = self.now() + 5000000  # what is under way passes, a pty that was away comes back
        while self.now() < end or not os.path.exists(self.link):
            time.sleep(0.01)
        passed, begin = None, time.monotonic()  # floods that stand in sockets and ptys take their time
        while passed != (passed := self.state(1)["line"]["bytes"]) or self.files() != self.files_begin:
            if time.monotonic() > begin + 5 * PATIENCE:
                raise Wrong(f"the line does not come to rest: {passed} bytes, {self.files()} files of {self.files_begin}")
            self.control.call("wait", until={"t": self.now() + 3000000})
        self.control.call("restore", name="begin")
        for name in "abc":  # they keep what had come in before them
            self.control.call("snapshot", name=name)
        self.control.events.clear()

    def soon(self, what, wanted, measure):
        end = time.monotonic() + PATIENCE
        while measure() != wanted:
            if time.monotonic() > end:
                raise Wrong(f"{what}: expected {wanted}, is {measure()}")
            time.sleep(0.02)

    def state(self, unit):
        return self.control.call("state", unit=unit)

    def check(self):
        """Units answer, execute and count."""
        if self.control.call("fault.list")["faults"]:
            raise Wrong("there are faults left")
        line = Line(self)
        motions = {}
        try:
            for unit in range(1, UNITS + 1):
                if line.ask(unit, b"\x01")[2:] != b"01.02,06.03.2009":
                    raise Wrong(f"unit {unit}: another version")
                steps = self.dice.randrange(1, 3000)
                answer = line.ask(unit, b"\x022\\C100 V16000 A60000 F%d R" % steps)
                if answer != b"\x022\x00\x00":
                    raise Wrong(f"unit {unit}: Set Command is answered with {answer!r}")
                motions[unit] = steps
            for unit, steps in motions.items():
                limit = self.control.call("wait", until={"unit": unit, "motor": 2, "idle": True}, limit="60s")
                answer = line.ask(unit, b"\x042")
                if not limit["holds"] or answer[3:] != b"%10d" % steps:
                    raise Wrong(f"unit {unit}: at {answer[3:]!r}, expected {steps}")
        finally:
            line.close()
        for unit in range(1, UNITS + 1):
            state = self.state(unit)
            counters, wanted = state["counters"], {"requests": 3, "answers": 3, "others": 6 * (UNITS - 1), "dropped": 0}
            if counters != wanted or not state["powered"] or state["node"] != unit:
                raise Wrong(f"unit {unit}: has counted {counters}, expected {wanted}")
        self.control.call("restore", name="begin")

    def live(self):
        ticks = int(self.options.hours * 3600e6)
        self.chaos(min(ticks // 4, 600000000))  # everything has been in use
        self.put_back()
        self.check()
        files, first, begin = self.files_begin, self.memory(), self.now()
        most, rounds, last = first, 0, first
        while self.now() < begin + ticks:
            rounds += 1
            self.chaos(min(max(ticks // 24, ROUND_MIN), ROUND_MAX))
            self.put_back()
            self.check()
            self.soon("open files", files, self.files)
            last = self.memory()
            most = max(most, last)
            self.say(f"{(self.now() - begin) / 3600e6:.2f} of {self.options.hours} h: {sum(self.acts.values())} acts, "
                     f"{files} files, {last / 1048576:.1f} MiB")
        result = {"virtual_hours": round((self.now() - begin) / 3600e6, 3), "seed": self.options.seed, "clock": self.clock,
                  "rounds": rounds, "acts": self.acts, "files_begin": files, "files_end": self.files(),
                  "resident_begin": first, "resident_end": last, "resident_most": most}
        if last > first + RESIDENT_SLACK and "SANITIZE" not in os.environ:
            raise Wrong(f"memory has grown from {first} to {last} bytes")
        return result

    def say(self, text):
        if not self.options.quiet:
            print(f"soak: {text}", file=sys.stderr, flush=True)

    def end(self):
        """It ends when asked to, leaves nothing, and has not complained."""
        self.control.call("shutdown")
        status = self.process.wait(timeout=PATIENCE)
        self.errors.seek(0)
        said = self.errors.read().decode(errors="replace")
        left = [name for name in ("bus", "bus.control") if os.path.lexists(os.path.join(self.folder, name))]
        if status != 0 or left or "Sanitizer" in said or "runtime error" in said:
            raise Wrong(f"exit status {status}, left {left}; it said:\n{said[-3000:]}")

    def clear(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
        self.errors.close()
        shutil.rmtree(self.folder)


def main():
    parser = argparse.ArgumentParser(description="Soak a real rkm04 serve in accelerated time.")
    parser.add_argument("--hours", type=float, default=4)
    parser.add_argument("--speed", type=int, default=60, help="times as fast as real; default 60")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quiet", action="store_true")
    options = parser.parse_args()
    begin = time.monotonic()
    soak = Soak(options)
    try:
        result = soak.live()
        soak.end()
    except (Wrong, Refused, AssertionError, OSError, termios.error) as wrong:
        soak.errors.flush()
        with open(soak.errors.name, encoding="utf-8", errors="replace") as said:
            print(f"soak: {wrong!r}\nsoak: again: --hours {options.hours} --speed {options.speed} --seed {options.seed}; "
                  f"rkm04 said:\n{said.read()[-3000:]}", file=sys.stderr)
        return 1
    finally:
        soak.clear()
    print(json.dumps({**result, "seconds": round(time.monotonic() - begin, 1), "well": True}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
