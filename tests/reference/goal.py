#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare the planner's profile_go() with exact arithmetic: random sequences of commands to an axis with two accelerations.

    goal.py SUBJECT [SEQUENCES [SEED]]

SUBJECT is goal_subject. Every pulse must come, in its direction, within one tick of its time; a motion back behind a turn is
reckoned from the tick at which the pulse before it came. A motion from rest that reaches its speed, or has one acceleration, is
exact until the next command. Nothing here is taken from the product."""
import math
import random
import subprocess
import sys
from fractions import Fraction as F

BITS = 320                 # places kept of irrational numbers
GRID = 1 << BITS
SAME = F(1, 10 ** 40)      # irrational numbers that are closer than this are the same
MILLIONTH = F(1, 10 ** 6)
TICKS = 10 ** 6
SLOT = 1000


class Real:
    """A number, and whether it is exact: no irrational one has come in."""
    __slots__ = ("value", "exact")

    def __init__(self, value, exact=True):
        self.value = F(value) if exact else F(math.floor(value * GRID), GRID)
        self.exact = exact

    def __add__(self, other):
        other = real(other)
        return Real(self.value + other.value, self.exact and other.exact)

    def __sub__(self, other):
        other = real(other)
        return Real(self.value - other.value, self.exact and other.exact)

    def __mul__(self, other):
        other = real(other)
        return Real(self.value * other.value, self.exact and other.exact)

    def __truediv__(self, other):
        other = real(other)
        return Real(self.value / other.value, self.exact and other.exact)

    def __lt__(self, other):
        return self.value < real(other).value

    def __gt__(self, other):
        return self.value > real(other).value


def real(x):
    return x if isinstance(x, Real) else Real(x)


def root(x):
    value = max(x.value, F(0))
    n, d = math.isqrt(value.numerator), math.isqrt(value.denominator)
    if x.exact and n * n == value.numerator and d * d == value.denominator:
        return Real(F(n, d))
    return Real(F(math.isqrt((value.numerator << 2 * BITS) // value.denominator), GRID), False)


def whole(x, slack=SAME):
    """Rounded up; an irrational number less than `slack` above a whole one counts as that."""
    below = math.floor(x.value)
    return below if x.value == below or (not x.exact and x.value - below < slack) else below + 1


def tick_of(seconds):
    return whole(seconds * TICKS)


class Leg:
    """From time t and place x on with speed v and a slope, to place `end` (None: for ever)."""

    def __init__(self, t, x, v, slope, end):
        self.t, self.x, self.v, self.slope, self.end = t, x, v, slope, end

    def time_at(self, x):
        way = real(x) - self.x
        if self.slope == 0:
            return way / self.v
        return (root(self.v * self.v + way * (2 * self.slope)) - self.v) / self.slope

    def at(self, t):
        d = t - self.t
        return self.x + self.v * d + d * d * F(self.slope, 2), self.v + d * self.slope


class Plan:
    def __init__(self, t, x, v):
        self.legs, self.t, self.x, self.v, self.last = [], t, x, v, None

    def add(self, slope, end):
        if end is not None:
            end = real(end)
            if not end.value - self.x.value > (0 if end.exact and self.x.exact else SAME):
                return
        leg = Leg(self.t, self.x, self.v, slope, end)
        self.legs.append(leg)
        if end is not None:
            self.t, self.x = self.t + leg.time_at(end), end
            if slope:
                self.v = root(self.v * self.v + (end - leg.x) * (2 * slope))

    def to_speed(self, v, slope):
        if v.value != self.v.value:
            self.add(slope, self.x + (v * v - self.v * self.v) / (2 * slope))
            self.v = v

    def time_of(self, k):
        for leg in self.legs:
            if leg.end is None or k <= leg.end.value or (not leg.end.exact and k - leg.end.value < SAME):
                return leg.t + leg.time_at(k)
        return self.legs[-1].t + self.legs[-1].time_at(self.legs[-1].end)

    def state(self, t):
        leg = self.legs[0]
        for other in self.legs:
            if other.t.value <= t.value:
                leg = other
        return leg.at(t)


def plan_forward(t, x, v, last, speed, s, a, d):
    """To step `last` (None: for ever) at `speed`, without a turn."""
    speed, s, plan = Real(speed), Real(s), Plan(t, x, v)
    end_speed = min(speed, s, key=lambda number: number.value)
    if plan.v < end_speed:
        plan.v = end_speed
    elif plan.v > speed:
        low = max(speed, s, key=lambda number: number.value)
        if plan.v > low:
            plan.to_speed(low, -d)
        plan.v = speed
    if last is None:
        if plan.v < speed:
            plan.to_speed(speed, a)
        plan.add(0, None)
        return plan
    brake = (plan.v * plan.v - end_speed * end_speed) / (2 * d) if plan.v > end_speed else Real(0)
    place = Real(last) if last >= (plan.x + brake).value else plan.x + brake
    peak2 = ((place - plan.x) * (2 * a * d) + plan.v * plan.v * d + end_speed * end_speed * a) / (a + d)
    peak = speed if peak2.value >= speed.value ** 2 else root(peak2)
    if peak > plan.v:
        plan.to_speed(peak, a)
    if peak > end_speed:
        plan.add(0, place - (peak * peak - end_speed * end_speed) / (2 * d))
        plan.v = peak
        plan.add(-d, place)
        plan.v = end_speed
    plan.add(0, last)
    plan.last = last
    return plan


def stop_place(x, v, s, d):
    return x + (v * v - s * s) / (2 * d) if v.value > s else x


def plan_stop(t, x, v, s, d):
    plan, place = Plan(t, x, v), stop_place(x, v, Real(s), d)
    plan.last = whole(place, MILLIONTH)
    if v.value > s:
        plan.add(-d, place if place.value <= plan.last else plan.last)
        plan.v = Real(s)
    plan.add(0, plan.last)
    return plan


class Axis:
    """Does commands (tick, kind, value, speed, s, a, d); `seen` are the ticks at which the subject's pulses came."""

    def __init__(self, seen):
        self.seen, self.pulses = seen, []
        self.plan, self.goal, self.par = None, None, None
        self.position, self.direction, self.done = 0, 1, 0

    def begin(self, tick):
        kind, value, speed = self.goal
        way = value - self.position if kind == "pos" else value
        self.plan, self.done = None, 0
        if kind == "stop" or way == 0:
            return
        self.direction = 1 if way > 0 else -1
        last, speed = (abs(way), speed) if kind == "pos" else (None, abs(value))
        self.plan = plan_forward(Real(F(tick, TICKS)), Real(0), Real(0), last, speed, *self.par)

    def act(self, tick, kind, value, speed, *par):
        self.par, self.goal = par, (kind, value, speed)
        if self.plan is None:
            self.begin(tick)
            return
        s, _, d = par
        t = Real(F(tick, TICKS))
        x, v = self.plan.state(t)
        x, self.done = x - self.done, 0
        way = (value - self.position) * self.direction
        self.turning = False
        if kind == "pos" and way >= whole(stop_place(x, v, Real(s), d), MILLIONTH):
            self.plan = plan_forward(t, x, v, way, speed, *par) if way else None
        elif kind == "vel" and value * self.direction > 0:
            self.plan = plan_forward(t, x, v, None, abs(value), *par)
        else:
            self.plan = plan_stop(t, x, v, s, d)
            self.turning = kind != "stop"
            if self.plan.last == 0:
                self.end(tick)

    def end(self, tick):
        self.plan = None
        if self.turning:
            self.turning = False
            self.begin(tick)

    def run(self, until):
        """Pulses up to and including a tick."""
        while self.plan is not None:
            tick = tick_of(self.plan.time_of(self.done + 1))
            if tick > until:
                return
            self.done += 1
            self.position += self.direction
            self.pulses.append((tick, self.position))
            if self.done == self.plan.last:
                i = len(self.pulses) - 1
                near = i < len(self.seen) and abs(self.seen[i] - tick) <= 1
                self.end(self.seen[i] if near else tick)

    turning = False


