# SPDX-License-Identifier: MIT
"""The programs rkm04 and rkmctl that come with the package."""

from __future__ import annotations

import os
import sys
from typing import NoReturn


def find_program(name: str) -> str:
    """The path of "rkm04" or "rkmctl": $RKM04 or $RKMCTL if set, that of the package, or the one in $PATH."""
    given = os.environ.get(name.upper())
    if given:
        return given
    own = os.path.join(os.path.dirname(__file__), "bin", name)
    if os.access(own, os.X_OK):
        return own
    for folder in os.get_exec_path():
        path = os.path.join(folder, name)
        if os.access(path, os.X_OK) and not _is_this(path):
            return path
    raise FileNotFoundError(f"expected the program {name} in {own} or in $PATH, found none")


def _is_this(path: str) -> bool:
    """Is it the script that runs now, which would only start itself again?"""
    return os.path.exists(sys.argv[0]) and os.path.samefile(path, sys.argv[0])


def rkm04() -> NoReturn:
    """Run rkm04 in the place of this process."""
    path = find_program("rkm04")
    os.execv(path, ["rkm04", *sys.argv[1:]])


def rkmctl() -> NoReturn:
    """Run rkmctl in the place of this process."""
    path = find_program("rkmctl")
    os.execv(path, ["rkmctl", *sys.argv[1:]])
