# SPDX-License-Identifier: MIT
"""The programs rkm04 and rkmctl that come with the package."""

from __future__ import annotations

import os
import sys
from typing import NoReturn

from . import _system


def find_program(name: str) -> str:
    """The path of "rkm04" or "rkmctl": $RKM04 or $RKMCTL if set, that of the package, or the one in $PATH."""
    given = os.environ.get(name.upper())
    if given:
        return given
    file = name + _system.PROGRAM_SUFFIX
    own = os.path.join(os.path.dirname(__file__), "bin", file)
    if os.access(own, os.X_OK):
        return own
    for folder in os.get_exec_path():
        path = os.path.join(folder, file)
        if os.access(path, os.X_OK) and not _is_this(path):
            return path
    raise FileNotFoundError(f"expected the program {name} in {own} or in $PATH, found none")


def _is_this(path: str) -> bool:
    """Is it the script that runs now, which would only start itself again? Its name may come without suffix."""
    return any(os.path.exists(own) and os.path.samefile(path, own) for own in (sys.argv[0], sys.argv[0] + _system.PROGRAM_SUFFIX))


def rkm04() -> NoReturn:
    """Run rkm04 in the place of this process."""
    _system.run_in_place(find_program("rkm04"), ["rkm04", *sys.argv[1:]])


def rkmctl() -> NoReturn:
    """Run rkmctl in the place of this process."""
    _system.run_in_place(find_program("rkmctl"), ["rkmctl", *sys.argv[1:]])
