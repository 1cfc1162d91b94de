#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare the core of the PMC with exact arithmetic.

    pmc.py SUBJECT [COUNT [SEED]]

SUBJECT is pmc_subject. COUNT moves from rest; half as many motions with stops and changes of speed; a fifth as many programs; a
twentieth as many home searches over random plants. All ticks must be equal. Nothing here is taken from the product."""
import random
import subprocess
import sys
from fractions import Fraction

import pmc_home
import pmc_program
from pmc_motion import SLOT, WIDTH, Course, endless, fixed, floor, move, stop

KEYS = ("m", "acceleration", "deceleration", "start_speed", "speed1", "speed2", "speed3", "speed4", "home_low", "home_high",
        "soft+", "soft-", "numerator", "denominator", "timer1", "timer2", "timer3", "offset", "flags", "steps")
RUN, JOG, MOVE_TO, MOVE_BY, SEARCH, _, _, SET_SPEED, STOP = range(9)
OPS = ("NOP", "ABS", "INC", "HOM", "IJP", "OUT", "OTP", "JMP", "REP", "RPE", "END", "TIM")
INPUTS = {"near": 4, "home": 8, "z": 16, "lmt+": 32, "lmt-": 64}
FAR = 2147483647
LATEST = 60  # s: longer motions are left out


class Story:
    """Commands for the subject, and what must come out. `name` is printed where it does not."""

    def __init__(self, name, passes=False):
        self.name, self.lines, self.wanted, self.last = name, [f"begin {int(passes)}"], [], None

    def set(self, key, value):
        self.lines.append(f"set 0 {KEYS.index(key)} {value}")

    def ask(self, tick, kind, value=0):
        self.lines.append(f"ask {tick} {kind} 1 {value} 0")

    def want(self, k, tick):
        self.lines.append(f"want 0 {k}")
        self.wanted.append(tick)

    def check(self, out):
        """Returns what is wrong, or None."""
        ticks = [int(line[0]) for line in out[:len(self.wanted)]]
        rest = [tuple(map(int, line)) for line in out[len(self.wanted):]]
        for line, tick, wanted in zip((l for l in self.lines if l.startswith("want")), ticks, self.wanted):
            if tick != wanted:
                return f"{line}: at {tick}, expected {wanted}"
        return self.last(rest)


def log_random(rng, low, high):
    return min(high, max(low, round(low * (high / low) ** rng.random())))


def random_values(rng, story):
    """m, s, a, d as set; deceleration None: it follows."""
    m = rng.choice((1, 10, 500, log_random(rng, 1, 500)))
    a, d = log_random(rng, 1, 8000), rng.choice((None, log_random(rng, 1, 8000)))
    s = rng.choice((1, 8000, log_random(rng, 1, 8000), log_random(rng, 1, 8000)))
    for key, value in zip(("m", "acceleration", "start_speed"), (m, a, s)):
        story.set(key, value)
    if d is not None:
        story.set("deceleration", d)
    return m, s, a, d or a


def interesting(rng, n):
    """Pulses to look at: the first, the last, some between."""
    return sorted({k for k in (1, 2, 3, n - 2, n - 1, n) if 1 <= k <= n} | {rng.randint(1, n) for _ in range(12)})


def wants_of(rng, story, profile, n, begin=SLOT):
    edges = {k for leg in profile.legs for k in range(floor(leg[1]) - 1, floor(leg[1]) + 3) if 1 <= k <= n}
    for k in sorted(edges | set(interesting(rng, n))):
        story.want(k, begin + profile.tick(k))


def check_end(errors, position, n, slot=None):
    def check(rest):
        got = rest[0]
        if (got[0], got[1], got[4]) != (errors, position, n) or slot is not None and got[5] != slot:
            return f"errors, position, pulses, slot: {got[0], got[1], got[4], got[5]}, expected {errors, position, n, slot}"
        return None
    return check


def slot_after(tick):
    return -(-(tick + WIDTH) // SLOT)


def make_move(rng, number):
    while True:
        story = Story(f"move {number}")
        m, s, a, d = random_values(rng, story)
        v, n = log_random(rng, 1, 8000), log_random(rng, 1, rng.choice((10, 1000, 200000)))
        profile = move(m * s, m * v, 125 * m * a, 125 * m * d, n)
        if profile.end[0] < fixed(LATEST):
            break
    sign = rng.choice((1, -1))
    story.ask(0, SET_SPEED, v)
    story.ask(rng.randint(0, SLOT), MOVE_BY, sign * n)
    wants_of(rng, story, profile, n)
    story.lines.append("run 0")
    story.last = check_end(0, sign * n, n, slot_after(SLOT + profile.tick(n)))
    return story


def change_at(rng, slot):
    """A tick from which a request acts in this slot."""
    return rng.randint((slot - 1) * SLOT + 1, slot * SLOT)


def make_course(rng, number):
    """A move or JOG with changes of the fifth speed, most of them stopped at last."""
    story = Story(f"course {number}")
    m, s, a, d = random_values(rng, story)
    actual = lambda v: (m * s, m * v, 125 * m * a, 125 * m * d)
    v, limit = log_random(rng, 1, 8000), None
    kind = rng.choice(("free", "limited", "move"))
    if kind != "free":
        limit = log_random(rng, 1, rng.choice((100, 10000, 300000)))
    if kind == "limited":
        story.set("soft+", limit)
    if kind == "free":
        story.set("flags", 0x103 | (0x10 if d != a else 0))
    plan = (lambda w, start=None: move(*actual(w), limit, start)) if limit else (lambda w, start=None: endless(*actual(w), start))
    story.ask(0, SET_SPEED, v)
    story.ask(0, *((MOVE_BY, limit) if kind == "move" else (JOG, 1)))
    course, slot = Course(SLOT, plan(v)), 1
    span = log_random(rng, 2, 300)
    for _ in range(rng.randint(0, 6)):
        slot += rng.randint(1, span)
        if course.is_over(slot * SLOT):
            break
        v = log_random(rng, 1, 8000)
        story.ask(change_at(rng, slot), SET_SPEED, v)
        if not course.is_final(slot * SLOT):
            course.change(slot * SLOT, plan(v, course.state(slot * SLOT)))
    slot += rng.randint(1, span)
    is_stopped = not limit or rng.random() < 0.8
    if is_stopped and not course.is_over(slot * SLOT):
        story.ask(change_at(rng, slot), STOP)
        if not course.is_final(slot * SLOT):
            course.change(slot * SLOT, stop(m * s, 125 * m * d, course.state(slot * SLOT)))
    n = course.total()
    if n > 400000 or course.tick(max(n, 1)) > LATEST * 1000 * SLOT:
        return make_course(rng, number)
    for k in interesting(rng, n) if n else ():
        story.want(k, course.tick(k))
    for begin, place, _ in course.parts[1:]:
        for k in range(floor(place), floor(place) + 3):
            if 1 <= k <= n:
                story.want(k, course.tick(k))
    story.lines.append(f"run {slot * SLOT}")
    story.last = check_end(1 if kind == "limited" and n == limit else 0, n, n)
    return story


def make_program(rng, number):
    passes = rng.random() < 0.3
    story = Story(f"program {number}", passes)
    m, s, a, d = random_values(rng, story)
    if s * m < 1000:  # no minutes a pulse
        m = 500
        story.set("m", m)
    speeds = [log_random(rng, 100, 8000) for _ in range(4)]
    for i, v in enumerate(speeds):
        story.set(f"speed{i + 1}", v)
    ratio = rng.choice(((1000, 1000), (5, 1), (1, 3), (rng.randint(1, 65535), rng.randint(1, 65535))))
    story.set("numerator", ratio[0])
    story.set("denominator", ratio[1])
    inputs = rng.randrange(2), rng.randrange(2)
    story.lines.append(f"inputs 0 {inputs[0] + 2 * inputs[1]}")
    axis = pmc_program.Axis(m, a, d, s, speeds, ratio)
    program = {reg: command_of(rng, axis) for reg in range(64) if rng.random() < 0.6}
    trace, written, off, position, pulses, failed, slot = pmc_program.run(axis, program, passes, inputs)
    for reg, (op, *arg) in program.items():
        value, ms, speed, argument, what, wait = 0, 0, 0, 0, 0, 0
        if op in ("ABS", "INC"):
            value, speed, ms = arg
        elif op == "TIM":
            ms = arg[0]
        elif op == "OUT":
            what, argument = arg
        elif op == "OTP":
            what, ms, wait = arg
        elif op == "IJP":
            what, argument = arg
        elif op in ("JMP", "REP"):
            argument = arg[0]
        story.lines.append(f"reg 0 {reg} {OPS.index(op)} {value} {ms} {speed} {argument} {what} {wait}")
    story.ask(0, RUN, 0)
    if failed is None:  # without end: stopped before its next command
        story.ask(change_at(rng, slot), STOP)
    ends = sorted(off.items(), key=lambda item: item[::-1])
    story.lines.append(f"run {(max([slot] + [end for _, end in ends]) + 1) * SLOT}")

    def check(rest):
        wrong = check_end(0x20 if failed else 0, position, pulses)(rest)
        got = [line[::2] for line in rest[2:] if len(line) == 3]
        if wrong or got != trace:
            return wrong or next(f"{a}, expected {b}" for a, b in zip(got + [None], trace + [None]) if a != b)
        changes, outputs = list(written), written[-1][1] if written else 0
        for what, end in ends:
            if outputs >> what & 1:
                outputs &= ~(1 << what)
                changes.append((end, outputs))
        got = [line for line in rest[2:] if len(line) == 2]
        return None if got == changes else f"outputs {got}, expected {changes}"
    story.last = check
    return story


def command_of(rng, axis):
    """A random command; way and time are short."""
    op = rng.choice(OPS[1:3] + OPS[4:10] + OPS[7:10] + OPS[10:])
    if op in ("ABS", "INC"):
        most = int(min(min(axis.s * 30, 2000) / axis.ratio, 8000000))
        return op, rng.randint(-most, most), rng.randint(1, 4), rng.choice((0, 0, rng.randint(1, 30)))
    if op == "IJP":
        return op, rng.randrange(2), rng.randrange(64)
    if op == "OUT":
        return op, rng.randrange(2), rng.randrange(2)
    if op == "OTP":
        return op, rng.randrange(2), rng.randint(1, 40), rng.randrange(2)
    if op == "JMP":
        return op, rng.randrange(64)
    if op == "REP":
        return op, rng.randint(1, 5)
    if op == "TIM":
        return op, rng.randint(1, 50)
    return (op,) if op != "END" or rng.random() < 0.3 else ("NOP",)


def make_search(rng, number):
    story = Story(f"search {number}")
    m, s, a, d = rng.choice((1, 10)), log_random(rng, 1, 1000), log_random(rng, 20, 8000), log_random(rng, 20, 8000)
    low, high, offset = log_random(rng, 50, 1000), log_random(rng, 100, 8000), rng.choice((0, rng.randint(1, 500)))
    steps = [(rng.random() < 0.75, rng.choice((1, -1))) for _ in range(4)]
    slow = rng.random() < 0.6
    for key, value in (("m", m), ("acceleration", a), ("deceleration", d), ("start_speed", s), ("home_low", low),
                       ("home_high", high), ("offset", offset), ("flags", 0x132 + slow),
                       ("steps", 0x1F00 + sum(on << i | (sign > 0) << 4 + i for i, (on, sign) in enumerate(steps)))):
        story.set(key, value)
    position = rng.randint(-1500, 1500)
    switches = {"lmt-": (None, rng.randint(-2500, -800), rng.choice((0, 5))), "lmt+": (rng.randint(800, 2500), None, 0)}
    for name in ("near", "home", "z"):
        if len(switches) < 4 and rng.random() < 0.8:
            begin = rng.randint(-1800, 1800)
            width = rng.choice((0, 5, 100, 1000))
            switches[name] = rng.choice(((begin, begin + width, rng.choice((0, 3, 20))), (None, begin, rng.choice((0, 10))),
                                         (begin, None, 0)))
    place = lambda x, without: without if x is None else x
    story.lines.append(f"plant 0 {position} {len(switches)} " + " ".join(
        f"{INPUTS[name]} {place(one[0], -FAR)} {place(one[1], FAR)} {one[2]}" for name, one in switches.items()))
    plant = pmc_home.Plant(position, switches)
    values = dict(m=m, s=s * m, a=125 * m * a, d=125 * m * d, high=high * m, home_low=low, offset=offset, steps=steps, slow=slow)
    search = pmc_home.Search(values, plant, 1)
    try:
        slot, homed = search.run(), True
    except pmc_home.Failed:
        slot, homed = None, False
    story.ask(rng.randint(0, SLOT), SEARCH)
    story.lines.append("run 0")

    def check(rest):
        errors, counter, true, is_homed, _, free = rest[0]
        wanted = (0 if homed else 0x40, 0 if homed else counter, plant.position, int(homed), slot or free)
        got = errors, counter, true, is_homed, free
        return None if got == wanted else f"errors, counter, place, homed, slot: {got}, expected {wanted}"
    story.last = check
    return story


def run_stories(subject, stories):
    """Returns how many went wrong; prints them."""
    text = "".join("\n".join(story.lines) + "\nend\n" for story in stories)
    out = subprocess.run([subject], input=text, stdout=subprocess.PIPE, text=True, check=True).stdout
    wrong = 0
    for story, answer in zip(stories, out.split("\n\n")):
        message = story.check([line.split() for line in answer.strip().split("\n")])
        if message:
            wrong += 1
            print(f"{story.name}: {message}")
            print("    " + "\n    ".join(line for line in story.lines if not line.startswith("want")))
    if out.count("\n\n") != len(stories):
        sys.exit("pmc.py: the subject has not answered everything")
    return wrong


def main():
    subject, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    wrong = done = pulses = 0
    for make, share in ((make_move, 1), (make_course, 2), (make_program, 5), (make_search, 20)):
        for first in range(0, -(-count // share), 500):
            numbers = range(first, min(first + 500, -(-count // share)))
            stories = [make(random.Random(f"{seed} {make.__name__} {number}"), number) for number in numbers]
            wrong += run_stories(subject, stories)
            done, pulses = done + len(stories), pulses + sum(len(story.wanted) for story in stories)
    print(f"{done} stories, {pulses} pulses compared: {wrong} went wrong")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
