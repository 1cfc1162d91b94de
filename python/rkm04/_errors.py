# SPDX-License-Identifier: MIT
"""What goes wrong, as exceptions that say what was expected and what was seen."""

from __future__ import annotations

from functools import wraps
from typing import Any, Callable

from ._sim import BusyError, ClosedError, Error, RefusedError

__all__ = ["BusyError", "ClosedError", "Error", "NoAnswerError", "ProgramError", "RefusedError", "WaitError", "always_shown"]


def always_shown(describe: Callable[[Any], str]) -> Callable[[Any], str]:
    """A __repr__ that says why it has nothing to say instead of raising: debuggers and failure reports call it at any time."""

    @wraps(describe)
    def show(self: Any) -> str:
        try:
            return describe(self)
        except Error as error:
            return f"<{type(self).__name__}: {error}>"

    return show


class WaitError(Error):
    """A condition did not come to hold within its limit of virtual time."""

    __module__ = "rkm04"


class NoAnswerError(Error):
    """No whole answer came to the host within the limit of virtual time."""

    __module__ = "rkm04"


class ProgramError(Error):
    """A unit has refused a program text: flag 1 (wrong value) or 2 (unknown command)."""

    __module__ = "rkm04"
