# SPDX-License-Identifier: MIT
"""What blocks of the CNC872 say to a PLC program, and its spindle, from the text of its specification alone (NG1, NG2, NF2 to
NF5)."""

FIXED = {0: 1, 1: 1, 2: 1, 30: 1, 3: 2, 4: 2, 5: 2, 19: 2, 40: 3, 41: 3, 42: 3, 43: 3, 44: 3, 7: 5, 8: 5, 9: 5, 17: 5, 50: 6,
         51: 6, 52: 6, 53: 6, 10: 7, 11: 7, 48: 8, 49: 8, 6: 9, 60: 9}
ADDED = {18: 8, 20: 2, 39: 3, 91: 10, 92: 11, 93: 12, 94: 13}  # by the configuration
FOR_THE_BLOCK = {0: "M00_PID", 1: "M01_PID", 2: "M02_PID", 30: "M30_PID", 10: "M10PID", 11: "M11PID", 6: "M06PID",
                 60: "M60PI"}
STATIC = {2: {"M03PI": (3,), "M04PI": (4,), "M19PI": (19,)},
          5: {"M07PI": (7, 17), "M08PI": (8, 17)},
          6: {"M50PI": (50, 52), "M51PI": (51, 52)}}
BYTES = {2: "PB06", 10: "PB03", 11: "PB13", 12: "PB14", 13: "PB15", 14: "PB16"}
CHANGES = [f"ZMM{n}PI" for n in range(1, 15)] + ["ZMSHPI", "ZMSTPI"]
GEARS = [f"M4{n}PI" for n in range(1, 5)]
BITS = [*FOR_THE_BLOCK.values(), *(bit for bits in STATIC.values() for bit in bits), *CHANGES, *GEARS]
NUMBERS = [*BYTES.values(), "PB05", "PB07", "PB08", "PB09", "PB10", "WORD.PB11", "VYSOVERS", "REQ_SPEED_PM", "REQ_SPEED_PT",
           "ACT_SPEED_PM", "ACT_SPEED_PT", "SPINDLE_GEAR_ACT_1"]


def group_of(m):
    return ADDED.get(m, FIXED.get(m, 14))


def bcd(number):
    return number // 10 % 10 * 16 + number % 10


class Technology:
    """gears: number -> (lowest, highest speed) in rev/min."""

    def __init__(self, machine, gears):
        self.machine, self.gears, self.override_cancelled, self.automatic, self.block = machine, gears, False, False, None
        machine.cells.update(dict.fromkeys(BITS + NUMBERS, 0), SPINDLE_GEAR_ACT_1=1, SPEED_OVR=0, SPEED_OVR_EXT=0,
                             SPEED_OVR_MULTIPLIER=1000, REQ_EXT_SPINDLE_GEAR=0, REQ_MAN_SPINDLE_GEAR=0, SIM_SPEED_PT=0)
        self.pot, self.threads = 100, False

    def is_external(self):
        return self.machine.cells["REQ_EXT_SPINDLE_GEAR"] and self.machine.cells["REQ_MAN_SPINDLE_GEAR"]

    def asked_gear(self, block):
        """None: the block asks for none."""
        function = next((m for m in block.functions if group_of(m) == 3), None)
        if function in (41, 42, 43, 44):
            return function - 40
        if function != 40 and (function is not None or not self.automatic or not block.has_speed or block.is_cut):
            return None
        known = sorted(gear for gear in self.gears if gear <= 4) or [1]
        return next((gear for gear in known if gear in self.gears and self.gears[gear][1] >= block.speed), known[-1])

    def fits(self, block):
        """NF5."""
        asked = self.asked_gear(block)
        if block.is_cut or self.is_external() or not block.speed or not (block.has_speed or asked):
            return True
        gear = asked or self.machine.cells["SPINDLE_GEAR_ACT_1"]
        return gear not in self.gears or self.gears[gear][0] <= block.speed <= self.gears[gear][1]

    def end(self):
        """Bits that are over with the block."""
        self.machine.cells.update(dict.fromkeys(CHANGES, 0), **dict.fromkeys(FOR_THE_BLOCK.values(), 0))

    def publish(self, block):
        cells, gear, self.block = self.machine.cells, self.asked_gear(block), block
        self.end()
        for m in block.functions:
            group = group_of(m)
            cells[f"ZMM{group}PI"] = 1
            if m in FOR_THE_BLOCK:
                cells[FOR_THE_BLOCK[m]] = 1
            if group in STATIC:
                cells.update({bit: int(m in functions) for bit, functions in STATIC[group].items()})
            if group in BYTES:
                cells[BYTES[group]] = bcd(m)
            if group == 3:
                self.automatic = m == 40
            if m in (48, 49):
                self.override_cancelled = m == 48
        if gear:
            cells["ZMM3PI"] |= not cells[f"M4{gear}PI"]
            cells.update({bit: int(bit == f"M4{gear}PI") for bit in GEARS})
            if not self.is_external():
                cells["SPINDLE_GEAR_ACT_1"] = gear
        if block.t is not None:
            cells.update({f"PB{7 + i:02}": bcd(block.t // 100**i) for i in range(4)}, ZMSTPI=1)
        if block.h is not None:
            cells["ZMSHPI"], cells["PB05"] = 1, bcd(block.h)

    def wanted_speed(self):
        """1/1000 rev/min, before the override."""
        block = self.block
        if block is None or not block.is_cut:
            return (block.speed if block else 0) * 1000
        limit, radius = block.limit * 1000, abs(self.machine.position["X"])
        if not block.cut_speed:
            return 0
        if not radius:
            return limit
        speed = block.cut_speed * 1000 * 10**12 * 65536000 // (2 * 3141592654 * radius)
        return min(limit, speed)

    def show(self):
        """Step 5."""
        cells, speed = self.machine.cells, self.wanted_speed()
        most = self.gears.get(cells["SPINDLE_GEAR_ACT_1"], (0, 4000))[1] * 1000
        programmed = (self.block.speed if self.block else 0) * 1000
        cells["WORD.PB11"] = min(32767, programmed * 32767 // most)
        if not self.threads:
            factor = cells["SPEED_OVR_EXT"] if cells["SPEED_OVR"] else self.pot * 10
            speed = speed * factor * cells["SPEED_OVR_MULTIPLIER"] // 10**6
        voltage = min(32767, speed * 32767 // most)
        pm = voltage * most // 32767
        pt = pm * 6 // 1000
        cells.update(VYSOVERS=voltage, REQ_SPEED_PM=pm, REQ_SPEED_PT=pt)
        if cells["SIM_SPEED_PT"]:
            pm, pt = cells["SIM_SPEED_PT"] * 1000 // 6, cells["SIM_SPEED_PT"]
        turns = cells["M03PI"] or cells["M04PI"]
        cells.update(ACT_SPEED_PM=pm if turns else 0, ACT_SPEED_PT=pt if turns else 0)
