# SPDX-License-Identifier: MIT
"""pmc.py: cases for a PMC-1HS or PMC-2HS, real or virtual: tools/conformance --device pmc-2hs --port PORT."""
import argparse
import re
import time

BAUD = 9600
SILENCE = 0.3  # s without a byte that count as no answer
LIMIT = 30     # s until a motion counts as endless


class Different(Exception):
    """The unit does something else than the clause says."""


def same(wanted, found):
    if wanted != found:
        raise Different(f"expected {wanted!r}, found {found!r}")


def until(what, is_so):
    end = time.monotonic() + LIMIT
    while not is_so():
        if time.monotonic() > end:
            raise Different(f"not within {LIMIT} s: {what}")
        time.sleep(0.05)


# ---- The line of text -----------------------------------------------------------------------------------------------------


class Text:
    def __init__(self, port, axes):
        self.port, self.axes = port, axes

    def send(self, line):
        self.port.reset_input_buffer()
        self.port.write(line.encode() + b"\r")

    def ask(self, line):
        """All bytes of the answer."""
        self.send(line)
        found = self.port.read_until(b"\r")
        self.port.timeout, limit = SILENCE, self.port.timeout
        found += self.port.read(1)
        self.port.timeout = limit
        return found.decode("latin-1")

    def silent(self, line):
        self.send(line)
        self.port.timeout, limit = SILENCE, self.port.timeout
        found = self.port.read(1)
        self.port.timeout = limit
        same(b"", found)

    def position(self):
        found = re.fullmatch(r"POS ([0-9A-F]{8})(,[0-9A-F]{8})?\r", self.ask("POS"))
        if not found or (found[2] is None) != (self.axes == 1):
            raise Different("POS: expected eight hexadecimal digits an axis and CR")
        value = int(found[1], 16)
        return value - (1 << 32) if value >> 31 else value

    def is_idle(self):
        found = re.fullmatch(r"INR X ([0-7])\r", self.ask("INR X"))
        if not found:
            raise Different("INR X: expected a digit from 0 to 7 and CR")
        return int(found[1]) & 1 == 0


def case_text_position(unit):
    unit.position()


def case_text_speed(unit):
    unit.send("SPD 1234")
    found = unit.ask("SPD")
    if not re.fullmatch(r"SPD 1234(,\d+)?\n\r", found):
        raise Different(f"expected 'SPD 1234' LF CR, found {found!r}")


def case_text_errors(unit):
    found = unit.ask("ERD X")
    if not re.fullmatch(r"ERD [0-9A-F]{2}\n\r", found):
        raise Different(f"expected 'ERD', two hexadecimal digits, LF CR, found {found!r}")


def case_text_nothing(unit):
    for line in ("pos", "XYZ", "WPG X00", "", "SPD 0", "JOG Z", "STO X"):
        unit.silent(line)


def case_text_moves(unit):
    unit.send("CLL X")
    until("CLL X clears the counter", lambda: unit.position() == 0)
    unit.send("SPD 1000")
    unit.send("PIC 500")
    until("PIC 500 ends at 500", lambda: unit.position() == 500 and unit.is_idle())
    unit.send("PIC -500")
    until("PIC -500 comes back", lambda: unit.position() == 0 and unit.is_idle())


def case_text_busy(unit):
    unit.send("SPD 100")
    unit.send("JOG X")
    until("JOG X moves", lambda: not unit.is_idle())
    unit.silent("PIC -100000")
    unit.silent("STO X")
    until("STO X stops", unit.is_idle)
    place = unit.position()
    time.sleep(1)
    same(place, unit.position())
    if place <= 0:
        raise Different(f"JOG X ended at {place}")


# ---- Modbus ---------------------------------------------------------------------------------------------------------------


def crc(data):
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0xA001 if value & 1 else value >> 1
    return value.to_bytes(2, "little")


