# SPDX-License-Identifier: MIT
"""What the package uses of Linux and its like; _windows.py has the same for Windows."""

from __future__ import annotations

import os
from typing import List, NoReturn

PROGRAM_SUFFIX = ""


def run_in_place(path: str, arguments: List[str]) -> NoReturn:
    """Run a program in the place of this process."""
    os.execv(path, arguments)
