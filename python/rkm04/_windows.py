# SPDX-License-Identifier: MIT
"""What the package uses of Windows; _posix.py has the same for other systems."""

from __future__ import annotations

import subprocess
import sys
from typing import List, NoReturn

PROGRAM_SUFFIX = ".exe"


def run_in_place(path: str, arguments: List[str]) -> NoReturn:
    """Run a program, and end with its exit status: here a process has no other in its place, and who has started this one would
    not wait for it. Ctrl-C is the program's: its end is awaited."""
    process = subprocess.Popen([path, *arguments[1:]])
    while True:
        try:
            sys.exit(process.wait())
        except KeyboardInterrupt:
            pass
