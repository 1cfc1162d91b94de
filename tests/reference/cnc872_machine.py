# SPDX-License-Identifier: MIT
"""The block machine of the CNC872, without PLC program, from the text of its specification alone (NT2, NB1 to NB8)."""
from cnc872_section import Section

U = 65536
IDLE, INIT, MOVE, DELAY, DONE = range(5)
BITS = ("STOPPI STOP_REQ STOP_EMERGENCY_REQ START_DISABLE PO_F PO_POL PO_STOP SF_STOP G23ACT BLOCK_RESTART CAPI FEED_OVR "
        "LIMIT_FEED_REQ LIMIT_FEED_G00_REQ INPOS EXT_PLC PLC_PASS_DONE").split()


class Block:
    """g: 0, 1 or None; targets in u by axis; feed in mm/min; delay in ms or None; m: function of group 1 or None."""

    def __init__(self, g, targets, feed, delay=None, m=None, continuous=False):
        self.g, self.targets, self.feed, self.m, self.continuous = g if targets else None, targets, feed, m, continuous
        self.has_delay, self.delay = delay is not None, delay or 0


class Machine:
    def __init__(self, parabolic, axes, program):
        self.parabolic, self.axes, self.program, self.turn = parabolic, axes, program, 0
        self.cells = dict.fromkeys(BITS, 0)
        self.cells.update(FEED_OVR_MULTIPLIER=1000, BZH09=0, LIMIT_FEED=0, LIMIT_FEED_G00=0, TIME_DIST=0, STATUS_RESTART=0,
                          BZH13=0, SF_STOP=1)
        for axis in axes:
            self.cells.update({f"MP{axis}PI": 1, f"VAZBA_{axis}": 1, f"KH{axis}0": 0, f"KH{axis}1": 0, f"ZP{axis}0": 0,
                               f"ZP{axis}1": 0})
        self.position, self.actual = dict.fromkeys(axes, 0), dict.fromkeys(axes, 0)
        self.pot, self.block_by_block, self.m01 = 100, False, False
        self.phase, self.block, self.next, self.section, self.delay = IDLE, None, 0, None, 0
        self.stopped = self.stop_asked = self.starts = self.was_stoppi = self.was_stop = self.passed = self.reached = False
        self.outside = False
        self.kind, self.annulment, self.v = None, 0, 0

    # Requests

    def refuses(self):
        cells = self.cells
        return (cells["START_DISABLE"] or not self.program or self.annulment or cells["STOPPI"] or cells["BZH13"] or
                (self.phase != IDLE and not cells["PO_STOP"]))

    def start(self):
        self.starts = self.starts or not self.refuses()

    def stop(self):
        self.starts, self.stop_asked = False, True

    def reset(self):
        self.stop()
        self.annulment = self.annulment or 1

    # Blocks

    def begin_phase(self, phase):
        self.phase, self.passed, self.outside = phase, False, False

    def publish(self):
        cells, block = self.cells, self.program[self.next]
        self.block, self.next = self.next, self.next + 1
        self.begin_phase(INIT)
        cells.update(PO_F=1, CAPI=0)
        self.delay = block.delay
        if self.section and self.block > self.section.segments[0].index:
            self.section.now += 1
        else:
            self.section = Section(self, self.block, self.position)
            if not self.section.segments:
                self.section = None
        self.reached = self.section is None
        if self.section:
            cells["PO_POL"] = 0

    def begin_delay(self):
        if self.delay:
            self.phase = DELAY
        else:
            self.begin_phase(DONE)

    def end_block(self):
        cells, index, section = self.cells, self.block, self.section
        cells.update(PO_F=0, STATUS_RESTART=0, BLOCK_RESTART=0)
        self.phase, self.block = IDLE, None
        if index is None:
            return
        if section and section.now + 1 < len(section.segments):
            self.publish()
            return
        self.section = None
        m, over = self.program[index].m, index + 1 == len(self.program)
        if over or m in (2, 30):
            self.next = 0
        if over or m in (0, 2, 30) or (m == 1 and self.m01) or self.block_by_block:
            cells["SF_STOP"] = 1
        else:
            self.publish()

    def confirm_stop(self):
        if not self.cells["PO_STOP"]:
            self.cells.update(PO_STOP=1, SF_STOP=1)
            if self.section:
                self.section.goes = False

    def path_moves(self):
        section = self.section
        return bool(section and section.goes and section.path.rest() > 0 and not section.path.is_at_rest())

    # Steps of a T

    def run_pass(self):
        if self.phase in (INIT, DONE) and not self.passed:
            if self.cells["EXT_PLC"] and self.cells["PLC_PASS_DONE"]:
                self.outside, self.cells["PLC_PASS_DONE"] = True, 0
            self.passed = self.outside or not self.cells["EXT_PLC"]

    def take_stop(self):
        cells = self.cells
        stop = self.stop_asked or cells["STOP_REQ"] or (cells["STOPPI"] and not self.was_stoppi)
        emergency = cells["STOP_EMERGENCY_REQ"]
        self.was_stoppi, self.stop_asked = cells["STOPPI"], False
        cells.update(STOP_REQ=0, STOP_EMERGENCY_REQ=0)
        if self.block is None or not (stop or emergency):
            return
        if emergency:
            self.kind = "EMERGENCY"
        elif not self.stopped:
            self.kind = "STOP"
        self.stopped = True

    def finish_start(self):
        """Returns whether it did something."""
        if not self.starts:
            return False
        self.starts = False
        if self.refuses():
            return False
        restarts, self.stopped, self.was_stop = self.stopped, False, False
        self.cells.update(SF_STOP=0, PO_STOP=0)
        if not restarts:
            self.publish()
        elif self.phase != DONE:
            self.cells["BLOCK_RESTART"] = 1
            self.begin_phase(INIT)
        elif self.passed:
            self.end_block()
        return True

    def advance_block(self):
        if self.phase == INIT and self.passed:
            if self.reached:
                self.begin_delay()
            else:
                self.section.begin()
                self.phase = MOVE
        elif self.phase == DELAY:
            self.delay -= 1
            if self.delay <= 0:
                self.begin_phase(DONE)
        elif self.phase == DONE and self.passed:
            self.end_block()

    def run_annulment(self):
        if self.annulment == 1 and not self.path_moves():
            self.annulment = 2
            self.cells.update(CAPI=1, PO_F=1, PO_STOP=0, BLOCK_RESTART=0, STATUS_RESTART=0, BZH13=0, G23ACT=0, TIME_DIST=0)
            if self.phase not in (INIT, DONE) or self.passed:
                self.begin_phase(INIT)
            self.block, self.next, self.section, self.stopped, self.was_stop = None, 0, None, False, False
            self.reached, self.delay = True, 0
        elif self.annulment == 2 and self.phase == IDLE:
            self.annulment, self.cells["SF_STOP"] = 0, 1

    def find_hold(self):
        cells, axes = self.cells, self.section.axes
        if cells["BZH13"]:
            return "ERROR"
        if not all(cells[f"MP{axis}PI"] for axis in axes):
            return "ENABLE"
        if self.stopped and self.kind == "EMERGENCY":
            return "EMERGENCY"
        if any(cells[f"KH{axis}{sign}"] for axis in axes for sign in "01"):
            return "LIMIT"
        return "STOP" if self.stopped else None

    def move(self):
        section, self.v = self.section, 0
        if section and section.goes and section.path.rest() > 0:
            section.step(self.find_hold())
            self.v = section.path.v
            self.position.update(section.place()[0])
        for axis, values in self.axes.items():
            error = self.position[axis] - self.actual[axis]
            if self.cells[f"VAZBA_{axis}"]:
                self.actual[axis] += error // values["lag"] if error >= 0 else -(-error // values["lag"])

    def is_near(self, axes):
        return all(abs(self.position[axis] - self.actual[axis]) <= 5 * U for axis in axes)

    def end_motion(self):
        section = self.section
        if not section or not section.goes:
            return
        if self.phase != MOVE or section.path.done < section.segments[section.now].border:
            if self.stopped and section.path.is_at_rest():
                self.confirm_stop()
            return
        last = section.now + 1 == len(section.segments)
        if last and not self.is_near(section.axes):
            return
        self.cells["PO_POL"], self.reached = 1, True
        section.goes = not last
        self.begin_delay()
        if last and self.stopped:
            self.confirm_stop()

    def tick(self):
        self.turn += 1
        self.run_pass()
        self.take_stop()
        if not self.finish_start():
            if not self.stopped:
                self.advance_block()
            elif not self.annulment and self.phase not in (MOVE, IDLE) and not self.path_moves():
                self.confirm_stop()
        self.run_annulment()
        self.move()
        self.end_motion()
        if self.cells["PO_STOP"] and not self.was_stop:
            self.cells["STATUS_RESTART"] = self.phase
        self.was_stop = self.cells["PO_STOP"]
        self.cells["INPOS"] = int(self.v == 0 and not self.path_moves() and self.is_near(self.axes))
