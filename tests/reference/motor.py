# SPDX-License-Identifier: MIT
"""One motor of the RKM04: its tape and its interpreter (docs/SPEC.md, sections 2, 5 and 6)."""

import language
from motion import Motion

SLOT = 1000
MEMORY = 700
HIDDEN = 10   # ticks from the last pulse to the end of a motion (K4)

NO_LABEL, LOOP_LEVELS, NO_LOOP, CALL_LEVELS, NO_CALL, OVERWRITTEN, MOTION_FAULT = range(1, 8)


def next_slot(tick):
    """The first slot at or after a tick."""
    return max(1, -(-tick // SLOT)) * SLOT


class Motor:
    def __init__(self, unit, number):
        self.unit, self.number, self.readings = unit, number, unit.readings
        self.position = 0
        self.motion = None
        self.reset(0)

    def reset(self, tick):
        """`\\` (C1)."""
        last = self.motion.last if tick and self.motion else None
        self.tape = {}              # number of arrival -> command
        self.written = 0
        self.next = self.current = 0
        self.state = "idle"
        self.due = 0 if last is None else last + HIDDEN
        self.motion = None
        self.after = None           # what follows a stop: None, "rest", "next" (hold), "end"
        self.held = None            # what a hold goes back to
        self.remain = 0             # of a held dwell, ticks
        self.planned = None         # the command of a motion being planned (reading planning)
        self.resume = False
        self.fresh, self.hold_fresh = None, False
        self.requests, self.change = [], None
        self.loops, self.calls = [], []
        self.start, self.speed, self.acceleration = 100, 1000, 2000
        self.count, self.forward = 0, True
        self.table, self.marks = [], frozenset()
        self.functions, self.keep = set(), False
        self.guards = {}
        self.fault = 0
        self.led = 0
        self.marked = frozenset()   # outputs to be set when the last segment begins

    def met(self, clause):
        self.unit.seen[clause] += 1

    # ---- the tape -----------------------------------------------------------------------------------------------------

    def oldest(self):
        return max(0, self.written - MEMORY)

    def receive(self, commands, alone, tick):
        """Commands of a message for this motor (C1-C4, C10); alone: it is just one. Returns the flag."""
        for i in range(len(commands) - 1, -1, -1):
            if commands[i] == ("\\",):
                self.met(f"C1 reset when {self.state}")
                self.unit.reset_motor(self, tick)
                self.store(commands[i + 1:])
                return self.flag
        if alone and self.alone(commands[0], tick):
            return 0
        self.store(commands)
        return self.flag

    def alone(self, command, tick):
        """K, C75 and V as the only command. Returns whether it was taken as such."""
        if command == ("K",):
            self.ask_hold()
        elif command == ("C", 75):
            self.ask_resume()
        elif command[0] == "V" and self.state == "moving":
            self.met("C4 V in a motion")
            if "K" not in self.requests and not self.motion.stopping and not self.motion.limit_input:
                self.ask_change(command[1], tick)
        else:
            return False
        return True

    def store(self, commands):
        self.flag = 0
        commands = [c for c in commands if c not in (("K",), ("C", 75))]
        first = self.written
        for command in commands:
            if len(self.tape) >= MEMORY:
                self.flag = 3
                self.met(f"C10 memory full, T40 {'on' if self.keep else 'off'}")
                if self.keep:
                    break
                del self.tape[self.written - MEMORY]
            self.tape[self.written] = command
            self.written += 1
        if self.written == first:
            return
        if self.fresh is not None:
            self.hold_fresh = self.hold_fresh and self.readings["hold-exit"] == "latch"
        elif self.ends_with_new():
            self.fresh, self.hold_fresh = first, False
        if self.state == "idle":
            self.state, self.current = "ready", max(first, self.oldest())

    def label(self, number):
        return max((n for n, c in self.tape.items() if c == ("@", number)), default=None)

    # ---- K, C75, V (C3, C4) -------------------------------------------------------------------------------------------

    def ends_with_new(self):
        """Will the motor stand still, with new commands as a way out?"""
        if self.state == "ended" or self.after == "end":
            return True
        if self.state == "fault":
            return self.readings["fault-exit"] == "new"
        return self.readings["hold-exit"] == "new" and self.holding()

    def holding(self):
        """Is a hold in force or asked for, all requests so far taken into account?"""
        held = (self.state == "held" or self.after in ("rest", "next")) and not self.resume
        for request in self.requests:
            if request in ("K", "C"):
                held = request == "K"
        return held

    def ask_hold(self):
        self.met(f"C3 K when {self.state}{' and stopping' if self.state == 'moving' and self.motion.stopping else ''}")
        if self.fresh is not None:
            self.hold_fresh = True
        elif self.state in ("ended", "fault") or self.after == "end":
            return
        elif self.state != "idle" and (self.state != "ready" or self.next < self.written):
            self.requests.append("K")

    def ask_resume(self):
        self.met(f"C3 C75 when {self.state}")
        if self.fresh is not None:
            self.hold_fresh = False
        elif self.state == "held" or self.after in ("rest", "next") or "K" in self.requests:
            self.requests.append("C")

    def ask_change(self, speed, tick):
        if self.change is None:
            self.change = [tick + self.readings["speed-change"] * SLOT, speed]
            self.requests.append("V")
        else:
            self.change[1] = speed

    def obey(self, tick):
        """The pending requests, in order of arrival."""
        waiting, self.requests = self.requests, []
        for request in waiting:
            if request == "K":
                self.hold(tick)
            elif request == "C":
                self.resume = self.state == "held" or self.after in ("rest", "next")
            elif self.change is not None:
                if self.change[0] > tick:
                    self.requests.append("V")
                else:
                    speed, self.change = self.change[1], None
                    if self.state == "moving":
                        self.motion.change(tick, speed)

    def look_for_new(self, tick):
        stands = self.state in ("held", "ended", "fault")
        if stands and self.fresh is not None and (self.hold_fresh or tick >= self.due):
            self.begin_fresh(tick)

    def hold(self, tick):
        self.change = None
        if self.state == "moving":
            self.resume = False
            if not self.motion.stopping:
                self.after = "rest"
                self.stop(tick)
            elif self.after is None:
                self.after = "next"
        elif self.state == "held":
            self.resume = False
        elif self.state in ("idle", "ended", "fault") or self.state == "ready" and self.next >= self.written:
            return
        else:
            self.held = self.state
            if self.state == "dwell":
                self.remain = max(0, self.due - tick)
                self.due = tick
            self.state = "held"

    def begin_fresh(self, tick):
        self.met(f"C3 new commands when {self.state}")
        self.next = self.fresh
        self.loops, self.calls = [], []
        self.motion = None
        self.after = None
        self.resume = False
        self.due = max(self.due, tick)
        if self.hold_fresh:
            self.state, self.held = "held", "ready"
        else:
            self.state, self.fresh, self.current = "ready", None, max(self.fresh, self.oldest())

    def go_on(self, tick):
        """C75."""
        self.met(f"C3 goes on with {self.held}")
        self.resume = False
        self.state = self.held
        if self.held == "dwell":
            self.due = tick + self.remain
        elif self.held == "moving":
            motion = self.motion
            if motion.total is not None and motion.done >= motion.total:
                self.motion, self.state = None, "ready"
            elif self.ends_at_once(motion.limit_input):  # no further step: its one slot
                self.motion, self.state, self.due = None, "ready", tick + SLOT
            else:
                self.motion.go_from(tick)
                self.light(tick, 1)
                self.unit.note(tick, self.number, "motion", 1)

    # ---- motions ------------------------------------------------------------------------------------------------------

    def stop(self, tick):
        self.motion.stop(tick)
        if self.motion.over():
            self.over(tick)

    def over(self, tick):
        """The motion has ended: with its last pulse, or at once in a slot."""
        last = self.motion.last
        self.due = 0 if last is None else last + HIDDEN
        self.unit.note(tick, self.number, "motion", 0)
        self.change = None
        if self.led == 1:
            self.light(tick, 0)
        after, self.after = self.after, None
        if after == "rest":
            self.state, self.held = "held", "moving"
            return
        self.motion = None
        if after == "next":
            self.state, self.held = "held", "ready"
        elif after == "end":
            self.end(tick)
        else:
            self.state = "ready"

    def end(self, tick):
        self.state, self.motion = "ended", None
        self.unit.note(tick, self.number, "command", 0)

    def run_to(self, tick):
        """Pulses up to and with this tick."""
        while self.state == "moving" and self.motion.due is not None and self.motion.due <= tick:
            motion = self.motion
            at = motion.step()
            self.position += 1 if motion.forward else -1
            self.unit.pulse(self, at)
            if self.marked and len(motion.borders) > 1 and motion.done == motion.borders[-2]:
                self.met("C12 the last segment begins")
                self.unit.mark(self.marked, at)
                self.marked = frozenset()
            if motion.over():
                self.over(at)

    def move(self, tick, parts, forward, limit_input=0):
        """Begin a motion."""
        self.motion = Motion(tick, self.start, parts, forward, self.met, limit_input)
        self.after, self.change = None, None
        if self.ends_at_once(limit_input):
            self.motion = None      # no step: one slot (C5)
            return
        self.state = "moving"
        self.unit.note(tick, self.number, "motion", 1)
        self.light(tick, 1)

    def ends_at_once(self, limit_input):
        """Is a motion that begins, or goes on, over before its first step?"""
        if limit_input and self.unit.bit(limit_input):
            return True
        return self.readings["guard-start"] == "none" and self.fired()

    def light(self, tick, led):
        if led != self.led:
            self.led = led
            self.unit.note(tick, self.number, "led", led)

    # ---- conditions (C5, C6) ------------------------------------------------------------------------------------------

    def fired(self):
        """Guards whose condition holds are used up. Returns whether there was one."""
        found = [g for g in "MN" if g in self.guards and self.unit.bit(self.guards[g]) == (g == "M")]
        for guard in found:
            del self.guards[guard]
            self.met(f"C5 {guard} fires {'in' if self.state == 'moving' else 'before'} a motion")
        return bool(found)

    def look(self, tick):
        """X, M, N, the input of a limit move."""
        if "X" in self.guards and self.unit.bit(self.guards["X"]) and self.executing():
            if self.readings["x-after"] == "once":
                del self.guards["X"]
            self.met(f"C6 X fires when {self.state}")
            self.total_stop(tick)
        if self.state == "moving" and not self.motion.stopping and self.fired():
            self.stop(tick)
        if self.state == "moving" and self.motion.limit_input and self.unit.bit(self.motion.limit_input):
            self.motion.end = self.motion.done
            self.met("R5 the input of a limit move")
            if self.after == "rest":
                self.after = "next"
            self.over(tick)

    def executing(self):
        if self.state in ("ended", "fault"):
            return False
        if self.state in ("idle", "ready"):  # an idle one has nothing
            return self.next < self.written
        return True

    def total_stop(self, tick):
        self.fresh, self.hold_fresh, self.resume = None, False, False
        self.next = self.written
        if self.state == "moving":
            self.after = "end"
            if not self.motion.stopping:
                self.stop(tick)
        else:
            if self.state == "dwell":
                self.due = tick
            self.end(tick)

    # ---- a turn (K2, K4) ----------------------------------------------------------------------------------------------

    def turn(self, tick):
        self.obey(tick)
        self.look_for_new(tick)
        self.look(tick)
        self.look_for_new(tick)
        if self.state == "held" and self.resume and tick >= self.due:
            self.go_on(tick)
        if tick >= self.unit.busy_until:
            self.interpret(tick)

    def interpret(self, tick):
        if self.state == "dwell" and tick >= self.due:
            self.state = "ready"
            if self.planned is not None:
                self.met("R1 a motion has been planned")
                command, self.planned = self.planned, None
                COMMANDS[command[0]](self, tick, *command[1:])
                return
        if self.state == "wait" and self.wait_is_over():
            self.state, self.due = "ready", tick + SLOT
        elif self.state == "ready" and tick >= self.due:
            self.execute(tick)

    def wait_is_over(self):
        letter = self.tape_command[0]
        if letter == "[":
            return any(n > self.current for n, c in self.tape.items() if c == ("]",))
        if letter in "JI'":
            return self.go_to_label()
        return self.unit.bit(self.tape_command[1]) == (letter == "O")

    def go_to_label(self):
        """The label of J, I, ' (C7). Returns whether it is there."""
        at = self.label(self.tape_command[-1])
        if at is None:
            return False
        if self.tape_command[0] == "'":
            self.calls.append(self.next)
        self.next = at
        return True

    def execute(self, tick):
        self.next = max(self.next, self.oldest())
        if self.next >= self.written:
            self.state = "idle"
            self.unit.note(tick, self.number, "command", 0)
            return
        self.current = self.next
        self.tape_command = command = self.tape[self.current]
        self.next += 1
        self.due = tick + SLOT
        if self.fault:
            self.fault = 0
            self.unit.note(tick, self.number, "fault", 0)
        self.unit.note(tick, self.number, "command", self.current % MEMORY + 1)
        self.met(f"5 {command[0]}")
        self.planned = None
        if self.readings["planning"] and command[0] in "RGH()":
            self.state, self.due, self.planned = "dwell", tick + self.readings["planning"] * SLOT, command
            return
        COMMANDS[command[0]](self, tick, *command[1:])

    def fail(self, tick, fault):
        self.state, self.fault = "fault", fault
        self.next = self.written
        self.met(f"C7 C10 E1 fault {fault}")
        self.unit.note(tick, self.number, "fault", fault)

    def wake(self):
        """The earliest tick at which there may be something to do without anything from outside."""
        if self.requests:
            return 0
        if self.state == "moving":
            return self.motion.due if self.motion.total is None and self.motion.end is None else self.ends_at()
        if self.state in ("ready", "dwell") or self.resume or (self.fresh is not None and not self.hold_fresh):
            return self.due
        return None

    def ends_at(self):
        motion = self.motion
        if motion.end is None:
            return None
        if self.marked and len(motion.borders) > 1 and motion.borders[-2] > motion.done:
            return motion.due
        return motion.tick(motion.end)

    # ---- commands -----------------------------------------------------------------------------------------------------

    def jump(self, tick, _label):
        if self.go_to_label():
            return
        if self.readings["label"] == "fault":
            self.fail(tick, NO_LABEL)
        else:
            self.met(f"C7 {self.tape_command[0]} waits for its label")
            self.state = "wait"

    def branch(self, tick, source, level, label):
        if self.unit.bit(source) == (level == "H"):
            self.jump(tick, label)

    def loop(self, tick, passes):
        for i, (start, _, level) in enumerate(self.loops):
            if start == self.current and level == len(self.calls):
                del self.loops[i:]
                break
        if len(self.loops) >= 8:
            self.fail(tick, LOOP_LEVELS)
        else:
            self.loops.append((self.current, passes, len(self.calls)))

    def end_of_loop(self, tick):
        if not self.loops or self.loops[-1][2] != len(self.calls):
            self.fail(tick, NO_LOOP)
            return
        start, left, level = self.loops.pop()
        if start < self.oldest():
            self.fail(tick, OVERWRITTEN)
        elif left > 1:
            self.loops.append((start, left - 1, level))
            self.next = start + 1

    def call(self, tick, label):
        if len(self.calls) >= 6:
            self.fail(tick, CALL_LEVELS)
        else:
            self.jump(tick, label)

    def back(self, tick):
        if not self.calls:
            self.fail(tick, NO_CALL)
            return
        to = self.calls.pop()
        self.loops = [entry for entry in self.loops if entry[2] <= len(self.calls)]
        if to < self.oldest():
            self.fail(tick, OVERWRITTEN)
        else:
            self.next = to

    def steps(self, _tick, number, forward):
        self.count, self.forward = number, forward

    def reverse(self, _tick):
        self.forward = not self.forward

    def single(self, steps):
        return [(steps, self.speed, self.acceleration)]

    def go(self, tick, goal):
        if goal in ("+", "-"):
            self.move(tick, self.single(None), goal == "+")
            return
        difference = goal - self.position
        self.count = abs(difference)
        if difference:
            self.forward = difference > 0
            self.move(tick, self.single(self.count), self.forward)

    def home(self, tick):
        if self.position:
            self.move(tick, self.single(abs(self.position)), self.position < 0)

    def limit_move(self, tick, source, forward):
        self.move(tick, [(None, self.start, self.acceleration)], forward, source)

    def segment(self, tick):
        if not self.table:
            self.marks = frozenset(self.functions)
        self.table.append((self.count, self.forward, self.speed, self.acceleration))
        if len(self.table) > 10 and self.readings["y-eleventh"] == "y":
            self.refuse_table(tick)

    def refuse_table(self, tick):
        self.table = []
        self.fail(tick, MOTION_FAULT)
        self.light(tick, 2)

    def run(self, tick):
        if not self.table:
            if self.count:
                self.marked = frozenset()
                self.move(tick, self.single(self.count), self.forward)
            return
        table, self.table = self.table, []
        total = sum(steps for steps, _, _, _ in table)
        if len(table) > 10 or len({f for _, f, _, _ in table}) > 1 or total > 160000000 or not all(s for s, _, _, _ in table):
            self.refuse_table(tick)
            return
        self.marked = frozenset(self.marks & self.functions)
        self.move(tick, [(steps, v, a) for steps, _, v, a in table], table[0][1])
        if self.state == "moving" and self.marked and len(table) == 1:
            self.unit.mark(self.marked, tick)
            self.marked = frozenset()

    def switch(self, tick, number, on):
        if number in language.VARIABLES or number in language.INPUTS:
            self.unit.set(tick, number, on)
        elif number == 40:
            self.keep = on
        elif number == 41:
            self.unit.simulate(tick, on)
        elif number > 50 and number < 59:
            (self.functions.add if on else self.functions.discard)(number - 50)
        elif number == 100:
            self.position = 0

    def put(self, name, value):
        setattr(self, name, value)

    def wait(self, tick, *_):
        self.state = "wait"
        if self.wait_is_over():
            self.state = "ready"

    def dwell(self, tick, slots):
        self.state, self.due = "dwell", tick + slots * SLOT

    def guard(self, letter, number):
        self.guards[letter] = number

    def cancel(self):
        self.guards.pop("M", None)
        self.guards.pop("N", None)


COMMANDS = {
    "@": lambda m, t, n: None, "]": lambda m, t: None,
    "A": lambda m, t, n: m.put("acceleration", n), "S": lambda m, t, n: m.put("start", n),
    "V": lambda m, t, n: m.put("speed", n), "=": lambda m, t, n: m.put("position", n),
    "F": lambda m, t, n: m.steps(t, n, True), "B": lambda m, t, n: m.steps(t, n, False), "D": Motor.reverse,
    "L": Motor.loop, "E": Motor.end_of_loop, "J": Motor.jump, "I": Motor.branch, "'": Motor.call, ".": Motor.back,
    "G": Motor.go, "H": Motor.home, "R": Motor.run, "Y": Motor.segment,
    ")": lambda m, t, n: m.limit_move(t, n, True), "(": lambda m, t, n: m.limit_move(t, n, False),
    "T": lambda m, t, n: m.switch(t, n, True), "C": lambda m, t, n: m.switch(t, n, False),
    "O": Motor.wait, "Z": Motor.wait, "[": Motor.wait, "W": Motor.dwell,
    "M": lambda m, t, n: m.guard("M", n), "N": lambda m, t, n: m.guard("N", n), "X": lambda m, t, n: m.guard("X", n),
    "U": lambda m, t: m.cancel(),
}
