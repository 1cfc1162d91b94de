# SPDX-License-Identifier: MIT
"""drive.py: what the tests of the STM32F405 do with it. Arguments: what to do, the firmware's ELF file, and what else the
function takes; exits with status 1 and a line that says what is wrong."""
import re
import subprocess
import sys

sys.dont_write_bytecode = True

from stm32 import IDLE, INTERRUPTS, NOW, WORST, Board, Gone  # noqa: E402

LATE = 2  # us by which the interrupt may come after its tick
PULSE = 10  # us


class Wrong(Exception):
    """What it did is not what it should have done."""


def check(right, what):
    if not right:
        raise Wrong(what)


def set_program(board, text, motor=0):
    answer = board.ask(f"\x02{motor}{text}".encode("latin-1"))
    check(answer is not None and answer[2] == 0, f"{text}: answered {answer}")


def expected(board, replay):
    """What the core asks for when it is called as the firmware called it: of each power-up (name, number) -> [(tick, value)]."""
    calls = "\n".join(call for power in board.powers for call in power.calls) + "\n"
    done = subprocess.run([replay], input=calls, stdout=subprocess.PIPE, text=True, check=True)
    for text in done.stdout.split("i\n")[1:]:
        pins = {}
        for name, number, tick, value in (line.split() for line in text.splitlines()):
            pins.setdefault((name, int(number)), []).append((int(tick), int(value)))
        yield pins


def compare(board, replay):
    """Each change of the pins with the core's. Returns { name: [how often, least, most us late] }."""
    found = {}
    for power, wanted in zip(board.powers, expected(board, replay), strict=True):
        for key in wanted.keys() | power.pins.keys():
            due = sorted(pair for pair in wanted.get(key, []) if pair[0] < power.now - 1000)
            seen = power.pins.get(key, [])
            if key[0] == "step":
                seen = [(tick, value) for tick, value in seen if value == 1]
                ends = [tick for tick, value in power.pins.get(key, []) if value == 0]
                check(all(PULSE <= end - tick <= PULSE + LATE for (tick, _), end in zip(seen, ends)), f"{key}: not 10 us long")
            extra = [tick for tick, _ in seen if tick < power.now - 1000 - LATE]
            check(len(extra) <= len(due) <= len(seen), f"{key}: expected {len(due)} changes, got {len(extra)}")
            for (tick, value), (at, level) in zip(due, seen):
                check(value == level, f"{key} at {tick}: expected {value}, got {level}")
                check(0 <= at - tick <= LATE, f"{key} at {tick}: it came {at - tick} us late")
                count, least, most = found.get(key[0], (0, LATE, 0))
                found[key[0]] = (count + 1, min(least, at - tick), max(most, at - tick))
    return found


def told(found):
    return "\n".join(f"{name}: {count}, {least} to {most} us late" for name, (count, least, most) in sorted(found.items()))


def store(board):
    """Store Flash, and the power cut in the middle of it, at every operation of the flash: the old program or the new one."""
    old, new = b"C100 S2000 V2000 F120 R", b"C100 S2000 V2000 " + b" ".join([b"F7 R"] * 100)
    set_program(board, "\\ " + old.decode(), 4)
    check(board.ask(b"\x034") == b"\x034\0", "the program is not stored")
    board.run(1_500_000)
    seen = []
    for operation in range(1, 60):
        set_program(board, "\\ " + new.decode(), 4)
        board.cut_power_in(operation)
        powers = len(board.powers)
        answer = board.ask(b"\x034")
        if len(board.powers) == powers:
            check(answer == b"\x034\0", f"the new program is not stored: {answer}")
            break
        board.run(1_000_000)
        program, position = board.ask(b"\x054"), board.ask(b"\x044")
        check(program in (b"\x054" + old, b"\x054" + new), f"power cut {operation}: the program is {program}")
        check(int(position[3:]) == (120 if old in program else 700), f"power cut {operation}: motor 4 is at {position}")
        seen.append(old in program)
        if new in program:
            set_program(board, "\\ " + old.decode(), 4)
            check(board.ask(b"\x034") == b"\x034\0", "the program is not stored")
    board.power()
    check(board.ask(b"\x054") == b"\x054" + new, "the new program is gone")
    check(True in seen and len(seen) > 6, f"the power was cut {len(seen)} times")
    print(f"power cut at {len(seen)} operations")


