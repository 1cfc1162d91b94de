# SPDX-License-Identifier: MIT
"""Runs a story on the core and on the reference, and finds the first difference."""

import subprocess
from array import array
from collections import Counter
from itertools import zip_longest

from story import Input
from unit import Unit


class Result:
    def __init__(self):
        self.answers = []                       # (tick, bytes)
        self.notes = {}                         # (motor, what) -> [(tick, value)]
        self.pulses = [[] for _ in range(5)]
        self.loose = None                       # places in `pulses` that R2 allows to be a tick off, of the reference only
        self.seen = Counter()                   # clauses met, of the reference only

    def add(self, tick, motor, what, value):
        notes = self.notes.setdefault((motor, what), [])
        if motor == 0 and notes and notes[-1][0] == tick:
            notes.pop()                         # outputs and variables: what stands at the end of a tick
        notes.append((tick, value))

    def size(self):
        return sum(map(len, self.notes.values())) + len(self.answers) + sum(map(len, self.pulses))


class Subject:
    """The core, in a process of its own that runs one story after the other."""

    def __init__(self, program):
        self.program = program
        self.start()

    def start(self):
        self.process = subprocess.Popen([self.program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, story):
        result = Result()
        ticks = iter([action.tick for action in story.actions if not isinstance(action, Input)])
        self.process.stdin.write(story.told())
        self.process.stdin.flush()
        for line in self.process.stdout:
            kind, *words = line.decode().split()
            if kind == "a":
                result.answers.append((next(ticks), bytes.fromhex(words[0] if words else "")))
            elif kind == "n":
                result.add(int(words[0]), int(words[1]), words[2], int(words[3]))
            else:
                for motor, count in enumerate(words, 1):
                    pulses = array("Q")
                    pulses.frombytes(self.process.stdout.read(8 * int(count)))
                    result.pulses[motor] = pulses.tolist()
                return result
        status = self.process.wait()
        self.start()
        raise RuntimeError(f"the core ended with status {status} in the middle of the story")

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


def reference(story):
    result, unit = Result(), Unit(story.readings)
    for action in story.actions:
        unit.advance_to(action.tick)
        if isinstance(action, Input):
            unit.set_inputs(action.mask)
        else:
            result.answers.append((action.tick, unit.message(action.data())))
    unit.advance_to(story.end)
    for note in sorted(unit.notes, key=lambda note: note[0]):
        result.add(*note)
    result.pulses, result.loose, result.seen = unit.pulses, unit.loose, unit.seen
    return result


class Comparison:
    """What differs: `soft` ticks at which motions that are not single ones from rest are a tick apart, as R2 allows; `hard`
    the earliest difference, as (tick, text); `edge` whether that one only follows from a soft one on the edge of a slot."""

    def __init__(self, story, ours, theirs):
        self.soft, self.hard = set(), None
        known = [answer for answer in ours.answers if answer[1] is not None]
        told = [theirs for ours, theirs in zip_longest(ours.answers, theirs.answers) if ours is None or ours[1] is not None]
        self.check("answer", known, [answer for answer in told if answer is not None])
        for key in sorted({*ours.notes, *theirs.notes}):
            self.check(f"motor {key[0]} {key[1]}", ours.notes.get(key, []), theirs.notes.get(key, []), nearly)
        for motor in range(1, 5):
            loose = ours.loose[motor]
            self.check(f"motor {motor} pulse", ours.pulses[motor], theirs.pulses[motor],
                       lambda a, b, i, loose=loose: abs(a - b) <= 1 and i in loose)
        self.edge = self.hard is not None and self.on_the_edge(story)

    def check(self, name, ours, theirs, same=lambda a, b, i: False):
        if ours == theirs:
            return
        for i in range(max(len(ours), len(theirs))):
            pair = [side[i] if i < len(side) else None for side in (ours, theirs)]
            ticks = [item[0] if isinstance(item, tuple) else item for item in pair if item is not None]
            if pair[0] == pair[1]:
                continue
            if len(ticks) == 2 and same(*pair, i):
                self.soft.add(min(ticks))
                continue
            text = f"{name} {i + 1}: reference {pair[0]}, core {pair[1]}"
            self.hard = min(item for item in (self.hard, (min(ticks), text)) if item is not None)
            return

    def on_the_edge(self, story):
        """A tick decides whether the command after a motion comes in this slot or the next (K4), and what is seen of a motion
        or happens to it in the very tick."""
        at = self.hard[0]
        told = {action.tick for action in story.actions}
        for tick in self.soft:
            phase = tick % 1000
            if tick <= at <= tick + 1011 and (phase in (989, 990, 999, 0) or {tick, tick + 1} & told):
                return True
        return False


def nearly(ours, theirs, _):
    return ours[1] == theirs[1] and abs(ours[0] - theirs[0]) <= 1
