#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare block machine and motion of the CNC872 with a model in whole numbers.

    cnc872.py SUBJECT [COUNT [SEED]]

SUBJECT is cnc_subject. COUNT stories: a random machine and NC program; starts, stops, annulments, overrides and switches at
random times. Everything has to be equal at the end of each T. Nothing here is taken from the product."""
import random
import subprocess
import sys
from fractions import Fraction

import cnc872_technology as technology
from cnc872_machine import Block, Machine

MM = 65536000
SHOWN = ("PO_F PO_POL PO_STOP SF_STOP G23ACT BLOCK_RESTART CAPI REFPI INPOS PO_OSXPI PO_OSYPI PO_OSZPI SM_POXPI SM_POYPI "
         "SM_POZPI MPX MPY ACK_AUTMAN SF_STOPPOSCHANGED INPOS_STOP SF_LS PRODLEVA SF_RUN SF_BLOCKFINISHED STATUS_RESTART "
         "TIME_DIST HOMING HOMING_REQ HOMING_START_REQ").split() + technology.BITS + technology.NUMBERS
NAMES = dict(feed=["Feed"], feed_rapid=["FeedRT"], feed_slow=["FeedSlow"], feed_reference=["FeedRef"], lag=["Lag"],
             direction=["RefDir"], null_point=["MachineNullPoint"],
             acceleration=["Acceleration", "AccelerationRT", "AccelerationEmergency"],
             linear=["LinearAccel", "LinearAccelRT", "LinearAccelEmergency"],
             parabolic=["ParabAccel", "ParabAccelRT", "ParabAccelEmergency"])


def random_axis(rng):
    few = lambda low, high: [rng.randint(low, high) for _ in range(3)]
    return dict(feed=rng.randint(100, 9000), feed_rapid=rng.randint(500, 20000),
                feed_slow=rng.randint(50, 2000), feed_reference=rng.randint(50, 2000), direction=rng.choice("+-"),
                null_point=rng.choice((0, 0, -7)), lag=rng.choice((1, 1, 1, 7, 20)),
                acceleration=few(100, 9000), linear=few(100, 9000), parabolic=few(5, 300))


def random_gears(rng):
    """number -> (lowest, highest speed); all numbers from 1 to 4, or some."""
    known = (1, 2, 3, 4) if rng.random() < 0.6 else sorted(rng.sample(range(1, 6), rng.randint(1, 4)))
    return {gear: (rng.choice((0, 0, 50)), rng.randint(300, 1500) * gear) for gear in known}


def random_functions(rng, has_spindle):
    """One of a group."""
    if rng.random() < 0.5:
        return []
    groups = {}
    known = [m for m in [*technology.FIXED, *technology.ADDED, 40, 77, 100] if technology.group_of(m) != 1]
    for m in rng.sample(known, rng.randint(1, 4)):
        if technology.group_of(m) != 2 or not has_spindle:
            groups[technology.group_of(m)] = m
    return list(groups.values())


def write_config(parabolic, axes, gears):
    lines = "".join(f'<Axis Name="{axis}" ' + " ".join(
        f'{name}="{value}"' for key, names in NAMES.items()
        for name, value in zip(names, values[key] if isinstance(values[key], list) else [values[key]])) + "/>"
        for axis, values in axes.items())
    lines += "".join(f'<Gear No="{gear}" MinSpeed="{low}" MaxSpeed="{high}"/>' for gear, (low, high) in gears.items())
    lines += "<MFunctions>" + "".join(f'<MFunc No="{m}" GroupNo="{group}"/>' for m, group in technology.ADDED.items())
    lines += "</MFunctions>"
    return f'<ChannelConfig AccelerationType="{int(parabolic)}">{lines}</ChannelConfig>'


def random_program(rng, axes):
    """Blocks, and their text."""
    blocks, text, feed = [], [], rng.randint(100, 9000)
    place = dict.fromkeys(axes, 0)
    continuous, spins = rng.random() < 0.5, rng.random() < 0.4
    cuts, speed, cut_speed, limit = False, 0, 0, 9999
    for index in range(rng.randint(1, 6)):
        kind = rng.random()
        turns = spins and rng.random() < 0.6
        g = 0 if kind < 0.15 else 33 if spins and kind < 0.4 else 1
        delay = rng.randint(0, 60) if rng.random() < 0.15 else None
        m = rng.choice((0, 1, 2, 30)) if rng.random() < 0.1 else None
        moved = list(axes)[:1] if kind < 0.7 else rng.sample(list(axes), rng.randint(0, len(axes)))
        step = rng.choice((1, 20, 300, 3000))
        for axis in moved:
            place[axis] += rng.randint(0, step) if continuous and axis == "X" else rng.randint(-step, step)
        if spins:
            feed = Fraction(rng.randint(1, 9000), 1000) if turns or g == 33 else rng.randint(100, 9000)
        elif rng.random() < 0.5:
            feed = rng.randint(100, 9000)
        functions = [rng.choice((3, 3, 4, 5))] if spins and (index == 0 or rng.random() < 0.2) else []
        functions += random_functions(rng, functions)
        functions += [m] if m is not None else []
        t = rng.randint(0, 99999999) if rng.random() < 0.1 else None
        h = rng.randint(0, 1000000) if rng.random() < 0.1 else None
        has_speed, switches = spins and rng.random() < 0.4, rng.random() < 0.2
        cuts = cuts != switches
        if has_speed and cuts:
            cut_speed = rng.randint(1, 500)
        elif has_speed:
            speed = rng.randint(1, 2500)
        if cuts and switches:
            limit = rng.randint(1, 4000)
        words = [f"G{23 if continuous else 24}"] if index == 0 else []
        words += [f"G{g}"] + [f"{axis}{place[axis] / 1000:.3f}" for axis in moved] if moved else []
        words += [f"G{95 if turns else 94}", f"F{float(feed):.3f}", f"G4 P{delay / 1000:.3f}" if delay is not None else ""]
        words += [f"G{96 if cuts else 97}"] if switches else []
        words += [f"S{cut_speed if cuts else speed}"] if has_speed else []
        words += [f"L{limit}"] if (cuts and switches) or index == 0 else []
        words += [f"M{one}" for one in functions]
        words += [f"{letter}{value}" for letter, value in (("T", t), ("H", h)) if value is not None]
        text.append(" ".join(word for word in words if word))
        blocks.append(Block(g, {axis: place[axis] * MM // 1000 for axis in moved}, feed, delay, continuous, turns,
                            functions, t, h, (speed, cut_speed, limit, cuts, has_speed)))
    return blocks, text


def random_action(rng, axes):
    axis = rng.choice(list(axes))
    return rng.choice((
        ("stop",), ("stop",), ("reset",), ("bit", "STOP_EMERGENCY_REQ", 1), ("bit", "STOP_REQ", 1),
        ("bit", "STOPPI", rng.randint(0, 1)), ("bit", f"MP{axis}PI", rng.randint(0, 1)), ("bit", f"KH{axis}0", rng.randint(0, 1)),
        ("bit", f"VAZBA_{axis}", rng.randint(0, 1)), ("bit", f"ZP{axis}1", rng.randint(0, 1)),
        ("bit", "START_DISABLE", rng.randint(0, 1)), ("bit", "FEED_OVR", rng.randint(0, 1)), ("pot", rng.randint(0, 200)),
        ("pot", rng.randint(0, 200)), ("cell", "FEED_OVR_MULTIPLIER", rng.randint(0, 1500)),
        ("cell", "LIMIT_FEED", rng.randint(-9, 3000000)), ("bit", "LIMIT_FEED_REQ", rng.randint(0, 1)),
        ("cell", "LIMIT_FEED_G00", rng.randint(0, 9000000)), ("bit", "LIMIT_FEED_G00_REQ", rng.randint(0, 1)),
        ("rtm", rng.choice((0, 0, 7))), ("m01", rng.randint(0, 1)), ("single", rng.randint(0, 1)),
        ("bit", "EXT_PLC", rng.randint(0, 1)), ("bit", "PLC_PASS_DONE", 1), ("cell", "WORD.BZH09", rng.randint(0, 2000)),
        ("cell", "SIM_SPEED_PT", rng.randint(0, 20000)),
        ("bit", "REQ_LINEARACCEL", rng.randint(0, 1)), ("cell", "dwAxGLinearAccel", rng.randint(-9, 500000)),
        *random_manual(rng, axis), *random_spindle(rng)))


def random_spindle(rng):
    flag, number = rng.randint(0, 1), rng.randint(0, 2000)
    yield from (("bit", name, flag) for name in ("SPEED_OVR", "REQ_EXT_SPINDLE_GEAR", "REQ_MAN_SPINDLE_GEAR"))
    yield from (("cell", name, number) for name in ("SPEED_OVR_EXT", "SPEED_OVR_MULTIPLIER"))
    yield from (("spindle", rng.randint(0, 200)), ("cell", "SPINDLE_GEAR_ACT_1", rng.randint(0, 6)))


def random_manual(rng, axis):
    """What moves an axis beside its program."""
    flag = rng.randint(0, 1)
    yield from (("bit", name, flag) for name in ("AUTMAN_REQ", "AUTMAN_REQ", "EN_AUTMAN", "REQ_EXT_FEED_AUTMAN",
                                                 "REQ_EXT_G00_AUTMAN", f"EXM_{axis}0", f"EXM_{axis}0", f"EXM_{axis}1"))
    yield from (("bit", "REQ_EXT_CONT_AUTMAN", int(rng.random() < 0.8)),
                ("bit", "REQ_EXT_SELECT_AUTMAN", int(rng.random() < 0.2)),
                ("cell", "EXT_FEED_AUTMAN", rng.randint(0, 9000)), ("cell", "EXT_FEED_G00_AUTMAN", rng.randint(0, 9000)),
                ("cell", f"REFPOINT_DIST[{'XYZ'.index(axis)}]", rng.randint(-MM, MM)), ("cell", "HOMING_REQ", rng.randint(0, 7)))


def random_excursion(rng, axes):
    """A stop, the axes are moved or get another position, and the program goes on: how many T's later, and what."""
    axis, rest, sign = rng.choice(list(axes)), rng.randint(1, 90), rng.randint(0, 1)
    yield 0, rng.choice((("stop",), ("bit", "STOP_EMERGENCY_REQ", 1)))
    if rng.random() < 0.3:
        yield rest, ("cell", f"REFPOINT_DIST[{'XYZ'.index(axis)}]", rng.randint(-MM, MM))
        yield rest, ("cell", "HOMING_REQ", 1 << "XYZ".index(axis))
    else:
        yield from ((rest, ("bit", name, 1)) for name in ("EN_AUTMAN", "AUTMAN_REQ", "REQ_EXT_CONT_AUTMAN", f"EXM_{axis}{sign}"))
        yield rest, ("bit", "REQ_EXT_SELECT_AUTMAN", 0)
        if rng.random() < 0.5:
            names = f"KH{axis}{sign}", f"MP{axis}PI", f"ZP{axis}1", "REQ_EXT_FEED_AUTMAN"
            yield rest + 5, ("bit", rng.choice(names), rng.randint(0, 1))
        if rng.random() < 0.3:
            yield rest + 10, rng.choice((("stop",), ("bit", "STOP_EMERGENCY_REQ", 1), ("bit", f"EXM_{axis}{1 - sign}", 1)))
        rest += rng.randint(1, 60)
        yield from ((rest, ("bit", f"EXM_{axis}{one}", 0)) for one in (0, 1))
        yield rest, ("bit", f"KH{axis}{sign}", 0)
        rest += rng.randint(20, 100)
        yield rest, ("bit", "AUTMAN_REQ", 0)
    yield rest + 2, ("start",)


