# SPDX-License-Identifier: MIT
"""What differs between systems: _posix.py, and _windows.py of the same face."""

import sys

if sys.platform == "win32":
    from ._windows import PROGRAM_SUFFIX as PROGRAM_SUFFIX
    from ._windows import run_in_place as run_in_place
else:
    from ._posix import PROGRAM_SUFFIX as PROGRAM_SUFFIX
    from ._posix import run_in_place as run_in_place
