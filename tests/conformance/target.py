# SPDX-License-Identifier: MIT
"""target.py: what stands around the unit under test: its time, its inputs, its power; with a control socket or a hand."""
import json
import os
import shlex
import socket
import subprocess
import sys
import time

from link import Port, Unreachable


class Control:
    """A client of rkm04 serve's control socket (docs/CONTROL.md)."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.settimeout(60)
        try:
            self.socket.connect(path)
        except OSError as error:
            raise Unreachable(f"cannot connect to the control socket {path}: {error}") from None
        self.lines = self.socket.makefile("r", encoding="utf-8")
        self.last = 0
        self.events = []

    def call(self, method, **params):
        self.last += 1
        request = {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}
        try:
            self.socket.sendall(json.dumps(request).encode() + b"\n")
            for line in self.lines:
                said = json.loads(line)
                if said.get("id") == self.last:
                    if "error" in said:
                        raise Unreachable(f"{method}: {said['error']['message']}")
                    return said["result"]
                if said.get("method") == "event":
                    self.events.append(said["params"])
        except OSError as error:
            raise Unreachable(f"the control socket is gone: {error}") from None
        raise Unreachable("the control socket was closed")


class Real:
    """Time as it is, `speed` times as fast; inputs and power are in the hands of a person. A host may see things late by
    `latency` seconds: adapters, drivers, a busy machine."""
    exact = sees_outputs = False
    silence = 0.3  # seconds after which a unit that has to be silent has been

    def __init__(self, has, speed, latency):
        self.has, self.speed, self.latency = has, speed, latency
        self.start_us = self.now_us()

    def now_us(self):
        return time.monotonic_ns() // 1000 * self.speed

    def start(self):
        """Called just before the request is sent from which time is counted."""
        self.start_us = self.now_us()

    def since_start(self):
        return self.now_us() - self.start_us

    def pass_us(self, ticks):
        time.sleep(max(ticks, 0) / 1e6 / self.speed)

    def until_idle(self, motor, limit_us, is_idle):
        """Time since the start at which the motor is found idle; None: not within the limit."""
        end = self.now_us() + limit_us + self.latency_us()
        over = False
        while not is_idle(motor):
            if over:
                return None
            over = self.now_us() > end  # one more look: we may have been stopped for a while
            self.pass_us(5000 * self.speed)
        return self.since_start()

    def latency_us(self):
        return self.latency * 1e6 * self.speed

    @staticmethod
    def hand(what):
        print(f"\n>>> {what}, then press Enter: ", end="", file=sys.stderr, flush=True)
        if not sys.stdin.readline():
            raise Unreachable("standard input has ended, nobody is there to do it")

    def inputs(self, levels):
        self.hand("; ".join(f"set input {int(number):02} to {level}" for number, level in levels.items()))

    def rest(self):
        """Before each case."""

    def power(self):
        self.hand("switch the unit off and on again")

    def outputs(self):
        """Output 01, in bit 0."""
        while True:
            print("\n>>> is output DO 01 on? y or n, then Enter: ", end="", file=sys.stderr, flush=True)
            word = sys.stdin.readline()
            if not word:
                raise Unreachable("standard input has ended, nobody is there to look")
            if word.strip() in ("y", "n"):
                return 1 if word.strip() == "y" else 0

    @staticmethod
    def bytes_passed():
        return None

    def close(self):
        pass


class Stepped:
    """rkm04 serve with its control socket: time is stopped until it is advanced; bytes are transferred in no time."""
    exact = sees_outputs = True
    silence = 0.05
    has = {"inputs", "outputs", "time", "flash", "power"}

    def __init__(self, path, node):
        self.control = Control(path)
        self.clock = self.control.call("clock")["clock"]
        units = self.control.call("units")["units"]
        self.unit = next((unit for unit in units if unit.split("-")[0] == str(node)), None)
        if self.unit is None:
            raise Unreachable(f"there is no unit {node} on that line, but {', '.join(units)}")
        if self.clock != "stepped":
            self.control.call("clock", clock="stepped")
        self.control.call("subscribe", kinds=["motion", "outputs", "variables"], unit=self.unit)
        self.start_us = self.now_us()

    def state(self):
        return self.control.call("state", unit=self.unit)

    def now_us(self):
        return self.control.call("clock")["t_us"]

    def start(self):
        """Time is counted from a slot; the request arrives one tick behind it, so that the next slot, 1000, executes it."""
        state = self.state()
        begin = state["since_us"]
        behind = (state["t_us"] - begin - 1) % 1000
        if behind:
            self.pass_us(1000 - behind)
            state["t_us"] += 1000 - behind
        self.start_us = state["t_us"] - 1
        self.control.events.clear()

    def since_start(self):
        return self.now_us() - self.start_us

    def pass_us(self, ticks):
        if ticks > 0:
            self.control.call("advance", ticks=int(ticks))

    def until_idle(self, motor, limit_us, _is_idle):
        result = self.control.call("advance", until={"motor": motor, "idle": True, "unit": self.unit}, limit=int(limit_us))
        return result["t_us"] - 1 - self.start_us if result["holds"] else None

    @staticmethod
    def latency_us():
        return 0

    def inputs(self, levels):
        self.control.call("di.set", unit=self.unit, di=levels)

    def rest(self):
        self.control.call("di.set", unit=self.unit, mask=0)

    def power(self):
        self.control.call("reset", unit=self.unit)

    def outputs(self):
        return self.state()["do"]

    def bytes_passed(self):
        """How many bytes have been on the line; None: not known. Time comes another way here, and could overtake them."""
        return self.state()["line"]["bytes"]

    def events(self, kind, motor=None):
        """(time since the start, value) of each event of that kind."""
        return [(event["t_us"] - self.start_us, event["value"]) for event in self.control.events
                if event["kind"] == kind and event.get("motor") == motor]

    def close(self):
        if self.clock != "stepped":
            self.control.call("clock", clock=self.clock)


class Process:
    """A program that takes a request a line on its standard input, and answers with a line that begins with `='."""

    def __init__(self, words):
        self.mask, self.seen = 0, []
        try:
            self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        except (OSError, IndexError) as error:
            raise Unreachable(f"cannot run {shlex.join(words)}: {error}") from None

    def call(self, request):
        """The words of the answer."""
        try:
            self.process.stdin.write(request + "\n")
            self.process.stdin.flush()
            for line in self.process.stdout:
                word, *words = line.split() or [""]
                if word.startswith("="):
                    return [word[1:], *words] if word[1:] else words
                if word == "event":
                    self.seen.append((words[0], int(words[1]), int(words[2]), int(words[3])))
        except (OSError, ValueError) as error:
            raise Unreachable(f"the program is gone: {error}") from None
        raise Unreachable("the program has ended")

    def inputs(self, levels):
        for number, level in levels.items():
            bit = 1 << int(number) - 1
            self.mask = self.mask & ~bit | (bit if level else 0)
        self.call(f"inputs {self.mask}")

    def rest(self):
        self.mask = 0
        self.call("inputs 0")

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Board(Process, Real):
    """A program that is a board with its firmware, in time of its own, which is stopped until it is advanced: however busy
    the machine is, nothing comes late. Requests: `bytes HEX`, they go to the bus; `wait TICKS`, until the board sends something;
    `advance TICKS`; `inputs MASK`; `outputs`; `reset`, power off and on. Each is answered by `= TICK`, after `wait` with what was
    sent in hexadecimal, if anything was, after `outputs` with their mask."""
    sees_outputs = True
    ahead = 20_000  # us after which whatever happens in the unit has happened at the pins

    def __init__(self, command, latency):
        Process.__init__(self, shlex.split(command))
        self.tick, self.heard = 0, b""
        Real.__init__(self, {"inputs", "outputs", "power", "flash"}, 1, latency)
        self.pass_us(self.ahead)

    def call(self, request):
        tick, *words = super().call(request)
        self.tick = int(tick)
        return words

    # As a port

    def now(self):
        return self.tick / 1e6

    def wait(self, seconds):
        if not self.heard:
            self.heard = bytes.fromhex("".join(self.call(f"wait {int(seconds * 1e6)}")))
        return bool(self.heard)

    def write(self, data):
        self.call("bytes " + data.hex())

    def read(self):
        heard, self.heard = self.heard, b""
        return heard

    # As a target

    def now_us(self):
        return self.tick

    def pass_us(self, ticks):
        if ticks > 0:
            self.call(f"advance {int(ticks)}")

    def power(self):
        self.call("reset")
        self.pass_us(self.ahead)

    def outputs(self):
        self.pass_us(self.ahead)
        return int(self.call("outputs")[0])

    def close(self):
        super().close()
        if self.process.returncode != 0:
            raise Unreachable(f"the program ended with status {self.process.returncode}")


class InProcess(Process, Port):
    """A program with a unit in it and nothing around (in_process.c): its line, time, inputs and power in one. DNode 1."""
    exact = sees_outputs = True
    silence = 0
    has = Stepped.has

    def __init__(self, program, framing):
        super().__init__([program, framing])
        self.heard, self.line = os.pipe()  # what the unit says, so that one can wait for it as for a port
        self.start_us, self.tick = 0, 0

    # As a port

    def fileno(self):
        return self.heard

    def write(self, data):
        answer = self.call("bytes " + data.hex())
        if answer:
            os.write(self.line, bytes.fromhex(answer[0]))

    def read(self):
        return os.read(self.heard, 4096)

    # As a target

    def start(self):
        self.pass_us(-(self.tick - 1) % 1000)
        self.start_us = self.tick - 1
        self.seen.clear()

    def since_start(self):
        return self.tick - self.start_us

    def pass_us(self, ticks):
        if ticks > 0:
            self.tick = int(self.call(f"advance {int(ticks)}")[0])

    def until_idle(self, motor, limit_us, _is_idle):
        now, holds = self.call(f"idle {motor} {int(limit_us)}")
        self.tick = int(now)
        return self.tick - 1 - self.start_us if holds == "1" else None

    @staticmethod
    def latency_us():
        return 0

    def power(self):
        self.tick = int(self.call("reset")[0])

    def outputs(self):
        return int(self.call("outputs")[0])

    @staticmethod
    def bytes_passed():
        return None  # they have passed when write() returns

    def events(self, kind, motor=0):
        return [(tick - self.start_us, value) for name, number, tick, value in self.seen if (name, number) == (kind, motor)]