def random_search(rng, axes):
    """References of one or two axes, with their switches: how many T's later, and what."""
    yield 0, ("cell", "HOMING_START_REQ", rng.randint(1, 7))
    for axis in rng.sample(list(axes), rng.randint(1, 3)):
        later = rng.randint(0, 3)
        for _ in range(rng.randint(1, 6)):
            yield later, ("bit", f"{rng.choice(('KR', 'KR', 'KR', 'KRR', 'ZPR'))}{axis}", rng.randint(0, 1))
            later += rng.choice((1, 5, 30, 90))
        yield later, ("bit", f"KR{axis}", 0)
        yield later + rng.randint(1, 40), ("bit", f"KR{axis}", 1)
    if rng.random() < 0.5:
        yield rng.randint(1, 200), rng.choice((
            ("stop",), ("reset",), ("bit", f"MP{axis}PI", 0), ("rtm", 3), ("bit", "EXT_PLC", 1),
            ("bit", f"KH{axis}{rng.randint(0, 1)}", 1), ("bit", "STOP_EMERGENCY_REQ", 1)))
        yield rng.randint(200, 300), rng.choice((("rtm", 0), ("bit", f"MP{axis}PI", 1), ("bit", "EXT_PLC", 0)))


def calm(axes):
    """All back to what lets motions go on."""
    yield from (("bit", name, 0) for name in ("STOPPI", "START_DISABLE", "FEED_OVR", "LIMIT_FEED_REQ", "LIMIT_FEED_G00_REQ",
                                              "EXT_PLC", "AUTMAN_REQ"))
    yield from (("bit", f"{name[0]}{axis}{name[1]}", value) for axis in axes
                for name, value in ((("MP", "PI"), 1), (("KH", "0"), 0), (("KH", "1"), 0), (("VAZBA_", ""), 1), (("ZP", "1"), 0)))
    yield from (("pot", 100), ("cell", "FEED_OVR_MULTIPLIER", 1000), ("cell", "SIM_SPEED_PT", 6000), ("rtm", 0))


