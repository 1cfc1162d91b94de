# SPDX-License-Identifier: MIT
"""Times as people give them: whole us, "250ms", or a datetime.timedelta."""

from __future__ import annotations

from typing import TYPE_CHECKING, Union

from . import _sim

if TYPE_CHECKING:
    from datetime import timedelta

Time = Union[int, str, "timedelta"]
"""A whole number of us, a text with a unit ("250us", "1500ms", "2.5s"), or a timedelta; never negative."""

EXPECTED = 'expected a whole number of us, a text as in "250ms", or a timedelta'

LONGEST = 10 ** 15  # us


def to_us(time: Time) -> int:
    """The time in us. Raises ValueError for a time out of its range or a text that is none, TypeError for anything else."""
    if isinstance(time, str):
        return _sim.time(time)
    if isinstance(time, bool):
        raise TypeError(f"{EXPECTED}, found {time!r}")
    if isinstance(time, int):
        us = time
    elif hasattr(time, "microseconds"):
        us = (time.days * 86400 + time.seconds) * 1_000_000 + time.microseconds
    else:
        raise TypeError(f"{EXPECTED}, found {time!r}")
    if not 0 <= us <= LONGEST:
        raise ValueError(f"expected a time from 0 to 10^15 us (10^9 s), found {us} us")
    return us
