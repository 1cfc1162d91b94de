# SPDX-License-Identifier: MIT
"""The interpreter of a PMC, slot by slot, from docs/PMC.md section 4 alone. Moves have no limits here."""
from fractions import Fraction

from pmc_motion import SLOT, WIDTH, move


class Axis:
    """Parameters, in what is actual: m, s, a, d, v (four speeds), numerator, denominator."""

    def __init__(self, m, acceleration, deceleration, start_speed, speeds, ratio):
        self.s, self.a, self.d = start_speed * m, 125 * m * acceleration, 125 * m * deceleration
        self.v = [m * speed for speed in speeds]
        self.ratio = Fraction(*ratio)

    def pulses(self, tenths):
        size = abs(Fraction(tenths, 10) * self.ratio)
        n = (2 * size.numerator + size.denominator) // (2 * size.denominator)
        return n if tenths >= 0 else -n


def run(axis, program, passes=False, inputs=(0, 0), limit=500):
    """program: {REG: (op, operands)}; it begins in slot 1. Returns [(slot, REG)], [(slot, outputs)], {output: slot in which its
    OTP is still to end}, position, pulses, whether error PGM ended it (None: `limit` registers are executed, and it goes on),
    and the slot of that."""
    trace, outputs, written, off, stack = [], 0, [], {}, []
    slot, pc, position, pulses = 1, 0, 0, 0

    def write(at, number, on):
        nonlocal outputs
        before, outputs = outputs, outputs | 1 << number if on else outputs & ~(1 << number)
        if outputs != before:
            written.append((at, outputs))

    def pass_until(at):
        """OTPs that end before that slot."""
        for end, number in sorted((end, number) for number, end in off.items() if end < at):
            del off[number]
            write(end, number, False)

    while len(trace) < limit:
        pass_until(slot)
        if pc > 63:
            pass_until(slot + 1)
            return trace, written, off, position, pulses, True, slot
        op, *arg = program.get(pc, ("NOP",))
        here, busy = pc, 1
        trace.append((slot, here))
        pc += 1
        if op in ("ABS", "INC"):
            n = axis.pulses(arg[0]) - (position if op == "ABS" else 0)
            busy = 1 + arg[2]
            if n:
                last = slot * SLOT + move(axis.s, axis.v[arg[1] - 1], axis.a, axis.d, abs(n)).tick(abs(n))
                busy = -(-(last + WIDTH) // SLOT) - slot + arg[2]
            position, pulses = position + n, pulses + abs(n)
        elif op == "TIM":
            busy = arg[0]
        elif op == "OUT":
            off.pop(arg[0], None)
            write(slot, arg[0], arg[1])
        elif op == "OTP":
            off.pop(arg[0], None)
            write(slot, arg[0], True)
            off[arg[0]] = slot + arg[1]
            busy = arg[1] if arg[2] else 1
        elif op == "JMP":
            pc = arg[0]
        elif op == "IJP" and inputs[arg[0]]:
            pc = arg[1]
        failed = False
        if op == "REP":
            level = next((i for i, (reg, _) in enumerate(stack) if reg == here), len(stack))
            del stack[level:]
            failed = level == 3
            stack.append([here, arg[0] - passes])
        elif op == "RPE":
            failed = not stack or stack[-1][0] >= here
            if not failed and stack[-1][1] > 0:
                stack[-1][1] -= 1
                pc = stack[-1][0] + 1
            elif not failed:
                stack.pop()
        pass_until(slot + 1)
        if failed or op == "END":
            return trace, written, off, position, pulses, failed, slot
        slot += busy
    return trace, written, off, position, pulses, None, slot