def apply(machine, action):
    kind, *rest = action
    if kind in ("bit", "cell"):
        machine.cells[rest[0].removeprefix("WORD.")] = rest[1]
    elif kind == "pot":
        machine.pot = rest[0]
    elif kind == "spindle":
        machine.technology.pot = rest[0]
    elif kind == "rtm":
        machine.cells["BZH13"] = rest[0]
    elif kind == "m01":
        machine.m01 = bool(rest[0])
    elif kind == "single":
        machine.block_by_block = bool(rest[0])
    else:
        getattr(machine, kind)()


def run_story(rng):
    """Returns the commands for the subject, and what each T must be."""
    parabolic, axes, gears = rng.random() < 0.5, {axis: random_axis(rng) for axis in "XYZ"}, random_gears(rng)
    program, text = random_program(rng, axes)
    machine = Machine(parabolic, axes, program, gears)
    lines = [f"config {write_config(parabolic, axes, gears)}"] + [f"nc {line}" for line in text] + ["power"]
    lines += [f"show {name}" for name in SHOWN]
    wanted, busy, turns, planned = [], rng.choice((20, 60, 200)), rng.randint(100, 1500), {}
    wanders = rng.choice((0, 0.003, 0.01))
    for turn in range(turns):
        actions = [("start",)] if turn % 97 == 0 or rng.random() < 0.02 else []
        if turn == 0:
            actions.append(("cell", "SIM_SPEED_PT", rng.choice((0, 6000, 20000))))
        if turn < turns * 2 // 3 and rng.random() < 1 / busy:
            actions.append(random_action(rng, axes))
        if rng.random() < wanders:
            for later, action in random_excursion(rng, axes) if rng.random() < 0.7 else random_search(rng, axes):
                planned.setdefault(turn + later, []).append(action)
        actions += planned.get(turn, [])
        if turn == turns * 2 // 3:
            actions += calm(axes)
        for action in actions:
            apply(machine, action)
            lines.append(" ".join(map(str, action)))
        lines.append("tick")
        machine.tick()
        wanted.append([*(machine.position[axis] for axis in "XYZ"), machine.v, machine.phase,
                       -1 if machine.block is None else machine.block, *(machine.cells[name] for name in SHOWN)])
    return lines + ["end"], wanted


def compare(subject, seed, number):
    lines, wanted = run_story(random.Random(f"{seed} {number}"))
    out = subprocess.run([subject], input="\n".join(lines) + "\n", stdout=subprocess.PIPE, text=True, check=True).stdout
    got = [list(map(int, line.split())) for line in out.split("\n") if line]
    for turn, (one, other) in enumerate(zip(got, wanted), 1):
        if one != other:
            names = "x y z v phase block".split() + SHOWN
            print(f"story {number}, T {turn}: " + "; ".join(f"{name} {a}, expected {b}" for name, a, b in zip(names, one, other)
                                                            if a != b))
            ticks = [at for at, line in enumerate(lines) if line == "tick"]
            print("    " + "\n    ".join(f"{lines[:at].count('tick') + 1}: {line}" for at, line in enumerate(lines)
                                         if at < ticks[turn - 1] and line != "tick" and not line.startswith("show ")))
            return 0, 1
    return len(wanted), int(len(got) != len(wanted))


def main():
    subject, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 200
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    results = [compare(subject, seed, number) for number in range(count)]
    wrong = sum(result[1] for result in results)
    print(f"{count} stories, {sum(result[0] for result in results)} T's compared: {wrong} went wrong")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
