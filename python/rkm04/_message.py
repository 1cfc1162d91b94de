# SPDX-License-Identifier: MIT
"""Messages between host and units (manual, chapter 5), without framing."""

from __future__ import annotations

from typing import Optional, Union

from . import _sim

RKM04 = "rkm04"
"""The device whose messages these are, unless another is named."""

NAMES = {
    1: "Version",
    2: "Set Command",
    3: "Store Flash",
    4: "Get Position",
    5: "Get Command",
    6: "Get Tabul Run",
    7: "Get Pozic Run",
}

Kind = Union[str, int]
"""A message by its name ("Set Command", in any case) or its number (2)."""


def number_of(kind: Kind) -> int:
    """The number of a message. Raises ValueError for a name that there is not."""
    if isinstance(kind, int):
        return kind
    for number, name in NAMES.items():
        if name.lower() == kind.strip().lower():
            return number
    raise ValueError(f"unknown message {kind!r}: expected one of {', '.join(NAMES.values())}, or a number")


class Message:
    """A request or an answer.

    data: its bytes, of an RKM04 the number first. is_answer: it comes from a unit. device: what kind of unit.
    """

    __slots__ = ("data", "is_answer", "device")

    def __init__(self, data: bytes, is_answer: bool = False, device: str = RKM04) -> None:
        self.data = data
        self.is_answer = is_answer
        self.device = device

    @property
    def _numbered(self) -> bytes:
        """The data if they begin with a number: those of an RKM04 do."""
        return self.data if self.device == RKM04 else b""

    @property
    def number(self) -> Optional[int]:
        """Its number, 0 to 255: an answer has that of its request; 255: the unit does not know the request. None: it has none, as
        those of other devices than the RKM04."""
        return self._numbered[0] if self._numbered else None

    @property
    def name(self) -> str:
        """ "Set Command", …; "" if the number is none of the manual's."""
        return NAMES.get(self.number, "") if self.number is not None else ""

    @property
    def motor(self) -> Optional[int]:
        """The motor that it is about, 1 to 4; 0: all. None: about none."""
        data = self._numbered
        if len(data) < 2 or not 2 <= data[0] <= 7 or not 0x30 <= data[1] <= 0x39:
            return None
        return data[1] - 0x30

    @property
    def text(self) -> str:
        """What follows number and motor, as characters: the program of a Set Command, the program in the answer to a Get
        Command, the version. Of other devices than the RKM04 all of it."""
        return self.data[2 if self.device == RKM04 else 0:].decode("latin-1")

    @property
    def flag(self) -> Optional[int]:
        """Of the answer to a Set Command, 0: accepted, 1: wrong value, 2: unknown command, 3: memory overflowed; of that to a
        Store Flash, 0: written."""
        if self.is_answer and len(self._numbered) >= 3 and self.data[0] in (2, 3):
            return self.data[2]
        return None

    @property
    def words(self) -> str:
        """In words, as in the log of --wire: `2 Set Command m1 "F5000 R"`."""
        return _sim.words(self.data, self.is_answer, self.device)

    def __bytes__(self) -> bytes:
        return self.data

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Message):
            return self.data == other.data and self.is_answer == other.is_answer
        return self.data == other if isinstance(other, bytes) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.data)

    def __repr__(self) -> str:
        return f"<{'answer' if self.is_answer else 'request'} {self.words}>"


def request(kind: Kind, motor: Optional[int] = None, text: str = "") -> bytes:
    """The bytes of a request: `request("Set Command", motor=1, text="F100 R")`.

    motor: 0 (all) to 4, of every kind but Version. text: of a Set Command, at most 9214 characters.
    """
    head = bytes([number_of(kind)])
    if motor is not None:
        if not 0 <= motor <= 9:
            raise ValueError(f"expected a motor from 0 (all) to 4, found {motor}")
        head += b"%d" % motor
    return head + text.encode("latin-1")