def random_sequence(dice):
    """Commands of one sequence, and its last tick."""
    unit = dice.choice((1, 1, 10, 100))
    s = dice.choice((dice.randint(5, 300), dice.randint(5, 2000), 10000))
    commands, tick = [], SLOT * dice.randint(1, 5)
    for _ in range(dice.randint(1, 9)):
        a, d = (unit * dice.choice((5, 240, dice.randint(5, 240), 100)) for _ in range(2))
        if dice.random() < 0.3:
            a = d
        speed = dice.choice((dice.randint(5, 400), dice.randint(5, 2000), 500))
        kind = dice.choice(("pos", "pos", "pos", "vel", "vel", "stop"))
        value = {"pos": dice.randint(-900, 900), "vel": speed * dice.choice((1, 1, -1)), "stop": 0}[kind]
        if dice.random() < 0.2:
            s = dice.choice((dice.randint(5, 300), 10000))
        commands.append((tick, kind, value, speed if kind == "pos" else 0, s, a, d))
        tick += SLOT * dice.choice((1, dice.randint(1, 50), dice.randint(1, 900), dice.randint(1, 900)))
    return commands, tick + SLOT * dice.randint(1, 1500)


def exact_until(commands, until):
    """The tick up to which the first motion has to be exact."""
    axis = Axis([])
    _, *first = commands[0]
    axis.act(0, *first)
    if axis.plan is None:
        return 0
    s, a, d = first[3:]
    reaches = first[0] == "vel" or any(leg.slope == 0 and leg.v.value == first[2] for leg in axis.plan.legs)
    return (commands[1][0] if len(commands) > 1 else until) if reaches or a == d or s >= first[2] else 0


