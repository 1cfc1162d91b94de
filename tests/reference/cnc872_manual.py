# SPDX-License-Identifier: MIT
"""Manual moves of the CNC872 by the cells of its PLC program, from the text of its specification alone (NM11, NA1 to NA4)."""
from cnc872_path import to_acceleration, to_speed


class Manual:
    """moving: axis -> [direction, speed, whether STOP EMERGENCY came]."""

    def __init__(self, machine):
        self.machine, self.moving, self.stopped = machine, {}, set()

    def moves(self, axis):
        return axis in self.moving and self.moving[axis][1] > 0

    def stop(self, emergency):
        self.stopped |= set(self.moving)
        for one in self.moving.values():
            one[2] = one[2] or bool(emergency)

    def speed(self, axis):
        machine, cells = self.machine, self.machine.cells
        rapid, values = cells["REQ_EXT_G00_AUTMAN"], machine.axes[axis]
        feed = values["feed_rapid"] if rapid else values["feed"]
        if rapid and cells["EXT_FEED_G00_AUTMAN"]:
            feed = cells["EXT_FEED_G00_AUTMAN"]
        elif not rapid and cells["REQ_EXT_FEED_AUTMAN"]:
            feed = cells["EXT_FEED_AUTMAN"]
        percent, multiplier = machine.override()
        speed = min(feed * percent * multiplier * 16384 // (15 * 10**6), to_speed(values["feed_rapid"]))
        limit = "LIMIT_FEED_G00" if rapid else "LIMIT_FEED"
        if cells[limit + "_REQ"]:
            speed = min(speed, max(0, cells[limit]))
        if cells[f"ZP{axis}0"] or cells[f"ZP{axis}1"]:
            speed = min(speed, to_speed(values["feed_slow"]))
        return speed

    def move(self):
        """Step 4 of a T in which no path goes."""
        machine, cells = self.machine, self.machine.cells
        free = not machine.references.runs and (machine.phase == 0 or cells["PO_STOP"])
        active = cells["EN_AUTMAN"] and cells["AUTMAN_REQ"] and free
        cells["ACK_AUTMAN"] = int(bool(active or self.moving))
        for axis in machine.axes:
            request = cells[f"EXM_{axis}0"] - cells[f"EXM_{axis}1"] if cells["REQ_EXT_CONT_AUTMAN"] else 0
            if request == 0:
                self.stopped.discard(axis)
            if not active or cells["REQ_EXT_SELECT_AUTMAN"] or axis in self.stopped:
                request = 0
            if axis not in self.moving and request and not cells["BZH13"]:
                self.moving[axis] = [request, 0, False]
            if axis in self.moving:
                self.move_axis(axis, request)

    def move_axis(self, axis, request):
        machine, cells, one = self.machine, self.machine.cells, self.moving[axis]
        direction, before, emergency = one
        normal, _, steep = map(to_acceleration, machine.axes[axis]["acceleration"])
        held = not cells[f"MP{axis}PI"] or cells[f"KH{axis}{'0' if direction > 0 else '1'}"]
        target = self.speed(axis) if request == direction and not held else 0
        speed = min(before + normal, max(target, before - normal, 0))
        if held or emergency:
            speed = min(speed, max(0, before - steep))
        one[1] = 0 if cells["BZH13"] else speed
        machine.position[axis] += direction * one[1]
        if one[1] > 0:
            cells[f"SM_PO{axis}PI"] = int(direction < 0)
        else:
            del self.moving[axis]
