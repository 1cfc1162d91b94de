# SPDX-License-Identifier: MIT
"""readings.py: which readings (docs/READINGS.md) a unit has. Each probe sends programs of which the reading decides the outcome
and looks at positions, flags and tables: over the wire alone, and where time is real without depending on how late things are
seen.

A time that was not measured to the ms has limits; the roundest number between them is taken, and said."""

from case import Mismatch

DEFAULTS = {"label": "wait", "fault-exit": "reset", "hold-exit": "new", "x-after": "armed", "guard-start": "none",
            "v-alone": "blanks", "y-eleventh": "run", "reset-t41": "keep", "negative-position": "yes", "speed-change": 0,
            "planning": 0, "input-filter": 0, "store-time": 0}
LONGEST = {"speed-change": 2000, "planning": 2000, "input-filter": 100, "store-time": 1000}
MOVES = {"guard-start": [1], "speed-change": [1], "planning": [1, 2]}
SLOT = 1000  # us


class Unknown(Exception):
    """It cannot be found out, or neither value fits."""


def roundest(low, high):
    """The roundest whole number of ms in low..high."""
    for step in (1000, 500, 100, 50, 20, 10, 5, 2, 1):
        number = -(-max(low, 0) // step) * step
        if number <= high:
            return number
    return max(round((low + high) / 2), 0)


class Probes:
    def __init__(self, run):
        self.run, self.target, self.line = run, run.target, run.line

    # What they share

    def settle(self, ms=20):
        """So many ms pass, and however late we may be."""
        self.target.pass_us(ms * 1000 + self.target.latency_us())

    def outcome(self, values):
        """The value that belongs to the position of motor 1."""
        position = self.run.position(1)
        if position not in values:
            raise Unknown(f"position {position}, where {' or '.join(map(str, values))} was expected")
        return values[position]

    def until(self, what, limit_ms, holds):
        """Time passes until it holds."""
        for _ in range(limit_ms // 10):
            if holds():
                return
            self.target.pass_us(10_000)
        raise Unknown(f"not within {limit_ms} ms: {what}")

    def level(self, number):
        """Input `number`, as a program sees it; the program is gone then."""
        self.run.set(f"\\ I{number:02}H01 =1 J02 @01 =2 @02")
        self.settle()
        return self.outcome({1: 0, 2: 1})

    # Names

    def label(self):
        self.run.set("J01")
        self.settle()
        self.run.set("=5 J02 @01 =7 J02 @02")
        self.settle()
        return self.outcome({7: "wait", 0: "fault", 5: "fault"})

    def fault_exit(self):
        self.run.set("E")
        self.settle()
        self.run.set("=5")
        self.settle()
        return self.outcome({0: "reset", 5: "new"})

    def hold_exit(self):
        self.run.set("W60000")
        self.settle()
        self.run.set("K")
        self.settle()
        self.run.set("=5")
        self.settle()
        return self.outcome({5: "new", 0: "latch"})

    def x_after(self):
        if "inputs" in self.target.has:
            self.target.inputs({"01": 1})
        on = next((number for number in range(1, 9) if self.level(number)), None) if "inputs" not in self.target.has else 1
        if on is None:
            raise Unknown("needs an input that is 1: set one, or --has inputs")
        self.run.set("\\ C100 ")
        self.run.set(f"X{on:02} W60000")
        self.settle(150)  # the longest input filter
        self.run.set("=5")
        self.settle()
        return self.outcome({0: "armed", 5: "once"})

    def guard_start(self):
        guard = "M" if self.level(1) else "N"
        self.run.set("\\ C100")
        self.settle()
        self.run.set(f"S100 V100 F100 {guard}01 R")
        if self.target.until_idle(1, 5_000_000, lambda motor: self.run.progress(motor)[1] == 0) is None:
            raise Unknown("the motion is not stopped")
        return "step" if self.run.position(1) > 0 else "none"

    def v_alone(self):
        self.run.set("W2000 =5")
        self.run.set(" K")
        self.settle(2200)
        return self.outcome({0: "blanks", 5: "first"})

    def y_eleventh(self):
        self.run.set("F10" + " Y" * 11 + " =5")
        self.settle()
        return self.outcome({5: "run", 0: "y"})

    def reset_t41(self):
        if "outputs" not in self.target.has:
            raise Unknown("needs somebody who looks at output 01: --has outputs")
        self.run.set("T01 T41")
        self.settle()
        self.run.set("\\")
        self.settle()
        on = self.target.outputs() & 1
        self.run.set("C01 C41")
        return "clear" if on else "keep"

    def negative_position(self):
        answer = self.line.ask(b"\x021=-5")
        if answer not in (b"\x021\0\0", b"\x021\x01="):
            raise Unknown(f"the answer to =-5 is {answer!r}")
        return "no" if answer[2] else "yes"

    # Times

    def speed_change(self):
        """The break points of the motion say at which step the change was executed, two looks at its progress when it was asked
        for."""
        speed = 500  # 2 ms a step
        self.run.set(f"S{speed} V{speed} A60000 G+")
        self.until("the motion begins", 5000, lambda: self.run.progress(1)[0] > 0)
        before = self.run.progress(1)[0]
        self.run.set("V1000")
        after = self.run.progress(1)[0]
        self.settle(LONGEST["speed-change"] + 200)
        table = self.run.get(6, 1, "Get Tabul Run of motor 1").decode("latin-1")
        self.run.set("\\")
        points = [tuple(map(int, point.split(";"))) for point in table.split("[")[1].rstrip("]").strip("()").split("),(")]
        if points[-1][1] != 1000 or len(points) < 3:
            raise Unknown(f"the speed has not changed: {table}")
        begin = points[1][0] - 1  # the point is the first step behind the change
        low, high = (begin - after - 1) * 1000 // speed, (begin - before + 1) * 1000 // speed
        if self.target.exact:
            return self.exact_speed_change()
        return roundest(low, high)

    def exact_speed_change(self):
        """In steps of 1 ms: constant speed, so that the first step of 1 ms instead of 2 shows it."""
        speed = 500
        self.run.set(f"\\ S{speed} V{speed} A60000 G+")
        self.until("the motion begins", 5000, lambda: self.run.progress(1)[0] > 0)
        self.run.set("V1000")
        for passed in range(LONGEST["speed-change"] + 10):
            self.target.pass_us(SLOT)
            if self.run.get(6, 1, "Get Tabul Run of motor 1").count(b";") > 3:
                return passed
        raise Unknown("the speed has not changed")

    def planning(self):
        """Motor 1 begins two motions one after the other, motor 2 one motion after a dwell as long as the first of these. Both
        then count ms; one answer has both counters, so that it does not matter when it is asked for."""
        self.run.set("S1000 V1000 F10 O80 R G+", 1)
        self.run.set("S1000 V1000 O80 W10 G+", 2)
        self.settle()
        self.run.set("T80", 3)
        self.until("both motors move", 3 * LONGEST["planning"] + 1000,
                   lambda: self.run.position(1) > 20 and self.run.position(2) > 20)
        answer = self.line.ask(b"\x040")
        for motor in (1, 2):
            self.run.set("\\", motor)
        fields = answer[2:]
        first, second = int(fields[1:11]), int(fields[12:22])
        return max(second - first + 9, 0)

    def input_filter(self):
        if not self.target.exact:
            raise Unknown("needs inputs that are set at a known time: --has control")
        self.run.set("O01 =5")
        self.settle()
        self.target.inputs({"01": 1})
        for passed in range(LONGEST["input-filter"] + 10):
            if self.run.position(1) == 5:
                return max(passed - 2, 0)
            self.target.pass_us(SLOT)
        raise Unknown("input 01 is not seen")

    def store_time(self):
        if "flash" not in self.target.has:
            raise Unknown("stored programs are lost: --has flash")
        self.run.set("=1")
        self.settle()
        if self.target.exact:
            return self.exact_store_time()
        quick = []
        for _ in range(5):
            begin = self.target.now_us()
            self.run.progress(1)
            quick.append(self.target.now_us() - begin)
        begin = self.target.now_us()
        self.line.ask(b"\x031")
        took = self.target.now_us() - begin
        return roundest(round((took - max(quick)) / 1000 - 5), round((took - min(quick)) / 1000 + 5))

    def exact_store_time(self):
        """The slot under way is not counted."""
        self.target.start()
        self.line.say(self.line.framing.frame(self.line.node, b"\x031"))
        for passed in range(LONGEST["store-time"] + 10):
            if self.line.hear(lambda heard: self.line.framing.take(heard, self.line.node) is not None, 0.02 if passed else 0.2):
                return max(passed - 1, 0)
            self.target.pass_us(SLOT)
        raise Unknown("Store Flash is not answered")


def prepare(run):
    """As before a case; the first request takes the place of an answer that came too late for the probe before."""
    try:
        run.line.ask(b"\x01")
    except ValueError:
        pass
    run.prepare()


def find_out(run, no_motion):
    """{name: (value, or None; why not)} of all readings."""
    found = {}
    for name in DEFAULTS:
        if no_motion and name in MOVES:
            found[name] = None, f"moves motor {', '.join(map(str, MOVES[name]))}"
            continue
        try:
            prepare(run)
            found[name] = getattr(Probes(run), name.replace("-", "_"))(), None
        except (Unknown, Mismatch, ValueError) as error:
            found[name] = None, str(error)
    prepare(run)
    return found


def shown(name, value):
    return f"{value}ms" if name in LONGEST else value


def report(found):
    """A line for each, and all that are not at their default as an option."""
    for name, (value, reason) in found.items():
        print(f"{name:18} " + (shown(name, value) if reason is None else f"not known: {reason}"))
    other = [f"{name}={shown(name, value)}" for name, (value, reason) in found.items()
             if reason is None and value != DEFAULTS[name]]
    print("\n--readings " + ",".join(other) if other else "\nall that could be found out are at their defaults")