def differs(ours, theirs, exact):
    """Why two lists of pulses are not the same, to the tick up to `exact`; None: they are."""
    for i, (a, b) in enumerate(zip(ours, theirs)):
        if a[1] != b[1] or abs(a[0] - b[0]) > (0 if a[0] <= exact else 1):
            return f"pulse {i + 1} to {b[1]} at {b[0]}, expected to {a[1]} at {a[0]}"
    if len(ours) != len(theirs):
        return f"{len(theirs)} pulses, expected {len(ours)}"
    return None


def main():
    subject = subprocess.Popen([sys.argv[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    sequences = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    dice = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    pulses = turns = late = 0
    for number in range(1, sequences + 1):
        commands, until = random_sequence(dice)
        for command in commands + [(until, "end", 0, 0, 0, 0, 0)]:
            print(*command, file=subject.stdin)
        subject.stdin.flush()
        theirs = []
        while (line := subject.stdout.readline()) not in ("\n", ""):
            theirs.append(tuple(map(int, line.split())))
        axis = Axis([tick for tick, _ in theirs])
        for tick, *command in commands:
            axis.run(tick)
            axis.act(tick, *command)
        axis.run(until)
        why = differs(axis.pulses, theirs, exact_until(commands, until))
        if why:
            sys.exit(f"goal: sequence {number}: {why}\n" + "\n".join(" ".join(map(str, command)) for command in commands))
        pulses += len(theirs)
        late += sum(a[0] != b[0] for a, b in zip(axis.pulses, theirs))
        turns += sum(a[1] == c[1] for a, c in zip(theirs, theirs[2:]))
    print(f"goal: {sequences} sequences, {pulses} pulses, {turns} turns, {late} pulses one tick off")
    if turns == 0 or pulses < 20 * sequences:
        sys.exit("goal: the sequences do too little")


if __name__ == "__main__":
    main()
