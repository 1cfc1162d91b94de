# SPDX-License-Identifier: MIT
"""Random stories. A number of a story, with the seed, makes it: the same on every machine."""

import math
from random import Random

from readings import NAMED, TIMES, Readings
from story import Ask, Input, Send, Story

VARIABLES = [80, 81, 82, 95]
SLOT = 1000


class Author:
    def __init__(self, seed, number):
        self.random = Random(f"{seed}/{number}")
        self.dice = Random(f"{seed}/{number}/readings")
        r = self.random
        self.end = r.choice([1, 2, 3, 4]) * 1_000_000
        self.inputs = r.sample(range(1, 9), 3)
        self.fast = r.random() < 0.04   # speeds and numbers over the whole range: many pulses
        self.mad = r.random() < 0.08    # any command after any other
        self.slow = r.random() < 0.1    # V near or below S
        self.weights = {name: r.choice([0, 1, 1, 2, 4]) for name in self.KINDS}
        self.weights["move"] += 2

    KINDS = ("move", "compound", "limit", "goal", "endless", "guard", "loop", "call", "jump", "wait", "dwell", "output",
             "function", "simulation", "counter", "bracket", "parameters", "odd")

    def log(self, low, high):
        """A whole number, each order of magnitude as likely as the next."""
        return int(round(math.exp(self.random.uniform(math.log(low), math.log(high)))))

    def chance(self, p):
        return self.random.random() < p

    # ---- numbers ------------------------------------------------------------------------------------------------------

    def start(self):
        return self.log(1, 2000) if self.chance(0.5) else self.random.choice([1, 50, 100, 250, 2000])

    def speed(self):
        if self.fast:
            return self.random.choice([self.log(1, 16000), 16000])
        if self.slow:
            return self.log(1, 300)
        return self.random.choice([self.log(20, 6000), self.random.choice([100, 500, 1000, 2500])])

    def acceleration(self):
        return self.log(1, 60000) if self.chance(0.3) else self.random.choice([500, 1000, 2000, 10000, 60000])

    def count(self):
        if self.chance(0.15):
            return self.random.randint(1, 3)
        if self.chance(0.03):
            return self.random.choice([16_000_000, 1_000_000])
        return self.log(1, 4000 if self.fast else 1200)

    def input(self):
        return self.random.choice(self.inputs)

    def source(self):
        return self.input() if self.chance(0.4) else self.random.choice(VARIABLES)

    def label(self):
        return self.random.randint(1, 6)

    # ---- pieces of programs: lists of commands ------------------------------------------------------------------------

    def parameters(self):
        pool = [f"S{self.start()}", f"V{self.speed()}", f"A{self.acceleration()}"]
        return self.random.sample(pool, self.random.randint(1, 3))

    def steps(self):
        return f"{self.random.choice('FFB')}{self.count()}"

    def move(self):
        piece = [self.steps()] if self.chance(0.8) else []
        if self.chance(0.2):
            piece.append("D")
        return piece + ["R"]

    def compound(self):
        r = self.random
        piece = [f"T{r.randint(51, 58)}"] if self.chance(0.4) else []
        direction = r.choice("FB")
        for _ in range(r.choice([1, 2, 2, 3, 3, 4, 5, 10, 11 if self.chance(0.2) else 6])):
            if self.chance(0.8):
                piece.append(f"{direction}{self.count()}")
            if self.chance(0.7):
                piece.append(f"V{self.speed()}")
            if self.chance(0.3):
                piece.append(f"A{self.acceleration()}")
            piece.append("Y")
        return piece + (["R"] if self.chance(0.95) else [])

    def limit(self):
        return [f"{self.random.choice(')(')}{self.input():02d}"]

    def goal(self):
        goal = self.random.choice([self.log(1, 3000), self.log(1, 3000), 2_000_000_000])
        return ["H"] if self.chance(0.4) else [f"G{goal}"]

    def endless(self):
        return (self.guard() if self.chance(0.7) else []) + [f"G{self.random.choice('+-')}"]

    def guard(self):
        return [self.random.choice(["M", "N", "M", "N", "X", "U"])] if False else self.one_guard()

    def one_guard(self):
        letter = self.random.choice("MMNNXU")
        return ["U"] if letter == "U" else [f"{letter}{self.input():02d}"]

    def loop(self):
        return [f"L{self.random.choice([1, 2, 2, 3, 5, 255])}"] + self.pieces(self.random.randint(1, 3)) + ["E"]

    def call(self):
        label, after = self.random.randint(10, 30), self.random.randint(31, 80)
        body = self.pieces(self.random.randint(1, 2))
        return [f"'{label}"] + [f"J{after}", f"@{label}"] + body + [".", f"@{after}"]

    def jump(self):
        r = self.random
        if self.chance(0.5):
            return [f"@{self.label()}"]
        if self.chance(0.5):
            return [f"J{self.label()}"]
        return [f"I{self.source():02d}{r.choice('HL')}{self.label()}"]

    def wait(self):
        return [f"{self.random.choice('OZZ')}{self.source():02d}"]

    def dwell(self):
        return [f"W{self.log(1, 200)}"]

    def output(self):
        r = self.random
        number = r.randint(1, 8) if self.chance(0.5) else r.choice(VARIABLES)
        return [f"{r.choice('TTC')}{number:02d}"]

    def function(self):
        r = self.random
        return [f"{r.choice('TTC')}{r.choice([40, r.randint(42, 50), r.randint(51, 58), r.randint(51, 58)])}"]

    def simulation(self):
        return [self.random.choice(["T41", "C41"])] if self.chance(0.4) else []

    def counter(self):
        r = self.random
        return [r.choice(["C100", f"={r.randint(-3000, 3000)}", "=2000000000", "=-2000000000", f"=-{self.log(1, 999)}"])]

    def bracket(self):
        return [self.random.choice("[]]")]

    def odd(self):
        """What ends in a fault, as a rule."""
        return [self.random.choice(["E", ".", "J79", "'78", "L2", "L2", "'5"])] if self.chance(0.5) else []

    def anything(self):
        kinds = (self.parameters, self.move, self.limit, self.goal, self.endless, self.one_guard, self.jump, self.wait,
                 self.dwell, self.output, self.function, self.counter, self.bracket, self.odd)
        if self.chance(0.4):
            return [self.random.choice(["E", ".", "Y", "R", "D", "U", "L3", f"'{self.label()}", f"J{self.label()}"])]
        return self.random.choice(kinds)()[:1]

    def pieces(self, number):
        if self.mad:
            return [c for _ in range(2 * number) for c in self.anything()]
        names = list(self.KINDS)
        chosen = self.random.choices(names, [self.weights[n] for n in names], k=number)
        return [command for name in chosen for command in getattr(self, name)()]

    # ---- the spelling of texts ----------------------------------------------------------------------------------------

    def spell(self, commands):
        """Bytes of each command, now and then written otherwise, and now and then wrong."""
        r, texts = self.random, [command.encode() for command in commands]
        if self.chance(0.05) and texts:
            at = r.randrange(len(texts))
            text = texts[at]
            texts[at] = r.choice([
                b"{ a note }" + text, text[:1] + b"  " + text[1:], text[:1] + b"0" + text[1:], text + b"9999999999",
                text.lower(), b"{" + text, text[:-1], b"+" + text, text.replace(b"'", b"\xb4"), b"\t\r\n" + text,
                b"Q", text + b"}", b"= - 5", b"G +", b"I 01 H 2", b"=+5", b"I01X5", b"(9", b"T59", b"C75", b"K"])
        return texts

    def program(self):
        commands = self.parameters() if self.chance(0.7) else []
        return commands + self.pieces(self.random.choice([1, 2, 4, 6, 10]))

    # ---- the story ----------------------------------------------------------------------------------------------------

    def tick(self, from_tick=0):
        tick = self.random.randint(from_tick, self.end - 1)
        kind = self.random.random()
        if kind < 0.25:
            tick = tick // SLOT * SLOT
        elif kind < 0.4:
            tick = tick // SLOT * SLOT + self.random.choice([1, 999])
        return max(tick, from_tick)

    def motor(self):
        return self.random.choice([1, 1, 2, 3, 4, 4, 0] if self.chance(0.3) else [1, 1, 1, 2])

    def interruption(self):
        """A message while programs run."""
        r, kind = self.random, self.random.random()
        if kind < 0.22:
            return ["K"]
        if kind < 0.42:
            return ["C75"]
        if kind < 0.62:
            return [f"V{self.speed()}"]
        if kind < 0.68:
            return ["\\"] + (self.program() if self.chance(0.7) else [])
        if kind < 0.72:
            return [r.choice(["]", "K C75", "V100 V200", "C100", "U"])]
        if kind < 0.76:
            return self.program() + ["\\"] + self.program()
        return self.program()

    def story(self):
        r = self.random
        actions = []
        for motor in (1, 2, 3, 4):
            if self.chance([0, 1, 0.5, 0.3, 0.3][motor]):
                text = (["\\"] if self.chance(0.7) else []) + self.program()
                actions.append(Send(r.choice([0, 0, 0, 500]), motor, self.spell(text)))
        if self.chance(0.04):
            self.fill(actions)
        for _ in range(r.choice([0, 2, 5, 10])):
            actions.append(Input(self.tick(), sum(1 << (i - 1) for i in self.inputs if self.chance(0.4))))
        for _ in range(r.choice([0, 1, 3, 6, 12])):
            tick, motor = self.tick(), self.motor()
            for _ in range(r.choice([1, 1, 1, 2, 3])):
                actions.append(Send(tick, motor, self.spell(self.interruption())))
                tick = min(self.end - 1, tick + r.choice([0, 1, 10, 300, 1000, self.log(1, 100_000)]))
        for _ in range(r.choice([1, 4, 12])):
            actions.append(Ask(self.tick(), r.choice([4, 4, 7, 7, 7, 6, 6, 6, 5]), self.motor()))
        for motor in range(1, 5):
            actions += [Ask(self.end - 1, number, motor) for number in (4, 5, 6, 7)]
        readings = self.readings(r.choice([0, 0, 0, 7, 300, 2000]))
        if readings["store-time"]:
            for _ in range(self.dice.randint(1, 4)):
                actions.append(Ask(self.dice.randrange(self.end), 3, self.dice.choice([0, 1, 2])))
        actions.sort(key=lambda action: action.tick)
        return Story(readings, actions, self.end)

    def readings(self, latency):
        """All the defaults but that of `speed-change` in half of the stories; in the others each reading by chance."""
        readings, dice = Readings(speed_change=latency), self.dice
        if dice.random() < 0.5:
            return readings
        share = dice.choice([0.1, 0.3, 0.5])
        for name, values in NAMED.items():
            if dice.random() < share:
                readings[name] = values[1]
        for name, most in TIMES.items():
            if name != "speed-change" and dice.random() < share:
                readings[name] = dice.choice([1, 2, 5, 20, most // 20, most // 10 + 1])
        return readings

    def fill(self, actions):
        """Programs that fill the memory and go round (C10)."""
        for _ in range(self.random.randint(1, 3)):
            size = self.random.choice([100, 690, 700, 701, 720])
            text = []
            while len(text) < size:
                text += self.random.choice([self.pieces(1), ["D"], ["T80", "C80"], ["W1"]])
            actions.append(Send(self.tick(), 1, self.spell(text[:size])))


def write(seed, number):
    """The story of this number."""
    return Author(seed, number).story()
