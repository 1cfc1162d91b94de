# SPDX-License-Identifier: MIT
"""The block machine of the CNC872, without PLC program, from the text of its specification alone (NT2, NB1 to NB8)."""
from cnc872_manual import Manual
from cnc872_reference import References
from cnc872_section import Section
from cnc872_technology import Technology

U = 65536
IDLE, INIT, MOVE, DELAY, DONE = range(5)
BITS = ("STOPPI STOP_REQ STOP_EMERGENCY_REQ START_DISABLE PO_F PO_POL PO_STOP SF_STOP G23ACT BLOCK_RESTART CAPI FEED_OVR "
        "LIMIT_FEED_REQ LIMIT_FEED_G00_REQ INPOS EXT_PLC PLC_PASS_DONE AUTMAN_REQ REQ_EXT_CONT_AUTMAN REQ_EXT_FEED_AUTMAN "
        "REQ_EXT_G00_AUTMAN ACK_AUTMAN SF_STOPPOSCHANGED SF_LS PRODLEVA SF_RUN SF_BLOCKFINISHED REQ_LINEARACCEL "
        "REQ_EXT_SELECT_AUTMAN").split()


class Block:
    """g: 0, 1, 33 or None; targets in u by axis; feed in mm/min, or mm/rev if `turns`; delay in ms or None; functions: those
    of group M; t, h: or None. Of the spindle what is in force: speed and limit in rev/min, cut_speed in m/min, is_cut with G96;
    has_speed: S is in this block."""

    def __init__(self, g, targets, feed, delay=None, continuous=False, turns=False, functions=(), t=None, h=None, spindle=None):
        self.turns, self.functions, self.t, self.h = turns or g == 33, functions, t, h
        self.m = next((m for m in functions if m in (0, 1, 2, 30)), None)
        self.g, self.targets, self.feed, self.continuous = g if targets else None, targets, feed, continuous
        self.has_delay, self.delay = delay is not None, delay or 0
        self.speed, self.cut_speed, self.limit, self.is_cut, self.has_speed = spindle


