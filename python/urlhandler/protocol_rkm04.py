# SPDX-License-Identifier: MIT
"""Beside pyserial's own handlers, so that a program which does not import rkm04 can open `rkm04://...`."""
from rkm04.protocol_rkm04 import Serial  # noqa: F401
