# SPDX-License-Identifier: MIT
"""References of axes of the CNC872 that search a switch, from the text of its specification alone (NH2)."""
from cnc872_path import to_acceleration, to_speed

SEARCH, BACK, STOP, TO_BACK, TO_SEARCH, ENDS = "search", "back", "stop", "to back", "to search", "ends"


class Axis:
    def __init__(self, kr, krr):
        self.state, self.kr, self.krr, self.speed, self.direction = None, kr, krr, 0, 0
        self.slow = self.seen = self.emergency = self.moves = False
        self.place = 0


class References:
    def __init__(self, machine):
        self.machine, self.axes, self.runs = machine, {}, False
        machine.cells.update(HOMING_START_REQ=0, REFPI=0)
        for axis in machine.axes:
            machine.cells.update({f"KR{axis}": 0, f"KRR{axis}": 0, f"ZPR{axis}": 0})

    def moving(self):
        return [axis for axis, one in self.axes.items() if one.moves]

    def take(self):
        """Step 3: HOMING_START_REQ."""
        machine, cells = self.machine, self.machine.cells
        for i, axis in enumerate(machine.axes):
            if not cells["HOMING_START_REQ"] >> i & 1 or axis in self.axes:
                continue
            if cells["START_DISABLE"]:
                cells["HOMING_START_REQ"] &= ~(1 << i)
                continue
            if machine.annulment or axis in machine.manual.moving or not (machine.phase == 0 or
                                                                         (self.runs and machine.phase in (1, 2))):
                continue
            self.axes[axis] = Axis(cells[f"KR{axis}"], cells[f"KRR{axis}"])
            if not self.runs:
                self.runs = True
                machine.begin_phase(1)
                machine.show_start(REFPI=1)

    def stop(self, emergency):
        for one in self.axes.values():
            one.state, one.emergency = ENDS, one.emergency or bool(emergency)

    def drop(self):
        self.machine.cells["HOMING_START_REQ"], self.axes, self.runs = 0, {}, False

    def end(self, axis):
        self.machine.cells["HOMING_START_REQ"] &= ~(1 << list(self.machine.axes).index(axis))
        del self.axes[axis]

    def move(self):
        """Step 4."""
        machine, cells = self.machine, self.machine.cells
        goes = self.runs and machine.phase == 2
        for axis in list(self.axes):
            one = self.axes[axis]
            kr, krr = cells[f"KR{axis}"], cells[f"KRR{axis}"]
            rises, reverses = kr and not one.kr, krr and not one.krr
            one.kr, one.krr = kr, krr
            if goes:
                self.move_axis(axis, one, rises, reverses)
        if goes and not self.axes:
            machine.begin_phase(4)

    def move_axis(self, axis, one, rises, reverses):
        machine, cells, values = self.machine, self.machine.cells, self.machine.axes[axis]
        if one.state is None:
            one.state = BACK if one.kr else SEARCH
        one.moves = True
        if one.state == SEARCH and rises:
            one.state, one.place = STOP, machine.position[axis]
        elif one.state == SEARCH and reverses:
            one.state = TO_BACK
        elif one.state == BACK and one.kr:
            one.seen = True
        elif one.state == BACK and one.seen:
            one.state = TO_SEARCH
        forward = 1 if values["direction"] == "+" else -1
        if one.state != ENDS:
            one.direction = -forward if one.state in (BACK, TO_SEARCH) else forward
        limit = one.direction and cells[f"KH{axis}{'0' if one.direction > 0 else '1'}"]
        if limit:
            one.state = ENDS
        held, slow = not cells[f"MP{axis}PI"], cells[f"ZPR{axis}"]
        feed = 0
        if one.state == SEARCH:
            feed = values["feed_reference"] if slow or one.slow else values["feed"]
        elif one.state == BACK:
            feed = values["feed_reference"] if slow or one.kr else values["feed"]
        normal, _, steep = map(to_acceleration, values["acceleration"])
        speed = min(one.speed + normal, max(0 if held else to_speed(min(feed, values["feed_rapid"])), one.speed - normal, 0))
        if held or limit or one.emergency:
            speed = min(speed, max(0, one.speed - steep))
        one.speed = 0 if cells["BZH13"] else speed
        machine.position[axis] += one.direction * one.speed
        if one.speed:
            cells[f"SM_PO{axis}PI"] = int(one.direction < 0)
        elif feed == 0 and (one.state == ENDS or not cells["BZH13"]):
            self.at_rest(axis, one)

    def at_rest(self, axis, one):
        machine = self.machine
        if one.state == TO_BACK:
            one.state = BACK
        elif one.state == TO_SEARCH:
            one.state, one.slow = SEARCH, True
        else:
            if one.state == STOP:
                machine.set_position(axis, machine.axes[axis]["null_point"] * 65536000 + machine.position[axis] - one.place)
            self.end(axis)
