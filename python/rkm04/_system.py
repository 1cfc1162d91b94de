# SPDX-License-Identifier: MIT
"""What differs between systems: _posix.py, and _windows.py of the same face."""

import sys

if sys.platform == "win32":
    from ._windows import HAS_PTYS, PROGRAM_SUFFIX, SELECTORS, command_with, connect_socket, end_process, link_in, open_link, \
        quote, run_in_place, serve_arguments
else:
    from ._posix import HAS_PTYS, PROGRAM_SUFFIX, SELECTORS, command_with, connect_socket, end_process, link_in, open_link, \
        quote, run_in_place, serve_arguments

__all__ = ["HAS_PTYS", "PROGRAM_SUFFIX", "SELECTORS", "command_with", "connect_socket", "end_process", "link_in", "open_link",
           "quote", "run_in_place", "serve_arguments"]
