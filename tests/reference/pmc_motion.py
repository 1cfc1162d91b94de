# SPDX-License-Identifier: MIT
"""Motions of a PMC in exact arithmetic, from docs/PMC.md alone: nothing here is taken from the product. Places and times are
solved in closed form with 420 binary places; what lies nearer to a whole number than 2^-300 is that number."""
import math

PLACES = 420
ONE = 1 << PLACES
NEAR = 1 << (PLACES - 300)
TICKS = 8_000_000
SLOT = TICKS // 1000
WIDTH = TICKS // 100_000  # 10 us


def fixed(number, divisor=1):
    return (number << PLACES) // divisor


def product(a, b):
    return a * b >> PLACES


def quotient(a, b):
    return (a << PLACES) // b


def root(a):
    return math.isqrt(max(a, 0) << PLACES)


def near(a):
    """The whole number that `a` is, or None."""
    whole = (a + ONE // 2) >> PLACES
    return whole if abs(a - (whole << PLACES)) < NEAR else None


def ceil(a):
    whole = near(a)
    return -(-a >> PLACES) if whole is None else whole


def floor(a):
    whole = near(a)
    return a >> PLACES if whole is None else whole


class Profile:
    """Legs (time, place, speed, acceleration), then the end (time, place) or None. Place in pulses, time in seconds."""

    def __init__(self):
        self.legs, self.end = [], None

    def add(self, t, x, v, acceleration):
        self.legs.append((t, x, v, acceleration))

    def leg_at(self, t):
        return max((i for i, leg in enumerate(self.legs) if leg[0] <= t + NEAR), default=0)

    def at(self, t):
        """Place and speed at a time."""
        if self.end is not None and t >= self.end[0] - NEAR:
            return self.end[1], 0
        t0, x0, v0, acceleration = self.legs[self.leg_at(t)]
        dt = t - t0
        return x0 + product(v0, dt) + product(acceleration, product(dt, dt)) // 2, v0 + product(acceleration, dt)

    def is_final(self, t):
        """On the ramp that leads to the end."""
        return self.end is not None and self.leg_at(t) == len(self.legs) - 1 and self.legs[-1][3] < 0

    def time(self, k):
        k = fixed(k)
        if self.end is not None and k >= self.end[1] - NEAR:
            return self.end[0]
        for t0, x0, v0, acceleration in reversed(self.legs):
            if k >= x0 - NEAR:
                way = k - x0
                if acceleration == 0:
                    return t0 + quotient(way, v0)
                return t0 + quotient(2 * way, v0 + root(product(v0, v0) + 2 * product(acceleration, way)))
        raise ValueError

    def tick(self, k):
        return ceil(self.time(k) * TICKS)

    def pulses_by(self, tick):
        n = floor(self.at(fixed(tick, TICKS))[0])
        return n if self.end is None else min(n, floor(self.end[1]))


def squares(v, u):
    return product(v, v) - product(u, u)


def come_down(p, t, x, u, v, s, d):
    """From u to a lower v: by d above s, at once below (AM7). Adds the leg; returns time and place behind it."""
    down_to = max(v, s) if u > s else u
    if down_to < u:
        p.add(t, x, u, -d)
        return t + quotient(u - down_to, d), x + quotient(squares(u, down_to), 2 * d)
    return t, x


def move(s, v, a, d, n, start=None):
    """AM1, AM2, AM7. start: place and speed of a motion under way at time 0; n counts from its begin."""
    s, v, a, d, n = (fixed(q) for q in (s, v, a, d, n))
    p = Profile()
    e = min(s, v)
    t, x, u = 0, *(start or (0, e))
    if u > v:
        t, x = come_down(p, t, x, u, v, s, d)
        u = v
    elif u < s:
        u = e
    rest = n - x
    top = quotient(2 * product(product(a, d), rest) + product(d, product(u, u)) + product(a, product(e, e)), a + d)
    peak = max(u, min(v, root(top))) if v > e else v
    up, down = quotient(squares(peak, u), 2 * a), quotient(squares(peak, e), 2 * d)
    if up > NEAR:
        p.add(t, x, u, a)
        t, x = t + quotient(peak - u, a), x + up
    level = n - down - x
    if level > NEAR:
        p.add(t, x, peak, 0)
        t, x = t + quotient(level, peak), x + level
    if down > NEAR:
        p.add(t, x, peak, -d)
        t += quotient(peak - e, d)
    p.end = (t, n)
    return p


def endless(s, v, a, d, start=None):
    """AM6, AM7."""
    s, v, a, d = (fixed(q) for q in (s, v, a, d))
    p = Profile()
    t, x, u = 0, *(start or (0, min(s, v)))
    if u > v:
        t, x = come_down(p, t, x, u, v, s, d)
    else:
        u = max(u, min(s, v))
        if u < v:
            p.add(t, x, u, a)
            t, x = t + quotient(v - u, a), x + quotient(squares(v, u), 2 * a)
    p.add(t, x, v, 0)
    return p


def stop(s, d, start):
    """AM8."""
    s, d = fixed(s), fixed(d)
    x, u = start
    p = Profile()
    if u <= s:
        n = fixed(ceil(x))
        p.add(0, x, u, 0)
        p.end = (quotient(n - x, u), n)
        return p
    place = x + quotient(squares(u, s), 2 * d)
    n, t = fixed(ceil(place)), quotient(u - s, d)
    p.add(0, x, u, -d)
    if n - place > NEAR:
        p.add(t, place, s, 0)
        t += quotient(n - place, s)
    p.end = (t, n)
    return p


class Course:
    """What a motion does between changes: profiles, each from a tick and a place on."""

    def __init__(self, tick, profile):
        self.parts = [(tick, 0, profile)]

    def state(self, tick):
        begin, _, profile = self.parts[-1]
        return profile.at(fixed(tick - begin, TICKS))

    def is_final(self, tick):
        begin, _, profile = self.parts[-1]
        return profile.is_final(fixed(tick - begin, TICKS))

    def is_over(self, tick):
        begin, _, profile = self.parts[-1]
        return profile.end is not None and begin + ceil(profile.end[0] * TICKS) <= tick

    def change(self, tick, profile):
        self.parts.append((tick, profile.legs[0][1], profile))

    def total(self):
        return floor(self.parts[-1][2].end[1])

    def tick(self, k):
        """The tick of pulse k; one at the very place of a change is of the part before."""
        begin, _, profile = next(part for part in reversed(self.parts) if part[1] < fixed(k) - NEAR or part is self.parts[0])
        return begin + profile.tick(k)
