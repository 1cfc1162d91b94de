# SPDX-License-Identifier: MIT
"""In place of the extension, where that was not built: a running emulator is reached, nothing is simulated here."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from typing import Any, Tuple

try:
    version = version_of("rkm04")
except PackageNotFoundError:
    version = "unknown"

_WHERE = "which this installation does not have: expected a running emulator, with rkm04.connect()"
_DIGITS = {"us": 0, "ms": 3, "s": 6}
"""Digits after the point that a us is of the unit."""
_TIME_MAX = 10 ** 15


class Error(RuntimeError):
    """What went wrong; the text says what was expected and what was found."""

    __module__ = "rkm04"


class RefusedError(Error):
    """A method was refused; code: as in docs/CONTROL.md."""

    __module__ = "rkm04"
    code: int = 0


class BusyError(Error):
    """Another thread uses the bus."""

    __module__ = "rkm04"


class ClosedError(Error):
    """The bus is closed."""

    __module__ = "rkm04"


def time(text: str) -> int:
    """us of a time with a unit. Raises ValueError."""
    found = re.fullmatch(r"(\d{1,15})(?:\.(\d{1,15}))?(us|ms|s)", text)
    whole, part, unit = found.groups("") if found else ("", "", "us")
    us = int(whole + part.ljust(_DIGITS[unit], "0")) if whole and len(part) <= _DIGITS[unit] else _TIME_MAX + 1
    if us > _TIME_MAX:
        raise ValueError(f"expected a time with its unit, such as 250us, 1500ms or 2.5s, in whole us, found {text!r}")
    return us


def words(message: bytes, answer: bool, device: str = "rkm04") -> str:
    """Messages in words need the extension: their bytes."""
    return message.hex(" ")


def frame(framing: str, node: int, message: bytes) -> bytes:
    """Raises Error."""
    raise Error(f"frames need the extension, {_WHERE}")


def unframe(framing: str, data: bytes) -> Tuple[int, int, int, bytes]:
    """Raises Error."""
    raise Error(f"frames need the extension, {_WHERE}")


class Sim:
    """Raises Error."""

    def __init__(self, *_: Any) -> None:
        raise Error(f"a bus in this process needs the extension, {_WHERE}")