class Modbus:
    def __init__(self, port, axes, node):
        self.port, self.axes, self.node = port, axes, node

    def ask(self, text):
        """Function and data, as hexadecimal digits, and those of the answer; "" if there is none."""
        time.sleep(0.01)
        self.port.reset_input_buffer()
        frame = bytes([self.node]) + bytes.fromhex(text)
        self.port.write(frame + crc(frame))
        found = self.port.read(3)
        if not found:
            return ""
        rest = 2 if found[1] & 0x80 else found[2] + 2 if found[1] in (3, 4) else 5
        found += self.port.read(rest)
        if crc(found[:-2]) != found[-2:]:
            raise Different(f"wrong check value: {found.hex()}")
        return found[1:-2].hex()

    def word(self, function, address):
        found = self.ask(f"{function:02x}{address:04x}0001")
        if not re.fullmatch(f"{function:02x}02[0-9a-f]{{4}}", found):
            raise Different(f"register {address:04X}: {found or 'no answer'}")
        return int(found[4:], 16)

    def position(self):
        found = int(self.ask("0400000002")[4:], 16)
        return found - (1 << 32) if found >> 31 else found


def case_modbus_parameters(unit):
    ranges = [(1, 500)] + [(1, 8000)] * 7
    for address, (low, high) in enumerate(ranges, 0x44E):
        value = unit.word(3, address)
        if not low <= value <= high:
            raise Different(f"register {address:04X} is {value}")


def case_modbus_exceptions(unit):
    for request, answer in (("0500000000", "8501"), ("0305000001", "8302"), ("0305000000", "8303"), ("06044e01f5", "8603")):
        same(answer, unit.ask(request))


def case_modbus_moves(unit):
    unit.ask("0600000a01")
    until("0A clears the counter", lambda: unit.position() == 0)
    unit.ask("100001000306610103e80000")
    same("1000010005", unit.ask("10000100050a7201000001f400000000"))
    until("72 ends at 500", lambda: unit.position() == 500 and unit.word(4, 6) == 0)
    unit.ask("10000100050a71010000000000000000")
    until("71 comes back to 0", lambda: unit.position() == 0 and unit.word(4, 6) == 0)


def case_modbus_busy(unit):
    same("0600000120", unit.ask("0600000120"))
    same("8606", unit.ask("0600000120"))
    same("0600000501", unit.ask("0600000501"))
    until("05 stops", lambda: unit.word(4, 6) == 0)


# clause, function, moves the axis
CASES = {
    "ascii": [("AS2", case_text_position, False), ("AS2", case_text_speed, False), ("AS2", case_text_errors, False),
              ("AS4", case_text_nothing, False), ("AS2", case_text_moves, True), ("AS3", case_text_busy, True)],
    "modbus": [("AB3", case_modbus_parameters, False), ("AB2", case_modbus_exceptions, False),
               ("AB5", case_modbus_moves, True), ("AB2", case_modbus_busy, True)],
}


def run(unit, face, still):
    bad = 0
    for clause, case, moves in CASES[face]:
        name = case.__name__[5:].replace("_", " ")
        if moves and still:
            print(f"skip  {clause} {name}: it moves the axis")
            continue
        try:
            case(unit)
            print(f"pass  {clause} {name}")
        except Different as different:
            bad += 1
            print(f"FAIL  {clause} {name}: {different}")
    return 1 if bad else 0


def main(arguments, program):
    parser = argparse.ArgumentParser(prog=program, description="Cases for a PMC-1HS or PMC-2HS. Axis X moves by 500 pulses and "
                                     "back, and a little further: docs/PMC.md.")
    parser.add_argument("--device", choices=("pmc-1hs", "pmc-2hs"), required=True)
    parser.add_argument("--port", required=True, help="serial device, pty, or what pyserial takes (socket://HOST:PORT)")
    parser.add_argument("--face", choices=sorted(CASES), default="ascii", help="what the unit speaks (ascii)")
    parser.add_argument("--node", type=int, default=1, metavar="N", help="its Modbus address (1)")
    parser.add_argument("--baud", type=int, default=BAUD, help=f"speed of the line ({BAUD})")
    parser.add_argument("--no-motion", action="store_true", help="leave out what moves the axis")
    options = parser.parse_args(arguments)
    try:
        import serial
    except ImportError:
        parser.error("there is no pyserial: apt-get install python3-serial")
    try:
        port = serial.serial_for_url(options.port, baudrate=options.baud, timeout=5)
    except (OSError, ValueError) as error:
        print(f"{program}: {options.port}: {error}")
        return 3
    axes = 1 if options.device == "pmc-1hs" else 2
    unit = Text(port, axes) if options.face == "ascii" else Modbus(port, axes, options.node)
    return run(unit, options.face, options.no_motion)
