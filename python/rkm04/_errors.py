# SPDX-License-Identifier: MIT
"""What goes wrong, as exceptions that say what was expected and what was seen."""

from ._sim import BusyError, ClosedError, Error, RefusedError

__all__ = ["BusyError", "ClosedError", "Error", "NoAnswerError", "ProgramError", "RefusedError", "WaitError"]


class WaitError(Error):
    """A condition did not come to hold within its limit of virtual time."""


class NoAnswerError(Error):
    """No whole answer came to the host within the limit of virtual time."""


class ProgramError(Error):
    """A unit has refused a program text: flag 1 (wrong value) or 2 (unknown command)."""
