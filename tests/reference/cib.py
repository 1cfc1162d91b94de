#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare a drive of the CIB module with exact arithmetic: random sequences of commands, with turns and plans on the way.

    cib.py SUBJECT [SEQUENCES [SEED]]

SUBJECT is cib_subject. Every pulse must come, in its direction and with its pattern, in its tick where BM10 promises it,
otherwise within one tick of it, as must every change of MCSTAT; a motion back behind a turn is reckoned from the tick at which
the pulse before it came. Nothing here is taken from the product; numbers and plans are those of goal.py. BC, BK, BM, BP, BT are
clauses of the specification."""
import random
import subprocess
import sys
from fractions import Fraction as F

from goal import MILLIONTH, SLOT, TICKS, Plan, Real, root, stop_place, tick_of, whole

ROWS = {16: (1, 2, 4, 8), 20: (3, 6, 12, 9), 32: (1, 3, 2, 6, 4, 12, 8, 9)}
MOVE, DIR, INVEL, TRG, ERR, RAMP = (1 << bit for bit in range(6))
NUMBERS = (0, 9, 11, 12, 13, 14, 100, 101, 102, 105, 108, 109)


def wrapped(position):
    return (position + 2 ** 31) % 2 ** 32 - 2 ** 31


class Way(Plan):
    """A plan, and when its speed is reached: `reached`."""
    reached = None


def plan_way(t, x, v, last, speed, par):
    """To pulse `last` (None: for ever) at `speed`, without a turn (BM1-BM3, BM8)."""
    s, a, d, early = Real(par.s), par.a, par.d, par.early
    plan, speed = Way(t, x, v), Real(speed)
    slow = speed if speed < s else s
    if plan.v < slow:
        plan.v = slow
    elif plan.v > speed:
        plan.to_speed(speed if speed > s else s if plan.v > s else plan.v, -d)
        plan.v = speed
    if last is None:
        plan.to_speed(speed, a)
        plan.reached = plan.t
        plan.add(0, None)
        return plan
    brake = plan.x + (plan.v * plan.v - slow * slow) / (2 * d) if plan.v > slow else plan.x
    place = brake if last - early < brake.value else Real(last - early)
    peak2 = ((place - plan.x) * (2 * a * d) + plan.v * plan.v * d + slow * slow * a) / (a + d)
    peak = speed if peak2.value >= speed.value ** 2 else root(peak2)
    if peak > plan.v:
        plan.to_speed(peak, a)
    if peak > slow:
        plan.add(0, place - (peak * peak - slow * slow) / (2 * d))
        plan.v = peak
        plan.add(-d, place)
        plan.v = slow
    plan.add(0, last)
    plan.last = last
    return plan


def plan_halt(t, x, v, s, d):
    """A stop (BM5)."""
    plan, place = Way(t, x, v), stop_place(x, v, Real(s), d)
    plan.last = whole(place, MILLIONTH)
    if v.value > s:
        plan.add(-d, place if place.value <= plan.last else plan.last)
        plan.v = Real(s)
    plan.add(0, plan.last)
    return plan


class Parameters:
    """Those of the slot in which a motion command acts (BP3)."""

    def __init__(self, drive):
        unit = drive.unit
        self.s, self.early = drive.s if drive.status & RAMP else 10000, drive.early
        self.a, self.d, self.stop = drive.a * unit, drive.d * unit, drive.stop * unit


class Drive:
    """Does commands (tick, number, p1, p2); `seen` are the ticks at which the subject's pulses came."""

    def __init__(self, seen, s, maximum, a, d, early, mode, unit, idle, timeout):
        self.seen, self.s, self.a, self.d, self.stop = seen, s, a, d, d
        self.maximum, self.a_max, self.d_max, self.early, self.unit = maximum, a, d, early, unit
        self.rows, self.bipolar = ROWS[mode & ~1], mode & 1
        self.idle, self.timeout = idle * 1000, timeout * 1000
        self.position, self.row, self.status = 0, 0, RAMP
        self.plan, self.goal, self.par, self.direction, self.done = None, None, None, 1, 0
        self.waiting, self.slot, self.reached, self.off = None, None, None, None
        self.silent_at = self.timeout or None
        self.stop_slot = None
        self.pulses, self.changes, self.others = [], [], []
        self.exact, self.sure = [], False  # has each pulse to come in its very tick? Those of the present plan?

    def set_status(self, tick, status):
        if status == self.status:
            return
        if (status ^ self.status) & MOVE:
            self.off = None if status & MOVE or not self.idle else tick + self.idle
        self.status = status
        self.changes.append((tick, status))

    # ---- Commands (section 5) ----

    def refusal(self, number, p1, p2):
        if number not in NUMBERS:
            return 1
        bounds = {9: (0, 1), 11: (5, 10000), 12: (5, 240), 13: (5, 240), 14: (5, 240)}.get(number)
        speed = p2 if number in (101, 102) else abs(p1) if number == 105 and p1 else 5
        if bounds and not bounds[0] <= p1 <= bounds[1] or speed < 5:
            return 3
        if number == 12 and p1 > self.a_max or number == 13 and p1 > self.d_max or speed > max(self.maximum, 5):
            return 4
        return 5 if number == 100 and self.status & MOVE else 0

    def take(self, tick, number, p1, p2):
        if self.refusal(number, p1, p2):
            self.set_status(tick, self.status | ERR)
            return
        status = self.status & ~ERR
        if number == 9:
            status = status | RAMP if p1 else status & ~RAMP
        elif number == 100:
            self.position = p1
        elif number in (11, 12, 13, 14):
            setattr(self, {11: "s", 12: "a", 13: "d", 14: "stop"}[number], p1)
        elif number:
            self.waiting, self.slot = (number, p1, p2), max(SLOT, -(-tick // SLOT) * SLOT)
            moves = self.plan is not None or p1 and number in (102, 105) or number == 101 and p1 != self.position
            status = status & ~(MOVE | INVEL | TRG) | (MOVE if moves else 0)
        self.set_status(tick, status)

    # ---- Motion (section 6) ----

    def begin(self, tick):
        """From rest."""
        kind, value, speed = self.goal
        self.plan, self.done = None, 0
        if kind == "stop" or value == 0:
            self.end(tick)
            return
        self.direction = 1 if value > 0 else -1
        last, speed = (abs(value), speed) if kind == "way" else (None, abs(value))
        self.plan = plan_way(Real(F(tick, TICKS)), Real(0), Real(0), last, speed, self.par)
        # BM10: a motion from rest that has its speed somewhere, or one acceleration, has no place that is not exact.
        level = any(leg.slope == 0 and leg.v.value == speed for leg in self.plan.legs)
        self.sure = level or speed <= self.par.s or self.par.a == self.par.d
        self.go(tick)

    def go(self, tick):
        """A plan has been made; its INVEL (BC6)."""
        status = self.status & ~DIR | MOVE | (DIR if self.direction < 0 else 0)
        self.reached = None
        if self.plan.reached is not None:
            self.reached = tick_of(self.plan.reached)
            if self.reached <= tick:
                self.reached = None
                if self.slot is None:
                    status |= INVEL
        self.set_status(tick, status)

    def end(self, tick):
        """Nothing is left to do."""
        self.plan = self.reached = None
        if self.slot is None:
            self.set_status(tick, self.status & ~MOVE | (TRG if self.goal[0] == "way" else 0))

    def act(self, tick, number, p1, p2):
        self.par = Parameters(self)
        if number in (101, 102):
            self.goal = ("way", p1 - self.position if number == 101 else p1, p2)
        else:
            self.goal = ("speed", p1, 0) if number == 105 and p1 else ("stop", 0, 0)
        kind, value, speed = self.goal
        if self.plan is None:
            self.begin(tick)
            return
        t, s, d = Real(F(tick, TICKS)), self.par.s, self.par.stop if number == 109 else self.par.d
        x, v = self.plan.state(t)
        x, self.done, self.sure = x - self.done, 0, False
        way, self.turning = value * self.direction, False
        if kind == "way" and way >= whole(stop_place(x, v, Real(s), d), MILLIONTH):
            if way == 0:
                self.end(tick)
                return
            self.plan = plan_way(t, x, v, way, speed, self.par)
        elif kind == "speed" and way > 0:
            self.plan = plan_way(t, x, v, None, abs(value), self.par)
        else:
            self.plan, self.turning = plan_halt(t, x, v, s, d), kind != "stop"
            if self.plan.last == 0:
                self.finish(tick)
                return
        self.go(tick)

    turning = False

    def finish(self, tick):
        """The last pulse of a plan."""
        if not self.turning:
            self.end(tick)
            return
        self.turning = False
        if self.goal[0] == "way":
            self.goal = ("way", self.goal[1] - self.direction * self.done, self.goal[2])
        self.begin(tick)

    def pulse(self, tick):
        self.done += 1
        self.position = wrapped(self.position + self.direction)
        self.row = (self.row + self.direction) % len(self.rows)
        on = self.rows[self.row - 1]
        i = len(self.pulses)
        self.exact.append(self.sure)
        self.pulses.append((tick, self.position, on | (15 - on) << 8 if self.bipolar else on))
        if self.done == self.plan.last:
            near = i < len(self.seen) and abs(self.seen[i] - tick) <= 1
            self.finish(self.seen[i] if self.turning and near else tick)

    # ---- Time (section 2) ----

    def due(self):
        """(tick, order within it, what) of what comes next."""
        found = []
        if self.plan is not None:
            found.append((tick_of(self.plan.time_of(self.done + 1)), 0, "pulse"))
        for tick, order, what in ((self.reached, 1, "reached"), (self.off, 2, "off"), (self.silent_at, 3, "silent"),
                                  (self.slot, 4, "slot"), (self.stop_slot, 5, "stop")):
            if tick is not None:
                found.append((tick, order, what))
        return min(found) if found else None

    def run(self, until):
        """Everything in front of the tick `until`."""
        while (next_one := self.due()) and next_one[0] < until:
            tick, _, what = next_one
            if what == "pulse":
                self.pulse(tick)
            elif what == "reached":
                self.reached = None
                if self.slot is None:
                    self.set_status(tick, self.status | INVEL)
            elif what == "off":
                self.off = None
                if self.pulses and (not self.others or self.others[-1] < self.pulses[-1][0]):
                    self.others.append(tick)
            elif what == "silent":
                self.silent_at, self.stop_slot = None, max(SLOT, -(-tick // SLOT) * SLOT)
            elif what == "slot":
                if self.stop_slot == tick: # the command came behind the time
                    self.stop_slot = None
                command, self.waiting, self.slot = self.waiting, None, None
                self.act(tick, *command)
            else:
                self.stop_slot = None
                self.set_status(tick, self.status & ~(INVEL | TRG))
                self.act(tick, 109, 0, 0)

    def note_request(self, tick):
        self.silent_at = tick + self.timeout if self.timeout else None


def random_sequence(dice):
    """Settings, and commands (tick, number, p1, p2); its last tick."""
    small = dice.random() < 0.5
    speeds = (5, 20, 60, 100, 150, 250, 400) if small else (5, 97, 300, 500, 700, 1000, dice.randint(5, 2000))
    s = dice.choice((5, 50, 100, 300, dice.randint(5, 2000)))
    settings = (s, dice.choice((1000, 2000, 400)), dice.choice((240, 200, dice.randint(5, 240))),
                dice.choice((240, 100, dice.randint(5, 240))), dice.choice((0, 0, 0, 10, -10, dice.randint(-20, 20))),
                dice.choice((16, 17, 20, 21, 32, 33)), dice.choice((1, 1, 10, 100)), dice.choice((0, 0, 100)),
                dice.choice((0, 0, 0, 300)))
    commands, tick, far = [], dice.choice((0, 1, 1000, 1500, 2000)), 60 if small else 900
    for _ in range(dice.randint(1, 9)):
        number = dice.choice((101, 101, 102, 102, 105, 105, 105, 108, 109, 9, 11, 12, 13, 14, 100, dice.choice((0, 7, 103))))
        p1, p2, speed = 0, 0, dice.choice(speeds)
        if number in (101, 102):
            p1, p2 = dice.randint(-far, far) * dice.choice((0, 1, 1, 1)), speed
        elif number == 105:
            p1 = speed * dice.choice((1, 1, -1))
        elif number == 9:
            p1 = dice.choice((0, 1, 1, 2))
        elif number == 11:
            p1 = dice.choice((4, 5, 50, 100, 300, 10000))
        elif number in (12, 13, 14):
            p1 = dice.choice((5, 60, 100, 240, 241))
        elif number == 100:
            p1 = dice.choice((7, -1000, 2 ** 31 - 20, -2 ** 31))
        commands.append((tick, number, p1, p2))
        tick += dice.choice((0, 200, 300, 700, 1000, 20000, 50000, dice.randint(1, 400000), SLOT * dice.randint(1, 900)))
    return settings, commands, tick + dice.choice((600000, SLOT * dice.randint(1, 3000)))


def tell(subject, drive, settings, commands, until, cut):
    """Have drive 0 or 1 of the subject do it. Returns pulses, changes of MCSTAT and ticks of other changes of the outputs."""
    s, maximum, a, d, early, mode, unit, idle, timeout = settings
    lines = [f"mode {mode} {unit} {idle} {timeout} {cut}", f"begin {s} {maximum} {a} {d} {early}"]
    for tick, number, p1, p2 in commands:
        lines += [f"request {tick} 0 0 0 0", f"command {tick} {number} {p1} {p2} {drive}"]
    print("\n".join(lines), f"end {until} 0 0 0 0", sep="\n", file=subject.stdin, flush=True)
    pulses, changes, others = [], [], []
    while (line := subject.stdout.readline()) not in ("\n", ""):
        what, *numbers = line.split()
        if what == "error:":
            sys.exit(f"cib: {line}")
        numbers = tuple(map(int, numbers))
        if what == "p":
            pulses.append(numbers)
        elif what == "s":
            changes.append(numbers)
        else:
            others.append(numbers[0])
    return pulses, changes, others


def differs(what, ours, theirs, exact=()):
    """Why two lists of (tick, …) are not the same, but for one tick where they are not `exact`; None: they are."""
    for i, (a, b) in enumerate(zip(ours, theirs)):
        if a[1:] != b[1:] or abs(a[0] - b[0]) > (0 if i < len(exact) and exact[i] else 1):
            return f"{what} {i + 1} is {b}, expected {a}"
    return f"{len(theirs)} {what}s, expected {len(ours)}" if len(ours) != len(theirs) else None


def main():
    subject = subprocess.Popen([sys.argv[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    sequences = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    dice = random.Random(int(sys.argv[3]) if len(sys.argv) > 3 else 1)
    count = turns = late = anew = exact = 0
    for number in range(1, sequences + 1):
        settings, commands, until = random_sequence(dice)
        theirs, changes, others = tell(subject, number % 2, settings, commands, until,
                                        dice.choice((0, 0, 0, 1009, 70001)))
        drive = Drive([tick for tick, *_ in theirs], *settings)
        for tick, *command in commands:
            drive.run(tick)
            drive.note_request(tick)
            anew += drive.plan is not None
            drive.take(tick, *command)
        drive.run(until)
        why = (differs("pulse", drive.pulses, theirs, drive.exact) or differs("MCSTAT", drive.changes, changes) or
               differs("switching off", [(tick,) for tick in drive.others], [(tick,) for tick in others]))
        if why:
            sys.exit(f"cib: sequence {number}: {why}\nsettings {settings}, until {until}\n" + "\n".join(map(str, commands)))
        count += len(theirs)
        exact += sum(drive.exact)
        late += sum(a[0] != b[0] for a, b in zip(drive.pulses, theirs))
        turns += sum(a[1] == c[1] for a, c in zip(theirs, theirs[2:]))
    print(f"cib: {sequences} sequences, {count} pulses, {turns} turns, {anew} commands on the way, {exact} pulses exact, "
          f"{late} one tick off")
    if turns == 0 or count < 20 * sequences:
        sys.exit("cib: the sequences do too little")


if __name__ == "__main__":
    main()