def manual(board, replay, *scenarios):
    """The manual's examples: a scenario's inputs and programs come 2 s apart."""
    for path in scenarios:
        board.power()
        with open(path, encoding="utf-8") as file:
            text = file.read()
        steps = re.findall(r"^(?: {2}- )?di: \{(.*)\}$|^ {2}- set: '(.*)'$|^ {2}- set: \|\n((?: {6}.*\n)+)", text, re.MULTILINE)
        for inputs, one, many in steps:
            if inputs:
                board.set_inputs(sum(1 << int(number) - 1 for number in re.findall(r'"(\d+)": 1', inputs)))
            else:
                set_program(board, re.sub(r"\n *", "\n", (one or many).strip()), 1)
            board.run(2_000_000)
        board.run(2_000_000)
    found = compare(board, replay)
    check(found["step"][0] > 50000, f"only {found['step'][0]} pulses")
    print(told(found))


FULL = "\\ S2000 V16000 A60000 F16000000 R"
INSTRUCTION = 8  # ns


def pulses_of(board):
    return sum(len(changes) for (name, _), changes in board.powers[-1].pins.items() if name == "step") / 2


def figures(board):
    """Instructions for a pulse, in the main loop and in interrupts: at full speed and on a ramp; of the longest interrupt."""
    for name, program, begin, length in (("level", FULL, 500_000, 500_000),
                                         ("ramp", "\\ S100 V16000 A20000 F16000000 R", 20_000, 700_000)):
        board.power()
        set_program(board, program)
        board.run(begin)
        before, pulses = dict(board.count()), pulses_of(board)
        board.run(length)
        after, pulses = board.count(), pulses_of(board) - pulses
        passed, idle, interrupts = ((after[key] - before[key]) % 2**32 / INSTRUCTION / pulses
                                    for key in (NOW, IDLE, INTERRUPTS))
        print(f"{name}_main_loop {passed - idle - interrupts:.0f}\n{name}_interrupts {interrupts:.0f}")
    print(f"worst_interrupt {after[WORST] // INSTRUCTION}")


def late(board, replay):
    """How late the latest pulse is: four motors at full speed begin together; a request of 1024 bytes comes; three begin
    compounds of ten segments while one runs."""
    set_program(board, FULL)
    board.run(500_000)
    ends = [board.powers[-1].now]
    set_program(board, ("F16000000 V16000 A60000 " * 43)[:1010].rsplit(" ", 1)[0])
    board.run(100_000)
    ends.append(board.powers[-1].now)
    set_program(board, "\\ S137")
    set_program(board, FULL, 4)
    board.run(300_000)
    speeds = (9973, 15013, 501, 7013, 16000, 99, 12007, 1999, 15991, 777)
    for motor in (1, 2, 3):
        set_program(board, " ".join(f"F{1000 + i} V{speed} A{1000 + 997 * i} Y" for i, speed in enumerate(speeds)) + " R", motor)
    board.run(300_000)
    ends.append(board.powers[-1].now)
    found = [0, 0, 0]
    (wanted,) = expected(board, replay)
    for key in wanted:
        if key[0] == "step":
            seen = [tick for tick, value in board.powers[-1].pins[key] if value == 1]
            for (due, _), tick in zip(wanted[key], seen):
                phase = next((number for number, end in enumerate(ends) if due < end), 2)
                found[phase] = max(found[phase], tick - due)
    print("late", *found)


TASKS = {"manual": manual, "store": store, "figures": figures, "late": late}

if __name__ == "__main__":
    task, elf, *rest = sys.argv[1:]
    try:
        its = Board(elf, *(int(rest.pop(0)) for _ in range(task == "late")))
        try:
            TASKS[task](its, *rest)
        finally:
            its.close()
    except (Gone, Wrong) as wrong:
        sys.exit(f"drive.py: {task}: {wrong}")
