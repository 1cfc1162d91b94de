# SPDX-License-Identifier: MIT
"""stm32.py: the firmware for the STM32F405 with trace.c in it, under QEMU: its bus, its inputs, its power, and what it did with
its pins, from QEMU's log. Its time is that of its processor, 8 ns an instruction, however busy the machine is."""
import os
import re
import select
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "conformance"))

from link import Hdlc  # noqa: E402

INIT, ADVANCE, BYTE, RECEIVE, INPUTS, SEND, PLAY, CUT, NOW, IDLE, INTERRUPTS, WORST = range(12)
WRITE = re.compile(rb"(\w+): unimplemented device write \(size 4, offset 0x(\w+), value 0x(\w+)\)")
LIMIT = 60  # seconds of ours in which QEMU has to do anything at all


class Gone(Exception):
    """QEMU has ended, or does nothing."""


class Power:
    """What happened from one power-up to the next: `calls` as lines for replay.c; `pins` as (name, number) -> [(tick, value)]."""

    def __init__(self):
        self.calls, self.pins, self.now = [], {}, 0


class Board:
    """Its time stands but in run() and the like. An instruction takes 2 ^ shift ns."""

    def __init__(self, elf, shift=3):
        self.folder = tempfile.TemporaryDirectory()
        self.powers, self.bytes, self.rest, self.outputs, self.elapsed = [], bytearray(), b"", 0, 0
        self.figures = {}
        self.heard, self.got, self.inputs, self.cut = b"", 0, None, None  # bytes offered to the unit; what the hand has done
        words = ["-monitor", f"unix:{self.name('monitor')},server=on,wait=off"]
        for name in ("bus", "hand"):
            words += ["-serial", f"unix:{self.name(name)},server=on,wait=off"]
        self.process = subprocess.Popen(
            ["qemu-system-arm", "-M", "netduinoplus2", "-kernel", elf, "-display", "none", "-d", "unimp,guest_errors", "-D",
             self.name("log"), "-icount", f"shift={shift},sleep=off", "-S", *words], stdin=subprocess.DEVNULL)
        self.monitor, self.bus, self.hand = map(self.connect, ("monitor", "bus", "hand"))
        self.log = open(self.name("log"), "rb")  # exists: QEMU opens it before its sockets
        try:
            self.heard_from_monitor()
            self.start(lambda: self.powers)
        except Gone:
            self.close()
            raise

    def name(self, name):
        return os.path.join(self.folder.name, name)

    def connect(self, name):
        end = time.monotonic() + LIMIT
        while True:
            port = socket.socket(socket.AF_UNIX)
            try:
                port.connect(self.name(name))
                return port
            except OSError:
                port.close()
                if self.process.poll() is not None or time.monotonic() > end:
                    raise Gone(f"QEMU has no socket {name}") from None
                time.sleep(0.01)

    def heard_from_monitor(self):
        heard = b""
        while not heard.endswith(b"\n(qemu) "):
            self.hear_bus()
            if select.select([self.monitor, self.bus], [], [], LIMIT)[0] == []:
                raise Gone("QEMU does not answer any more")
            if select.select([self.monitor], [], [], 0)[0]:
                heard += self.monitor.recv(4096) or b"\n(qemu) "

    def hear_bus(self):
        """QEMU waits, and does nothing else, when some 300 bytes wait here."""
        if select.select([self.bus], [], [], 0)[0]:
            self.heard += self.bus.recv(65536)

    def command(self, text):
        """Of the monitor."""
        self.monitor.sendall(text.encode() + b"\n")
        self.heard_from_monitor()

    # ---- What it did ----

    def look(self):
        """Read what is new on the bus and in the log."""
        self.hear_bus()
        data = self.rest + self.log.read()
        whole = data.rfind(b"\n") + 1
        self.rest = data[whole:]
        for device, offset, value in WRITE.findall(data[:whole]):
            self.take(device, int(offset, 16), int(value, 16))

    def take(self, device, offset, value):
        if device == b"DCMI":
            self.took(offset // 4, value)
        elif offset == 0x18 and device == b"GPIOA" and value not in (1 << 15, 1 << 31):
            number = next(bit for bit in range(32) if value >> bit & 1)
            self.pin(("step", "direction")[number % 16 // 4], number % 4 + 1, 0 if number > 15 else 1)
        elif offset == 0x18 and device == b"GPIOB" and value & 0xff00ff00:
            self.outputs = value >> 8 & 0xff
            self.pin("outputs", 0, self.outputs)

    def pin(self, name, number, value):
        power = self.powers[-1]
        power.pins.setdefault((name, number), []).append((power.now, value))

    def took(self, what, value):
        if what == INIT:
            self.elapsed += self.powers[-1].now if self.powers else 0
            self.powers.append(Power())
        if not self.powers:
            raise Gone("the firmware plays pulses before there is a unit")
        power = self.powers[-1]
        if what == BYTE:
            self.got += 1
            self.bytes.append(value)
        elif what == CUT:
            self.cut = value
        elif what >= NOW:
            self.figures[what] = value
        elif what == PLAY:
            power.now = value
        elif what == RECEIVE:
            power.calls.append(f"r {self.bytes.hex()}")
            self.bytes.clear()
        else:
            self.inputs = value if what == INPUTS else self.inputs
            power.calls.append(f"{ {INIT: 'i', ADVANCE: 'a', INPUTS: 'd', SEND: 's'}[what]} {value}")

    def now(self):
        """Microseconds that it has been on."""
        return self.elapsed + self.powers[-1].now

    # ---- What is done to it ----

    def start(self, holds):
        """Let its time go on until holds() is true after a look at the log."""
        self.command("cont")
        last, end = None, 0
        while not (self.look() or holds()):
            if last != (last := self.powers and self.now()):
                end = time.monotonic() + LIMIT
            if self.process.poll() is not None or time.monotonic() > end:
                raise Gone("QEMU does nothing any more")
            time.sleep(0.0005)
        self.command("stop")
        self.look()

    def run(self, microseconds):
        """Not less, and as much more as it does until we see it."""
        end = self.now() + microseconds
        self.start(lambda: self.now() >= end)

    def send(self, data):
        """Bytes on the bus; they have come to the unit when it returns."""
        before = self.got
        self.bus.sendall(data)
        self.start(lambda: self.got >= before + len(data))

    def hear(self):
        """What it has sent."""
        heard, self.heard = self.heard, b""
        return heard

    def set_inputs(self, mask):
        self.hand.sendall(b"i" + bytes([mask]))
        self.start(lambda: self.inputs == mask)

    def cut_power_in(self, operation):
        """In the middle of the operation of the flash with this number, 1 for the next one."""
        self.hand.sendall(b"c" + bytes([operation]))
        self.start(lambda: self.cut == operation)

    def count(self):
        """{ NOW, IDLE, INTERRUPTS, WORST: ns }, the last one of the longest interrupt."""
        self.figures = {}
        self.hand.sendall(b"f\0")
        self.start(lambda: NOW in self.figures)
        return self.figures

    def power(self):
        """Off and on again; the flash stays."""
        count = len(self.powers)
        self.command("system_reset")
        self.start(lambda: len(self.powers) > count)

    def ask(self, message, node=1):
        """The answer to a message; None: silence for a second."""
        self.send(Hdlc.frame(node, message))
        heard, end = self.hear(), self.now() + 1_000_000
        while Hdlc.take(heard, node) is None and self.now() < end:
            self.run(1000)
            heard += self.hear()
        return Hdlc.take(heard, node)

    def close(self):
        self.process.kill()
        self.process.wait()
        self.folder.cleanup()