class Machine:
    def __init__(self, parabolic, axes, program, gears):
        self.parabolic, self.axes, self.program, self.turn = parabolic, axes, program, 0
        self.cells = dict.fromkeys(BITS, 0)
        self.cells.update(FEED_OVR_MULTIPLIER=1000, BZH09=0, LIMIT_FEED=0, LIMIT_FEED_G00=0, TIME_DIST=0, STATUS_RESTART=0,
                          BZH13=0, SF_STOP=1, EN_AUTMAN=1, INPOS_STOP=1, EXT_FEED_AUTMAN=0, EXT_FEED_G00_AUTMAN=0, HOMING=0,
                          HOMING_REQ=0, dwAxGLinearAccel=0)
        for axis in axes:
            self.cells.update({f"MP{axis}PI": 1, f"VAZBA_{axis}": 1, f"KH{axis}0": 0, f"KH{axis}1": 0, f"ZP{axis}0": 0,
                               f"ZP{axis}1": 0, f"PO_OS{axis}PI": 0, f"SM_PO{axis}PI": 0, f"EXM_{axis}0": 0, f"EXM_{axis}1": 0,
                               f"MP{axis}": 1})
        self.cells.update({f"REFPOINT_DIST[{i}]": 0 for i in range(len(axes))})
        self.requested, self.block_start, self.stop_place = set(), dict.fromkeys(axes, 0), None
        self.manual, self.technology, self.references = Manual(self), Technology(self, gears), References(self)
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
                cells["ACK_AUTMAN"] or (self.phase != IDLE and not cells["PO_STOP"]))

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

    def show_start(self, **modes):
        """A block, a reference (REFPI) or a central annulment (CAPI) begins."""
        self.cells.update(PO_F=1, SF_BLOCKFINISHED=0, CAPI=0, REFPI=0)
        self.cells.update(modes)
        self.technology.threads = False

    def publish(self):
        cells, block = self.cells, self.program[self.next]
        if not self.section and not self.technology.fits(block):
            cells["SF_STOP"] = 1
            return
        self.block, self.next = self.next, self.next + 1
        self.begin_phase(INIT)
        self.show_start()
        self.technology.threads = block.g == 33
        self.technology.publish(block)
        self.delay = block.delay
        if self.section and self.block > self.section.segments[0].index:
            self.section.now += 1
        else:
            self.section = Section(self, self.block, self.position)
            if not self.section.segments:
                self.section = None
        self.reached, self.block_start = self.section is None, dict(self.position)
        if self.section:
            cells["PO_POL"], segment = 0, self.section.segments[self.section.now]
            self.requested |= set(segment.way)
            if not cells["REQ_LINEARACCEL"]:
                cells["dwAxGLinearAccel"] = self.section.linear(segment)

    def begin_delay(self):
        if self.delay:
            self.phase, self.cells["PRODLEVA"] = DELAY, 1
        else:
            self.begin_phase(DONE)

    def end_block(self):
        cells, index, section = self.cells, self.block, self.section
        cells.update(PO_F=0, STATUS_RESTART=0, BLOCK_RESTART=0, SF_BLOCKFINISHED=1)
        self.phase, self.block, self.references.runs = IDLE, None, False
        self.technology.end()
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
            self.stop_place = dict(self.position)
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
        if emergency or cells["STOP_REQ"]:
            self.starts = False
        self.was_stoppi, self.stop_asked = cells["STOPPI"], False
        cells.update(STOP_REQ=0, STOP_EMERGENCY_REQ=0)
        if stop or emergency:
            self.manual.stop(emergency)
            self.references.stop(emergency)
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
        if self.phase == INIT and self.passed and self.references.runs:
            self.phase = MOVE
        elif self.phase == INIT and self.passed:
            if not self.reached:
                self.requested -= set(self.section.segments[self.section.now].way)
                if not self.section.goes and self.section.is_left():
                    self.section = Section(self, self.block, self.position)
                    self.cells["G23ACT"] = self.cells["TIME_DIST"] = 0
                if self.section.segments:
                    self.section.begin()
                    self.phase = MOVE
                    self.requested |= set(self.section.segments[self.section.now].way)
                    return
                self.section, self.reached, self.cells["PO_POL"] = None, True, 1
            self.begin_delay()
        elif self.phase == DELAY:
            self.delay -= 1
            if self.delay <= 0:
                self.begin_phase(DONE)
                self.cells["PRODLEVA"] = 0
        elif self.phase == DONE and self.passed:
            self.end_block()

    def run_annulment(self):
        if self.annulment == 1 and not self.path_moves() and not self.manual.moving and not self.references.moving():
            self.annulment = 2
            self.show_start(CAPI=1)
            self.cells.update(PO_STOP=0, BLOCK_RESTART=0, STATUS_RESTART=0, BZH13=0, G23ACT=0, TIME_DIST=0, PRODLEVA=0)
            self.technology.end()
            self.references.drop()
            self.requested = set()
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
            place, segment = section.place()
            self.position.update(place)
            for axis, way in segment.way.items():
                if self.v > 0:
                    self.cells[f"SM_PO{axis}PI"] = int(way < 0)
        if not (section and section.goes):
            self.manual.move()
            self.references.move()
        for axis, values in self.axes.items():
            error = self.position[axis] - self.actual[axis]
            if self.cells[f"VAZBA_{axis}"]:
                self.actual[axis] += error // values["lag"] if error >= 0 else -(-error // values["lag"])

    def override(self):
        """The two factors of the feed in per mille (NF1)."""
        if self.technology.override_cancelled:
            return 1000, 1000
        return self.cells["BZH09"] if self.cells["FEED_OVR"] else self.pot * 10, self.cells["FEED_OVR_MULTIPLIER"]

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
        self.requested -= set(section.segments[section.now].way)
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
        self.take_positions()
        self.references.take()
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
        self.show()

    def take_positions(self):
        """HOMING_REQ (NH1)."""
        cells = self.cells
        for i, axis in enumerate(self.axes):
            moves = self.phase == MOVE and not cells["PO_STOP"]
            moves = moves or axis in self.manual.moving or axis in self.references.moving()
            moves = moves or (self.section and self.section.goes)
            if cells["HOMING_REQ"] >> i & 1 and not moves:
                cells["HOMING_REQ"] &= ~(1 << i)
                self.set_position(axis, self.axes[axis]["null_point"] * 65536000 + cells[f"REFPOINT_DIST[{i}]"])

    def set_position(self, axis, place):
        self.actual[axis] += place - self.position[axis]
        self.position[axis] = self.block_start[axis] = place
        self.cells["HOMING"] |= 1 << list(self.axes).index(axis)

    def show(self):
        """Step 5: status cells (NE2, NE3, NB5, NB6, NA5)."""
        cells, moves = self.cells, self.v > 0 or self.path_moves() or bool(self.manual.moving or self.references.moving())
        changed = self.stop_place is not None and self.stop_place != self.position
        cells.update(INPOS=int(not moves and self.is_near(self.axes)), INPOS_STOP=int(not changed),
                     SF_STOPPOSCHANGED=int(changed and cells["PO_STOP"]),
                     SF_RUN=int(moves or (self.phase != IDLE and not cells["PO_STOP"])),
                     SF_LS=int(any(cells[f"KH{axis}{sign}"] for axis in self.axes for sign in "01")))
        self.technology.show()
        for axis in self.axes:
            cells[f"PO_OS{axis}PI"] = int(axis in self.requested or self.manual.moves(axis) or axis in self.references.moving())
            cells[f"MP{axis}"] = int(cells[f"MP{axis}PI"] and not cells[f"KH{axis}0"] and not cells[f"KH{axis}1"] and
                                     not cells["BZH13"])
