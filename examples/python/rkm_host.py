# SPDX-License-Identifier: MIT
"""A small host library for the RKM04, over anything that pyserial can open. It knows nothing of the emulator.

    with Unit("/dev/ttyUSB0", node=1) as unit:
        axis = Axis(unit, motor=1, home_input=1)
        axis.home()
        axis.move_to(5000)
"""
from __future__ import annotations

import time
from typing import List, Optional

import serial

FLAG, ESCAPE = 0x7E, 0x7D
HOST = 0
VERSION, SET_COMMAND, STORE_FLASH, GET_POSITION, GET_COMMAND, GET_TABLE, GET_PROGRESS = range(1, 8)


class UnitError(Exception):
    """The unit refuses a request."""


class NoAnswer(UnitError):
    """No valid answer came, however often the request was sent."""


class TakesTooLong(UnitError):
    """A motion is not over within the time that was given."""


def fcs16(data: bytes) -> int:
    """The check value of RFC 1662."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value ^ 0xFFFF


def frame(node: int, message: bytes) -> bytes:
    """The bytes of a request."""
    body = bytes([node, HOST]) + message
    body += fcs16(body).to_bytes(2, "little")
    stuffed = bytearray([FLAG])
    for byte in body:
        stuffed += bytes([ESCAPE, byte ^ 0x20]) if byte in (FLAG, ESCAPE) else bytes([byte])
    return bytes(stuffed) + bytes([FLAG])


def unframe(stuffed: bytes) -> Optional[bytes]:
    """What is between two flags: node to, node from, message. None: not a valid frame."""
    body = bytearray()
    escaped = False
    for byte in stuffed:
        if byte == ESCAPE:
            escaped = True
        else:
            body.append(byte ^ 0x20 if escaped else byte)
            escaped = False
    if len(body) < 5 or fcs16(body[:-2]) != int.from_bytes(body[-2:], "little"):
        return None
    return bytes(body[:-2])


class Unit:
    """One unit on a bus.

    port: what pyserial opens. node: 1 to 16. timeout: seconds to wait for an answer. retries: how often a request without an
    answer is sent again.
    """

    def __init__(self, port: str, node: int = 1, timeout: float = 0.5, retries: int = 2) -> None:
        self.node, self.timeout, self.retries = node, timeout, retries
        self.port = serial.serial_for_url(port, baudrate=19200, timeout=timeout)

    def __enter__(self) -> "Unit":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the port."""
        self.port.close()

    def request(self, number: int, rest: bytes = b"") -> bytes:
        """Send a message; return what follows the number in the answer. Raises NoAnswer."""
        for _ in range(1 + self.retries):
            self.port.reset_input_buffer()
            self.port.write(frame(self.node, bytes([number]) + rest))
            answer = self._answer(number, rest)
            if answer is not None:
                return answer
        raise NoAnswer(f"unit {self.node} does not answer message {number}")

    def _answer(self, number: int, rest: bytes) -> Optional[bytes]:
        """The answer to this request; frames that are something else are skipped. None: it has not come in time."""
        end = time.monotonic() + self.timeout
        wanted = bytes([HOST, self.node, number]) + (rest[:1] if number != VERSION else b"")
        while time.monotonic() < end:
            body = unframe(self.port.read_until(bytes([FLAG])).rstrip(bytes([FLAG])))
            if body is not None and body.startswith(wanted):
                return body[3:]
        return None

    def version(self) -> str:
        """The text of the unit's version."""
        return self.request(VERSION)[1:].decode("ascii")

    def set_command(self, motor: int, text: str) -> None:
        """Give a motor commands. Raises UnitError if the unit refuses the text."""
        motor_digit = str(motor).encode()
        answer = self.request(SET_COMMAND, motor_digit + text.encode("ascii"))
        flag, character = answer[1], answer[2]
        if flag:
            raise UnitError(f"motor {motor}: {text!r} is refused with flag {flag} at {chr(character)!r}")

    def store(self, motor: int) -> None:
        """Store a motor's program in flash."""
        if self.request(STORE_FLASH, str(motor).encode())[1]:
            raise UnitError(f"motor {motor}: the program could not be stored")

    def position(self, motor: int) -> int:
        """A motor's position counter."""
        return int(self.request(GET_POSITION, str(motor).encode())[2:])

    def program(self, motor: int) -> str:
        """A motor's program in memory."""
        return self.request(GET_COMMAND, str(motor).encode())[1:].decode("ascii")

    def busy(self, motor: int) -> bool:
        """Is the motor executing a command?"""
        numbers: List[str] = self.request(GET_PROGRESS, str(motor).encode())[1:].decode("ascii").split(";")
        return int(numbers[1]) != 0


class Axis:
    """An axis that a motor drives. home_input: the input of its home switch, 1 to 8."""

    def __init__(self, unit: Unit, motor: int, home_input: int = 1, speed: int = 1000) -> None:
        self.unit, self.motor, self.home_input, self.speed = unit, motor, home_input, speed

    def wait(self, limit: float = 300.0, every: float = 0.2) -> None:
        """Wait until the motor stands. limit: seconds. Raises TakesTooLong."""
        end = time.monotonic() + limit
        while self.unit.busy(self.motor):
            if time.monotonic() > end:
                raise TakesTooLong(f"motor {self.motor} has not finished after {limit:g} s")
            time.sleep(every)

    def home(self) -> None:
        """Move back to the home switch; the position there is 0."""
        self.unit.set_command(self.motor, f"\\ S200 V{self.speed} A2000 ({self.home_input:02d} C100")
        self.wait()

    def move_to(self, position: int) -> None:
        """Move to a position, 1 or more."""
        self.unit.set_command(self.motor, f"V{self.speed} G{position}")
        self.wait()

    def move_by(self, steps: int) -> None:
        """Move by a number of steps, forward or back."""
        self.unit.set_command(self.motor, f"V{self.speed} {'F' if steps > 0 else 'B'}{abs(steps)} R")
        self.wait()
