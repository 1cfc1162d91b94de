# SPDX-License-Identifier: MIT
"""Home search of a PMC over a plant of switches, slot by slot, from docs/PMC.md section 7 alone."""
from pmc_motion import SLOT, TICKS, WIDTH, Profile, ceil, endless, fixed, floor, move, stop

PULSES_MAX = 1 << 24


class Switch:
    """Active between low and high (None: without end); once it is, so much further."""

    def __init__(self, position, low=None, high=None, hysteresis=0):
        self.low, self.high, self.hysteresis, self.on = low, high, hysteresis, False
        self.follow(position)

    def follow(self, position):
        wider = self.hysteresis if self.on else 0
        self.on = (self.low is None or position >= self.low - wider) and (self.high is None or position <= self.high + wider)


class Plant:
    def __init__(self, position, switches):
        self.position = position
        self.switches = {name: Switch(position, *values) for name, values in switches.items()}

    def go_to(self, position):
        while self.position != position:
            self.position += 1 if position > self.position else -1
            for switch in self.switches.values():
                switch.follow(self.position)

    def on(self, name):
        return name in self.switches and self.switches[name].on


class Failed(Exception):
    """Error HOM."""


class Search:
    """One search from a slot on. run() returns the slot in which it ends; Failed: so does its argument."""

    def __init__(self, parameters, plant, slot):
        self.p, self.plant, self.slot = parameters, plant, slot

    def is_limit(self, sign):
        return self.plant.on("lmt+" if sign > 0 else "lmt-")

    def free_slot(self, begin, profile, n):
        """The first slot at or after pulse n + 10 us of a profile begun in a slot."""
        return -(-(begin * SLOT + profile.tick(n) + WIDTH) // SLOT)

    def drive(self, profile, sign, until):
        """Go along a profile; until(), asked in each slot behind its first, ends that. Returns what it said, place and speed
        then; None at the end of the profile, in the slot in which the motion is over."""
        self.start, self.begin, self.profile = self.plant.position, self.slot, profile
        while True:
            self.slot += 1
            ticks = (self.slot - self.begin) * SLOT
            self.plant.go_to(self.start + sign * profile.pulses_by(ticks - 1))
            made = profile.pulses_by(ticks)
            over = profile.end is not None and made >= floor(profile.end[1])
            hit = None if over else until()
            self.plant.go_to(self.start + sign * made)
            if hit:
                return hit, profile.at(fixed(ticks, TICKS))
            if over:
                self.slot = self.free_slot(self.begin, profile, floor(profile.end[1]))
                return None, None

    def stop_now(self):
        made = abs(self.plant.position - self.start)
        if made > 0:
            self.slot = max(self.slot, self.free_slot(self.begin, self.profile, made))

    def creep(self, sign, until):
        hit = until()
        if hit:
            return hit
        profile = Profile()
        profile.add(0, 0, fixed(self.p["home_low"] * self.p["m"]), 0)
        hit, _ = self.drive(profile, sign, until)
        self.stop_now()
        return hit

    def look(self, name, sign, wanted=True):
        if self.plant.on(name) == wanted:
            return "there"
        return "limit" if self.is_limit(sign) else None

    def ramp_down(self, sign, state):
        """AM8, but for a limit that stops at once."""
        profile = stop(self.p["s"], self.p["d"], state)
        sent = self.plant.position
        start, begin = sent - sign * floor(state[0]), self.slot
        while not self.p["slow"] and profile.pulses_by((self.slot - begin) * SLOT) < floor(profile.end[1]):
            self.slot += 1
            ticks = (self.slot - begin) * SLOT
            self.plant.go_to(start + sign * profile.pulses_by(ticks - 1))
            made = profile.pulses_by(ticks)
            is_limit = self.is_limit(sign)
            self.plant.go_to(start + sign * made)
            if is_limit and made < floor(profile.end[1]):
                last = made if start + sign * made != sent else 0
                if last:
                    self.slot = max(self.slot, self.free_slot(begin, profile, last))
                return
        n = floor(profile.end[1])
        self.plant.go_to(start + sign * n)
        self.slot = self.free_slot(begin, profile, n)

    def step_1(self, sign):
        hit = self.look("near", sign)
        if hit:
            return
        hit, state = self.drive(endless(*(self.p[k] for k in ("s", "high", "a", "d"))), sign, lambda: self.look("near", sign))
        if hit == "limit" and not self.p["slow"]:
            self.stop_now()
        else:
            self.ramp_down(sign, state)

    def away(self, sign):
        """Step 2 (c) and (a)."""
        if self.creep(-sign, lambda: self.look("home", -sign)) == "limit":
            raise Failed(self.slot)

    def back_off(self, sign):
        if self.plant.on("home") and self.creep(-sign, lambda: self.look("home", -sign, False)) == "limit":
            raise Failed(self.slot)

    def step_2(self, sign):
        turned = self.is_limit(sign) and not self.plant.on("home")
        if turned:
            self.away(sign)
        self.back_off(sign)
        while self.creep(sign, lambda: self.look("home", sign)) == "limit":
            if turned:
                raise Failed(self.slot)
            turned = True
            self.away(sign)
            self.back_off(sign)

    def step_3(self, sign):
        if self.plant.on("z") or self.creep(sign, lambda: self.look("z", sign)) == "limit":
            raise Failed(self.slot)

    def step_4(self, sign):
        if self.p["offset"] == 0:
            return
        if self.is_limit(sign):
            raise Failed(self.slot)
        hit, _ = self.drive(move(*(self.p[k] for k in ("s", "high", "a", "d")), self.p["offset"]), sign,
                            lambda: "limit" if self.is_limit(sign) else None)
        if hit:
            raise Failed(self.slot)

    def run(self):
        if not any(is_on for is_on, _ in self.p["steps"]):
            raise Failed(self.slot)
        for step, (is_on, sign) in zip((self.step_1, self.step_2, self.step_3, self.step_4), self.p["steps"]):
            if is_on:
                step(sign)
        return self.slot
