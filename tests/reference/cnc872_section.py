# SPDX-License-Identifier: MIT
"""Ways of blocks and sections of the CNC872 in whole numbers, from the text of its specification alone (NM5 to NM8)."""
from math import isqrt

from cnc872_path import Path, to_acceleration, to_speed

NORMAL, RAPID, EMERGENCY = range(3)
ENDLESS = 2**31 - 1


class Segment:
    def __init__(self, machine, index, start):
        block = machine.program[index]
        self.index, self.start = index, dict(start)
        self.way = {axis: target - start[axis] for axis, target in block.targets.items() if target != start[axis]}
        self.length = isqrt(sum(way * way for way in self.way.values()))

    def project(self, value):
        return min(value(axis) * self.length // abs(way) for axis, way in self.way.items())


class Section:
    def __init__(self, machine, first, start):
        self.machine, self.segments, self.path, self.goes, self.now = machine, [], None, False, 0
        self.rapid, self.length, self.look = machine.program[first].g == 0, 0, None
        for index in range(first, len(machine.program)):
            segment = Segment(machine, index, start)
            if not segment.way or (self.segments and not self.goes_on(self.segments[-1], segment)):
                break
            self.length += segment.length
            segment.border = self.length
            self.segments.append(segment)
            start = {**start, **machine.program[index].targets}
            if len(self.segments) == 15 or machine.block_by_block:
                break
        self.axes = {axis for segment in self.segments for axis in segment.way}
        self.asked = None

    def is_left(self):
        """Do axes stand elsewhere than the path has left them, or than it begins?"""
        place = self.place()[0] if self.path else self.segments[0].start
        return any(self.machine.position[axis] != place[axis] for axis in self.axes)

    def linear(self, segment):
        return segment.project(lambda axis: to_acceleration(self.machine.axes[axis]["linear"][NORMAL]))

    def change(self, segment):
        """ParabAccel along the path, u/T^3."""
        return min(self.machine.axes[axis]["parabolic"][NORMAL] * 1000 * 65536 / 1e6 * segment.length / abs(way)
                   for axis, way in segment.way.items())

    def goes_on(self, one, two):
        a, b = self.machine.program[one.index], self.machine.program[two.index]
        if not (a.continuous and b.continuous) or 0 in (a.g, b.g) or a.has_delay or b.has_delay or a.m in (0, 1, 2, 30):
            return False
        dot = sum(way * two.way.get(axis, 0) for axis, way in one.way.items())
        square = lambda segment: sum(way * way for way in segment.way.values())
        return dot > 0 and dot * dot * 10**12 >= 984807**2 * square(one) * square(two)

    def set_of(self, which):
        """Acceleration and n of the whole."""
        machine = self.machine
        if which == NORMAL and self.asked:
            return self.asked
        key = "linear" if machine.parabolic else "acceleration"
        a = min(segment.project(lambda axis: to_acceleration(machine.axes[axis][key][which])) for segment in self.segments)
        n = 1
        if machine.parabolic:
            n = max(self.smoothing(axis, which) for axis in self.axes)
        return max(1, a), n

    def smoothing(self, axis, which):
        linear, parabolic = self.machine.axes[axis]["linear"][which], self.machine.axes[axis]["parabolic"][which]
        return min(1000, max(1, (2 * linear + parabolic) // (2 * parabolic)))

    def target(self, segment):
        machine, block = self.machine, self.machine.program[segment.index]
        rapid = segment.project(lambda axis: to_speed(machine.axes[axis]["feed_rapid"]))
        percent, multiplier = machine.override()
        if block.g == 0:
            speed, limit = rapid * percent * multiplier // 10**6, "LIMIT_FEED_G00"
        else:
            percent, multiplier = (1000, 1000) if block.g == 33 else (percent, multiplier)
            turns = machine.cells["ACT_SPEED_PM"] if block.turns else 1000
            speed, limit = block.feed * percent * multiplier * turns * 16384 // (15 * 10**9), "LIMIT_FEED"
        speed = min(speed, rapid)
        if machine.cells[limit + "_REQ"]:
            speed = min(speed, max(0, machine.cells[limit]))
        if any(machine.cells[f"ZP{axis}{sign}"] for axis in self.axes for sign in "01"):
            speed = min(speed, segment.project(lambda axis: to_speed(machine.axes[axis]["feed_slow"])))
        return speed

    def at(self, way):
        return next((k for k, segment in enumerate(self.segments) if way < segment.border), len(self.segments) - 1)

    def place(self):
        """Positions of the axes, and the segment."""
        segment = self.segments[self.at(self.path.done)]
        way, place = self.path.done - (segment.border - segment.length), {}
        for axis in self.axes:
            part = abs(segment.way.get(axis, 0)) * way // segment.length
            place[axis] = segment.start[axis] + (part if segment.way.get(axis, 0) > 0 else -part)
        return place, segment

    def begin(self):
        if self.path is None:
            asked = self.machine.cells["dwAxGLinearAccel"]
            if self.machine.parabolic and not self.rapid and self.machine.cells["REQ_LINEARACCEL"] and asked > 0:
                self.asked = asked, max(int(min(1000, max(1, asked / self.change(segment) + 0.5))) for segment in self.segments)
            self.path = Path(self.length, *self.set_of(RAPID if self.rapid else NORMAL))
        self.goes = True

    def lowest(self, path, targets):
        return min(targets[self.at(path.done):self.at(path.length - path.left) + 1])

    def allows(self, path, targets):
        def check(w):
            at = path.length - path.left
            for segment, target in zip(self.segments, targets[1:]):
                distance = segment.border - at - (target * (path.n + 1) // 2 if path.n > 1 else 0)
                if segment.border > at and w > target:
                    total, i = w, 1
                    while w - i * path.a > target:
                        total, i = total + w - i * path.a, i + 1
                    if total > distance:
                        return False
            return True
        return check

    def time_to_end(self, targets):
        path, time = self.path.copy(), 0
        while path.rest() > 0:
            target = self.lowest(path, targets)
            path.step(target, None, self.allows(path, targets))
            time += 1
            if target == 0 and path.is_at_rest():
                return ENDLESS
        return time

    def step(self, hold):
        """One T under a hold: None, "STOP", "LIMIT", "EMERGENCY", "ENABLE" or "ERROR"."""
        machine, path, held, cap = self.machine, self.path, hold is not None, None
        at_once = hold == "ERROR" or (hold == "ENABLE" and machine.parabolic)
        which = {None: RAPID if self.rapid else NORMAL, "LIMIT": RAPID if machine.parabolic else EMERGENCY,
                 "STOP": RAPID}.get(hold, EMERGENCY)
        a, n = self.set_of(which)
        if at_once:
            path.halt()
        elif machine.parabolic:
            held = path.change(a, n) and held
        elif held:
            cap = a
        targets = [self.target(segment) for segment in self.segments]
        if len(self.segments) > 1:
            machine.cells["G23ACT"] = 1
            look = (targets, hold, path.a, path.n)
            if hold is None:
                time = machine.cells["TIME_DIST"] if look == self.look else self.time_to_end(targets)
                machine.cells["TIME_DIST"] = time - (time < ENDLESS)
            self.look = look
        if at_once:
            return
        path.step(0 if held else self.lowest(path, targets), cap, self.allows(path, targets))
        if path.rest() == 0:
            machine.cells["G23ACT"] = machine.cells["TIME_DIST"] = 0
