#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare the PLC language of the CNC872 with an interpreter written from the specification alone (NP1-NP8).

    cnc872_plc.py SUBJECT [COUNT [SEED]]

SUBJECT is plc_subject. COUNT random programs with mechanisms that wait, jumps, timed waits, whole and real numbers; every bit,
variable and register has to be equal at the end of each cycle. Nothing here is taken from the product."""
import math
import random
import re
import struct
import subprocess
import sys

WIDTH = dict(BYTE=1, WORD=2, DWRD=4, QWRD=8, REAL=8)
KIND = dict(DB="BYTE", DW="WORD", DD="DWRD", DQ="QWRD")
TICKS = 40


def cut(value, width, signed):
    value &= (1 << 8 * width) - 1
    return value - (1 << 8 * width) if signed and value >> (8 * width - 1) else value


def whole(real):
    """DR after an operation of reals: cut towards 0, the nearest number of 64 bits."""
    if math.isnan(real):
        return 0
    return int(max(-2.0 ** 63, real)) if real < 2.0 ** 63 else (1 << 63) - 1


class Model:
    def __init__(self, text):
        self.cells = {"BZH09": ["BYTE", bytearray(2)], "LIMIT_FEED": ["DWRD", bytearray(4)],
                      "FEED_OVR_MULTIPLIER": ["WORD", bytearray(b"\xe8\x03")], "REFPOINT_DIST": ["QWRD", bytearray(128)]}
        self.bits, self.parts, self.shown = {}, {}, []
        self.rlo, self.dr, self.real = 0, 0, 0.0
        self.read(text)
        self.place = dict.fromkeys(self.parts, 0)

    def read(self, text):
        stack, in_data = [], False
        for line in text.split("\n"):
            word, _, rest = line.strip().partition(" ")
            if word in ("DATA", "DATA_END"):
                in_data = word == "DATA"
            elif in_data:
                self.declare(word, *rest.split())
            elif word.startswith("MODULE") and not word.endswith("_END"):
                stack.append((word, []))
            elif word == "MECH_BEGIN":
                self.declare(rest, "BIT", "0")
                stack[-1][1].append(("MECHANISM", [rest]))
                stack.append((rest, []))
            elif word.endswith("_END"):
                name, code = stack.pop()
                self.parts[name] = code
            elif word.endswith(":"):
                stack[-1][1].append(("LABEL", [word[:-1]]))
            elif word:
                stack[-1][1].append((word, rest.split(",") if rest else []))

    def declare(self, name, kind, value):
        self.shown.append(name)
        if kind == "BIT":
            self.bits[name] = int(value)
        else:
            self.cells[name] = [KIND[kind], bytearray(int(value).to_bytes(WIDTH[KIND[kind]], "little"))]

    def find(self, text):
        """Type, bytes and offset of an operand of memory."""
        written, name, index, offset = re.fullmatch(r"(?:(\w+)\.)?\(?(\w+)(?:\[(\d+)\])?(?:\+(\d+))?\)?", text).groups()
        own, memory = self.cells[name]
        return written or own, memory, int(index or 0) * WIDTH[own] + int(offset or 0)

    def value(self, text):
        """Type and value of an operand."""
        if text.startswith("CNST."):
            return "QWRD", int(text[5:])
        kind, memory, at = self.find(text)
        some = bytes(memory[at:at + WIDTH[kind]])
        if kind == "REAL":
            return kind, struct.unpack("<d", some)[0]
        return kind, int.from_bytes(some, "little", signed=kind in ("DWRD", "QWRD"))

    def put(self, text, number):
        kind, memory, at = self.find(text)
        some = struct.pack("<d", self.real) if kind == "REAL" else cut(number, WIDTH[kind], False).to_bytes(WIDTH[kind], "little")
        memory[at:at + WIDTH[kind]] = some

    def compare(self, name, left, right):
        self.rlo = int(dict(EQ=left == right, LE=left <= right, LT=left < right, GE=left >= right, GT=left > right)[name])

    def calculate(self, name, text):
        kind, value = self.value(text)
        if name in ("EQ", "LE", "LT", "GE", "GT"):
            self.compare(name, self.real if kind == "REAL" else self.dr, value)
        elif kind == "REAL":
            self.real = dict(LOD=lambda: value, AD=lambda: self.real + value, SU=lambda: self.real - value,
                             MULB=lambda: self.real * value, DIVB=lambda: self.real / value if value else 0.0)[name]()
            self.dr = whole(self.real)
        else:
            dr = self.dr
            result = dict(LOD=lambda: value, AD=lambda: dr + value, SU=lambda: dr - value, MULB=lambda: dr * value,
                          DIVB=lambda: (abs(dr) // abs(value) * (1 if (dr < 0) == (value < 0) else -1)) if value else 0,
                          ORB=lambda: dr | value, ANDB=lambda: dr & value, XORB=lambda: dr ^ value)[name]()
            self.dr = cut(result, 8, True)

    def work(self, name, words):
        """An instruction that goes on with the next one."""
        if name in ("LDR", "LA", "LO", "LX"):
            bit = self.bits[words[0]]
            self.rlo = dict(LDR=bit, LA=self.rlo & bit, LO=self.rlo | bit, LX=self.rlo ^ bit)[name]
        elif name == "WR":
            self.bits[words[0]] = self.rlo
        elif name == "CA":
            self.rlo ^= 1
        elif name in ("FL", "FL1"):
            if name == "FL" or self.rlo:
                self.bits[words[1]] = int(words[0])
        elif name == "STO":
            self.put(words[0], self.dr)
        elif name == "ABS":
            self.dr = abs(cut(self.dr, WIDTH[words[0]], True)) & (1 << 64) - 1
            self.dr = cut(self.dr, 8, True)
        elif name == "RR":
            self.dr = cut(cut(self.dr, WIDTH[words[1]], False) >> int(words[0][5:]), 8, True)
        else:
            self.calculate(name, words[0])

    def wait(self, part, name, words, at):
        """EX, EX0, EX1, TEX0: where it goes on, None if the call ends."""
        code = self.parts[part]
        if name == "EX":
            self.place[part] = at
            return None
        if name == "TEX0":
            counter, time, label, number = words
            late = False
            if not self.rlo:
                self.put(counter, self.value(counter)[1] + 1)
                late = self.value(counter)[1] >= int(time)
            if self.rlo or late:
                self.put(counter, 0)
            if late:
                self.dr, at = int(number), code.index(("LABEL", [label]))
            elif not self.rlo:
                return None
        elif self.rlo == int(name[2]):
            return None
        self.place[part] = at
        return at

    def call(self, part):
        """Whether the part has ended."""
        code, at = self.parts[part], self.place[part]
        while at < len(code):
            name, words = code[at]
            at += 1
            if name == "MECHANISM":
                if not self.bits[words[0]]:
                    self.place[words[0]] = 0
                elif self.call(words[0]):
                    self.bits[words[0]] = 0
            elif name == "LABEL":
                continue
            elif name in ("JUM", "JL0", "JL1"):
                if name == "JUM" or self.rlo == int(name[2]):
                    at = code.index(("LABEL", words))
            elif "EX" in name:
                at = self.wait(part, name, words, at)
                if at is None:
                    return False
            else:
                self.work(name, words)
        self.place[part] = 0
        return True

    def show(self, has_ended):
        row = [self.bits[name] if name in self.bits else
               "%.17g" % struct.unpack("<d", bytes(self.cells[name][1])) if name[0] == "R" else self.value(name)[1]
               for name in self.shown]
        return " ".join(map(str, [int(has_ended), *row, self.dr, self.rlo, "%.17g" % self.real]))


def run(text, seed):
    model, lines = Model(text), []
    model.call("MODULE_INIT")
    for _ in range(TICKS):
        for i in range(4):
            seed = (seed * 1103515245 + 12345) & 0xFFFFFFFF
            model.bits[f"IN{i}"] = seed >> 16 & 1
        has_ended = model.call("MODULE_BLOCK_INIT")
        model.call("MODULE_MAIN")
        lines.append(model.show(has_ended))
    return lines


VARIABLES = [f"V{kind[1]}{i}" for kind in KIND for i in range(2)]
BITS = [f"IN{i}" for i in range(4)] + [f"B{i}" for i in range(4)] + ["ME0", "ME1", "ME2"]
PARTS = ["BYTE.VD0+1", "WORD.(VQ1+2)", "DWRD.VQ0+4", "BYTE.VW0+1", "REFPOINT_DIST[15]", "WORD.LIMIT_FEED+2", "WORD.BZH09"]
FORMS = [  # how often, names, words
    (20, "LDR LA LO LX", lambda rng: rng.choice(BITS)),
    (6, "WR", lambda rng: rng.choice(BITS[4:])),
    (3, "CA", lambda rng: ""),
    (9, "FL FL1", lambda rng: f"{rng.randint(0, 1)},{rng.choice(BITS[4:])}"),
    (20, "LOD LOD AD SU ORB ANDB XORB MULB DIVB", lambda rng: random_number(rng)),
    (9, "STO", lambda rng: rng.choice(VARIABLES + PARTS)),
    (7, "EQ LE LT GE GT", lambda rng: random_number(rng)),
    (2, "ABS", lambda rng: rng.choice("BYTE WORD DWRD QWRD".split())),
    (2, "RR", lambda rng: f"CNST.{rng.choice((0, 1, 3, 40, 63))},{rng.choice('BYTE WORD DWRD QWRD'.split())}"),
    (8, "LOD AD SU MULB DIVB EQ LT GE STO", lambda rng: f"REAL.R{rng.randint(0, 1)}"),
]
MAKE = [form for form in FORMS for _ in range(form[0])]


def random_number(rng):
    return rng.choice((f"CNST.{rng.choice((0, 1, 2, 7, 255, 65535, 100000, 2 ** 40))}", rng.choice(VARIABLES),
                       rng.choice(VARIABLES), rng.choice(PARTS), "FEED_OVR_MULTIPLIER"))


def random_code(rng, count, may_wait):
    """Lines of code; jumps go forward, so that there is no loop without an end."""
    marks = sorted(rng.sample(range(count), rng.randint(0, 3)))
    lines = []
    for i in range(count):
        lines += [f"L{mark}:" for mark in marks if mark == i]
        targets = [f"L{mark}" for mark in marks if mark > i]
        if targets and rng.random() < 0.1:
            lines.append(f"{rng.choice(('JUM', 'JL0', 'JL1'))} {rng.choice(targets)}")
        elif may_wait and rng.random() < 0.12:
            timed = [f"TEX0 C{rng.randint(0, 1)},{rng.randint(1, 5)},{rng.choice(targets)},9"] if targets else []
            lines.append(rng.choice(["EX", "EX0", "EX1", *timed]))
        else:
            _, names, words = rng.choice(MAKE)
            lines.append(f"{rng.choice(names.split())} {words(rng)}".strip())
    return lines


def random_program(rng):
    lines = ["DATA", *(f"IN{i} BIT 0" for i in range(4)), *(f"B{i} BIT {rng.randint(0, 1)}" for i in range(4))]
    lines += [f"V{kind[1]}{i} {kind} {rng.choice((0, 1, 5, 100, 255))}" for kind in KIND for i in range(2)]
    lines += [f"R{i} DQ {struct.unpack('<q', struct.pack('<d', rng.choice((0.0, 1.0, 2.5, 0.75, 1e9))))[0]}" for i in range(2)]
    lines += ["C0 DW 0", "C1 DB 0", "DATA_END", "MODULE_INIT", *random_code(rng, 5, False), "MODULE_INIT_END"]
    lines += ["MODULE_BLOCK_INIT", *random_code(rng, 15, True), "MODULE_BLOCK_INIT_END", "MODULE_MAIN"]
    for i in range(3):
        lines += [f"MECH_BEGIN ME{i}", *random_code(rng, 12, True), f"MECH_END ME{i}"]
    return "\n".join([*lines, *random_code(rng, 10, False), "MODULE_MAIN_END", ""])


def main():
    subject, count, seed = sys.argv[1], *map(int, [*sys.argv[2:], *("300", "1")[len(sys.argv) - 2:]])
    rng = random.Random(seed)
    programs = [(random_program(rng), rng.getrandbits(32)) for _ in range(count)]
    asked = "".join(f"program {TICKS} {start}\n{text}.\n" for text, start in programs)
    answer = subprocess.run([subject], input=asked, capture_output=True, text=True, check=True).stdout.split("\n\n")
    for number, ((text, start), got) in enumerate(zip(programs, answer)):
        wanted, lines = run(text, start), got.strip("\n").split("\n")
        for tick in range(TICKS):
            if tick >= len(lines) or lines[tick] != wanted[tick]:
                sys.exit(f"program {number} of seed {seed}, cycle {tick}:\n{text}\nsubject: {lines[min(tick, len(lines) - 1)]}\n"
                         f"model:   {wanted[tick]}")
    print(f"{count} PLC programs, {TICKS} cycles each: equal")


main()
