# SPDX-License-Identifier: MIT
"""A reference RKM04: four motors, time, inputs and messages (docs/SPEC.md, sections 1 to 3). It is written to be read and
compared with the specification, not to be fast. Times are ticks of 1 us."""

from collections import Counter

import language
from language import Refused
from motor import MEMORY, SLOT, Motor, next_slot


class Unit:
    def __init__(self, readings):
        self.readings = readings
        self.now = 0                # first tick that is not done
        self.inputs = self.outputs = self.variables = 0
        self.seen_inputs = 0        # as they count
        self.sampled = [(0, 0)] * 8  # state of each input in the slots, and the slot since which it has it
        self.busy_until = 0         # a store (reading store-time)
        self.simulation = False
        self.notes = []             # (tick, motor, what, value)
        self.pulses = [[] for _ in range(5)]  # ticks, by motor
        self.loose = [set() for _ in range(5)]  # places in `pulses` that may be a tick off (R2)
        self.marks = []
        self.busy = True
        self.seen = Counter()       # clauses met
        self.motors = [Motor(self, number) for number in range(1, 5)]

    # ---- what motors say and ask --------------------------------------------------------------------------------------

    def note(self, tick, motor, what, value):
        self.busy = True
        self.notes.append((tick, motor, what, value))

    def pulse(self, motor, tick):
        if not self.simulation:
            if not motor.motion.exact():
                self.loose[motor.number].add(len(self.pulses[motor.number]))
            self.pulses[motor.number].append(tick)

    def bit(self, number):
        """DI 1-8 or VAR 80-95."""
        if number >= 80:
            return bool(self.variables >> (number - 80) & 1)
        return bool(self.seen_inputs >> (number - 1) & 1)

    def set(self, tick, number, on):
        if number >= 80:
            bit, before = 1 << (number - 80), self.variables
            self.variables = before | bit if on else before & ~bit
            if self.variables != before:
                self.note(tick, 0, "variable", self.variables)
        else:
            bit = 1 << (number - 1)
            self.put_outputs(tick, self.outputs | bit if on else self.outputs & ~bit)

    def put_outputs(self, tick, mask):
        if mask != self.outputs:
            self.outputs = mask
            if not self.simulation:
                self.note(tick, 0, "outputs", mask)

    def mark(self, numbers, tick):
        """T51-58: outputs to be set at a tick (C12)."""
        self.marks.append((tick, sum(1 << (n - 1) for n in numbers)))
        if tick % SLOT == 0:
            self.set_marks()

    def set_marks(self):
        for tick, mask in sorted(self.marks):
            self.put_outputs(tick, self.outputs | mask)
        self.marks = []

    def simulate(self, tick, on):
        if on != self.simulation:
            self.simulation = on
            if self.outputs:
                self.note(tick, 0, "outputs", 0 if on else self.outputs)

    def reset_motor(self, motor, tick):
        if motor.state == "moving":
            self.note(tick, motor.number, "motion", 0)
        if motor.led:
            self.note(tick, motor.number, "led", 0)
        if self.index(motor):
            self.note(tick, motor.number, "command", 0)
        if motor.fault:
            self.note(tick, motor.number, "fault", 0)
        motor.reset(tick)
        if self.readings["reset-t41"] == "clear":
            self.simulate(tick, False)
        self.busy = True

    # ---- time (K2, K3) ------------------------------------------------------------------------------------------------

    def pulses_to(self, tick):
        for motor in self.motors:
            motor.run_to(tick)
        self.set_marks()

    def advance_to(self, tick):
        """Does the ticks before this one."""
        slot = next_slot(self.now)
        while slot < tick:
            self.pulses_to(slot)
            self.sample(slot)
            for motor in self.motors:
                motor.turn(slot)
            slot += SLOT
            if not self.busy and self.inputs == self.seen_inputs and slot > self.busy_until + SLOT:
                wakes = [wake for wake in (motor.wake() for motor in self.motors) if wake is not None]
                slot = max(slot, next_slot(min(wakes, default=tick)))
            self.busy = False
        self.pulses_to(tick - 1)
        self.now = tick

    def sample(self, slot):
        """An input counts when it has been constant for so long, as seen in the slots (reading input-filter)."""
        for i in range(8):
            level = self.inputs >> i & 1
            if level != self.sampled[i][0]:
                self.sampled[i] = (level, slot)
            if slot - self.sampled[i][1] >= self.readings["input-filter"] * SLOT:
                self.seen_inputs = self.seen_inputs & ~(1 << i) | level << i

    def set_inputs(self, mask):
        self.inputs = mask
        self.busy = True

    # ---- messages -----------------------------------------------------------------------------------------------------

    def message(self, data):
        """A message at this tick. Returns the answer, or None if the reference does not know it."""
        self.busy = True
        number, who = data[0], data[1] - ord("0")
        some = self.motors if who == 0 else [self.motors[who - 1]]
        if number == 2:
            return data[:2] + self.set_command(some, data[2:])
        if number == 3:             # into a unit without flash
            self.busy_until = self.now + self.readings["store-time"] * SLOT
            return data[:2] + b"\x01"
        if number == 4:
            fields = (b"%10d" % self.counter(motor) for motor in some)
            return data[:2] + b"".join(bytes([len(field)]) + field for field in fields)
        if who == 0:
            return data[:2] + b"ERROR COMMAND! "
        if number == 5:
            return data[:2] + " ".join(language.canonical(c) for c in some[0].tape.values()).encode()
        if number == 6:
            return self.points(data[:2], some[0].motion)
        return data[:2] + b" %d; %d" % (self.steps(some[0]), self.index(some[0]))

    @staticmethod
    def points(head, motion):
        """Get Tabul Run (P7), but of motions that nothing has disturbed only."""
        if motion is not None and not motion.pristine:
            return None
        points = [] if motion is None else motion.points()
        return head + b" %d;[%s]" % (len(points), ",".join("(%d;%d)" % point for point in points).encode())

    def set_command(self, motors, text):
        try:
            commands = language.parse(text, self.readings["negative-position"] == "yes")
        except Refused as refused:
            self.seen[f"P1 flag {refused.flag}"] += 1
            return bytes([refused.flag, refused.character])
        alone = len(commands) == 1 and (self.readings["v-alone"] == "blanks" or language.is_bare(text))
        return bytes([max([motor.receive(commands, alone, self.now) for motor in motors]), 0])

    @staticmethod
    def counter(motor):
        return (motor.position + 2**31) % 2**32 - 2**31

    @staticmethod
    def steps(motor):
        return motor.motion.done % 2**32 if motor.motion else 0

    @staticmethod
    def index(motor):
        if motor.state in ("held", "ended", "fault") and motor.fresh is not None:
            return max(motor.fresh, motor.oldest()) % MEMORY + 1
        if motor.state in ("idle", "ended"):
            return 0
        if motor.state == "held" and motor.held == "ready" and motor.next < motor.written:
            return max(motor.next, motor.oldest()) % MEMORY + 1
        return motor.current % MEMORY + 1
