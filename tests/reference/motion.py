# SPDX-License-Identifier: MIT
"""Motions of the RKM04 by closed forms (docs/SPEC.md, section 6).

A motion is a list of legs. On a leg the square of the speed is a linear function of the place, which makes everything a closed
form: the time of a step is a square root, taken with 320 binary places. Squares of speeds and places are fractions; a motion
from rest has no other numbers.
"""

from bisect import bisect_right
from fractions import Fraction
from math import isqrt

PLACES = 320            # binary places of a root
FINE = 160              # binary places of a tick
WHOLE = 1 << (FINE - 100)  # nearer than 2^-100 tick to a whole tick: that tick (what is not exact is never so near)
MICRO = 10**6
NEARLY = Fraction(1, 10**6)  # R5


def tidy(number):
    """The number, rounded once it has more binary places than anything can depend on."""
    if number.denominator.bit_length() > 2 * PLACES:
        return Fraction((number.numerator << PLACES) // number.denominator, 1 << PLACES)
    return number


def root(square):
    """Square root of a fraction, and whether it is exact."""
    over, under = isqrt(square.numerator), isqrt(square.denominator)
    if over * over == square.numerator and under * under == square.denominator:
        return Fraction(over, under), True
    return Fraction(isqrt((square.numerator << (2 * PLACES)) // square.denominator), 1 << PLACES), False


def fixed(number, places):
    return (number.numerator << places) // number.denominator


class Leg:
    """A part of a motion with one acceleration: place and squared speed at both ends, time at which it begins."""

    def __init__(self, x0, q0, a, x1, q1):
        self.x0, self.q0, self.a, self.x1, self.q1 = x0, q0, a, x1, q1

    def set_time(self, t0, exact):
        """t0: seconds since the motion began. Returns the time at which the leg ends."""
        self.t0 = tidy(t0)
        self.v0, rational = root(self.q0)
        self.exact = exact and rational
        if self.a == 0:
            per_step = MICRO / self.v0
            self.c0 = fixed(MICRO * self.t0 - self.x0 * per_step, FINE)
            self.c1 = fixed(per_step, FINE)
            self.t1 = None if self.x1 is None else self.t0 + (self.x1 - self.x0) / self.v0
        else:
            scale = Fraction(MICRO * MICRO, 1) / (self.a * self.a)
            self.c0 = fixed(MICRO * (self.t0 - self.v0 / self.a), FINE)
            self.r0 = fixed(scale * (self.q0 - 2 * self.a * self.x0), 2 * FINE)
            self.r1 = fixed(scale * 2 * self.a, 2 * FINE)
            v1, rational = root(self.q1)
            self.ends_exact = self.exact and rational
            self.t1 = self.t0 + (v1 - self.v0) / self.a
        return self.t1

    def tick(self, step):
        """Ticks from the beginning of the motion to this step."""
        if self.a == 0:
            value = self.c0 + self.c1 * step
        else:
            way = isqrt(max(0, self.r0 + self.r1 * step))
            value = self.c0 + way if self.a > 0 else self.c0 - way
        return (value - WHOLE + (1 << FINE) - 1) >> FINE

    def at(self, t):
        """Place and speed at time t."""
        if self.a == 0:
            return tidy(self.x0 + self.v0 * (t - self.t0)), self.v0
        v = self.v0 + self.a * (t - self.t0)
        return tidy(self.x0 + (v * v - self.q0) / (2 * self.a)), tidy(v)


def shape(x0, q0, x1, q1, limit, a):
    """R1 between two places with given squared speeds: up, along, down."""
    top = limit * limit
    peak = (q0 + q1) / 2 + a * (x1 - x0)
    if peak > top:
        peak = Fraction(top)
    peak = max(peak, q0, q1)
    up, down = x0 + (peak - q0) / (2 * a), x1 - (peak - q1) / (2 * a)
    legs = [(x0, q0, a, up, peak), (up, peak, 0, down, peak), (down, peak, -a, x1, q1)]
    return [Leg(*leg) for leg in legs if leg[3] > leg[0]]


class Motion:
    """A motion of a motor. `parts`: (steps, V, A) each; steps None: without end. Places count from its very beginning."""

    def __init__(self, tick, start, parts, forward, met, limit_input=0):
        self.begin, self.start, self.forward = tick, start, forward
        self.parts, self.limit_input = [list(part) for part in parts], limit_input
        self.borders = []
        place = 0
        for steps, _, _ in parts:
            place = None if steps is None else place + steps
            self.borders.append(place)
        self.end = self.total = place
        self.done = 0
        self.stopping = False
        self.planned = True     # no stop, no change of speed since it began from rest
        self.met = met          # takes the clauses that are met
        self.pristine = True    # no stop, no change of speed, no hold so far
        self.last = None        # tick of the last pulse
        self.due = None         # tick of the next one
        self.legs = []
        self.go_from(tick)

    # ---- planning -----------------------------------------------------------------------------------------------------

    def part_at(self, place):
        """A border belongs to the later part."""
        for i, border in enumerate(self.borders):
            if border is None or place < border:
                return i
        return len(self.borders) - 1

    def go_from(self, tick):
        """From rest at the present step (R1; again after C75)."""
        self.begin, self.end, self.stopping = tick, self.total, False
        self.met(f"R1 R4 motion of {min(len(self.parts), 3)}{' or more' if len(self.parts) > 2 else ''} parts"
                 f"{', goes on' if self.done else ''}{', endless' if self.total is None else ''}")
        i = self.part_at(self.done)
        speed = Fraction(min(self.start, self.parts[i][1])) ** 2
        x = Fraction(self.done)
        if self.total is not None:
            speed = min(speed, self.reach(i, x))
        self.pristine = self.done == 0
        self.take(self.plan(x, speed, i), Fraction(0), True)
        self.planned = True

    def exits(self, i):
        """Backward pass of R4: the highest squared speed at the end of part i and of each later one."""
        last = len(self.parts) - 1
        square = Fraction(min(self.start, self.parts[last][1])) ** 2
        found = {last: square}
        for j in range(last, i, -1):
            steps, limit, a = self.parts[j]
            cap = min(self.parts[j - 1][1], limit) ** 2
            square = min(Fraction(cap), square + 2 * a * steps)
            found[j - 1] = square
        return found

    def reach(self, i, x):
        """The highest squared speed at place x of part i from which its end can be met."""
        return self.exits(i)[i] + 2 * self.parts[i][2] * (self.borders[i] - x)

    def plan(self, x, q, i):
        """Forward pass of R4 from place x of part i with squared speed q."""
        if self.total is None:
            _, limit, a = self.parts[0]
            return self.without_end(x, q, limit, a)
        exits, legs = self.exits(i), []
        for j in range(i, len(self.parts)):
            _, limit, a = self.parts[j]
            to = Fraction(self.borders[j])
            out = min(exits[j], q + 2 * a * (to - x))
            legs += shape(x, q, to, out, limit, a)
            x, q = to, out
        return legs

    @staticmethod
    def without_end(x, q, limit, a):
        legs, top = [], Fraction(limit * limit)
        if q < top:
            up = x + (top - q) / (2 * a)
            legs.append(Leg(x, q, a, up, top))
            x = up
        return legs + [Leg(x, top, 0, None, top)]

    def take(self, legs, t, exact):
        self.legs = legs
        for leg in legs:
            t = leg.set_time(t, exact)
            exact = leg.exact if leg.a == 0 else leg.ends_exact
        self.starts = [leg.x0 for leg in legs]
        self.look_ahead()

    # ---- running ------------------------------------------------------------------------------------------------------

    def tick(self, step):
        i = bisect_right(self.starts, step)
        i = max(0, i - 1)
        if self.starts and i > 0 and self.starts[i] == step:
            i -= 1
        return self.begin + self.legs[i].tick(step)

    def look_ahead(self):
        self.due = None
        if self.end is None or self.done < self.end:
            self.due = self.tick(self.done + 1)

    def step(self):
        """The next pulse. Returns its tick."""
        tick = self.due
        self.done += 1
        self.last = tick
        self.look_ahead()
        return tick

    def over(self):
        return self.end is not None and self.done >= self.end

    def exact(self):
        """Is it a single motion from rest, not disturbed (R2)?"""
        return self.planned and len(self.parts) == 1

    def points(self):
        """Break points as (step, speed) of a motion that nothing has disturbed (P7)."""
        corners = [leg for i, leg in enumerate(self.legs) if i == 0 or leg.a != self.legs[i - 1].a]
        found = []
        for leg in corners:
            step = leg.x0.numerator // leg.x0.denominator + 1
            point = (step if self.total is None else min(step, self.total), leg.v0.numerator // leg.v0.denominator)
            if point not in found[-1:]:
                found.append(point)
        return found + ([] if self.total is None else [(self.total, 0)])

    def now(self, tick):
        """Leg, place, speed at this tick, and whether they are exact."""
        t = Fraction(tick - self.begin, MICRO)
        i = 0
        while i + 1 < len(self.legs) and t >= self.legs[i].t1:
            i += 1
        leg = self.legs[i]
        x, v = leg.at(t)
        return i, x, v, leg.exact

    def on_final_ramp(self, i):
        return self.total is not None and all(leg.a < 0 for leg in self.legs[i:])

    # ---- R5, R6 -------------------------------------------------------------------------------------------------------

    def stop(self, tick):
        """K, M, N, X (R5)."""
        i, x, v, exact = self.now(tick)
        self.stopping, self.pristine = True, False
        if self.on_final_ramp(i):
            self.met("R5 a stop on the final ramp")
            return
        self.met(f"R5 a stop at a speed {'above' if v > self.start else 'of at most'} S{', inexact' if not exact else ''}")
        q, slow, j, legs = v * v, Fraction(self.start**2), self.part_at(x), []
        while q > slow and not self.limit_input:
            a, border = self.parts[j][2], self.borders[j]
            to, left = x + (q - slow) / (2 * a), slow
            if border is not None and to > border and j + 1 < len(self.parts):
                to, left = Fraction(border), q - 2 * a * (border - x)
                j += 1
            legs.append(Leg(x, q, -a, to, left))
            x, q = tidy(to), tidy(left)
        self.end = self.whole(x, exact)
        if self.total is not None:
            self.end = min(self.end, self.total)
        self.end = max(self.end, self.done)
        if self.end > x:
            legs.append(Leg(x, q, 0, Fraction(self.end), q))
        self.planned = self.pristine = False
        self.take(legs, Fraction(tick - self.begin, MICRO), exact)

    def whole(self, x, exact):
        below = x.numerator // x.denominator
        above = x - below
        if 0 < above < 2 * NEARLY:
            self.met("R5 a stop next to a whole step")
        if above == 0 or (not exact and above < NEARLY):
            return below
        return below + 1

    def change(self, tick, speed):
        """C4 (R6)."""
        i, x, v, exact = self.now(tick)
        if self.limit_input or self.stopping or self.on_final_ramp(i):
            self.met("R6 without effect")
            return
        self.met(f"R6 a change to {'more' if speed > v else 'less'}, {'compound' if len(self.parts) > 1 else 'single'}")
        j = self.part_at(x)
        self.parts[j][1] = speed
        a, q, slow = self.parts[j][2], tidy(v * v), self.start
        most = None if self.total is None else tidy(self.reach(j, x))
        legs = []
        if speed >= v:
            if v < slow:
                at_once = Fraction(min(speed, slow)) ** 2
                if most is not None:
                    at_once = min(at_once, most)
                q = max(q, at_once)
        elif v <= slow:
            q = Fraction(speed * speed)
        else:
            low = max(speed, slow) ** 2
            to = x + (q - low) / (2 * a)
            if most is not None and (speed >= slow and q >= most or to >= self.borders[j]):
                to = Fraction(self.borders[j])
                left = q - 2 * a * (to - x)
                self.met("R6 the border is too near")
                legs.append(Leg(x, q, -a, to, left))
                x, q, j = to, tidy(left), j + 1
            else:
                if to > x:
                    legs.append(Leg(x, q, -a, to, Fraction(low)))
                x, q = tidy(to), Fraction(min(low, speed * speed))
        if j < len(self.parts):
            legs += self.plan(x, q, j)
        self.planned = self.pristine = False
        self.take(legs, Fraction(tick - self.begin, MICRO), exact)
