# SPDX-License-Identifier: MIT
"""Stories: what a unit receives, and when. A line each:

    readings NAME=VALUE,...   what is not the default (section 10); first, may be missing
    input TICK MASK           inputs from this tick on, bit 0 is DI 01
    send TICK MOTOR TEXT      Set Command; %XX is a byte
    ask TICK NUMBER MOTOR     message 3 to 7 (3: Store Flash, into a unit without flash)
    end TICK
"""

import re
from dataclasses import dataclass, field

from readings import Readings


@dataclass
class Input:
    tick: int
    mask: int

    def line(self):
        return f"input {self.tick} {self.mask}"

    def told(self):
        return f"i {self.tick} {self.mask}"


@dataclass
class Send:
    tick: int
    motor: int
    commands: list = field(default_factory=list)  # pieces of text (bytes), sent one after the other

    def line(self):
        text = b" ".join(self.commands)
        return f"send {self.tick} {self.motor} " + "".join(
            chr(b) if 0x20 <= b < 0x7F and b != 0x25 else f"%{b:02X}" for b in text)

    def data(self):
        return b"\x02%d" % self.motor + b" ".join(self.commands)

    def told(self):
        return f"m {self.tick} {self.data().hex()}"


@dataclass
class Ask:
    tick: int
    number: int
    motor: int

    def line(self):
        return f"ask {self.tick} {self.number} {self.motor}"

    def data(self):
        return bytes([self.number]) + b"%d" % self.motor

    def told(self):
        return f"m {self.tick} {self.data().hex()}"


@dataclass
class Story:
    readings: Readings
    actions: list
    end: int

    def lines(self):
        others = self.readings.others()
        head = [f"readings {','.join(others)}"] if others else []
        return head + [action.line() for action in self.actions] + [f"end {self.end}"]

    def told(self):
        """The same for the program `subject`."""
        numbers = " ".join(map(str, self.readings.numbers()))
        lines = [f"q {numbers}"] + [action.told() for action in self.actions] + [f"e {self.end}"]
        return "".join(line + "\n" for line in lines).encode()


def unescape(text):
    return re.sub(rb"%([0-9A-F]{2})", lambda m: bytes([int(m[1], 16)]), text.encode("latin-1"))


def read(text):
    story = Story(Readings(), [], 0)
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word in ("", "#"):
            continue
        if word == "send":
            tick, motor, program = (rest + " ").split(" ", 2)
            story.actions.append(Send(int(tick), int(motor), [unescape(program.rstrip("\n")).strip()]))
        elif word in ("input", "ask"):
            numbers = [int(n) for n in rest.split()]
            story.actions.append(Input(*numbers) if word == "input" else Ask(*numbers))
        elif word == "readings":
            story.readings.read(rest)
        elif word == "end":
            story.end = int(rest)
        else:
            raise ValueError(f"expected readings, input, send, ask or end, got {word!r}")
    return story
