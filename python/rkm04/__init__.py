# SPDX-License-Identifier: MIT
"""RKM04 units for tests of host software: a bus in this process, in virtual time.

    import rkm04

    with rkm04.Bus() as bus:
        bus.unit(1).motor(1).set("F100 R")
        bus.wait(motor=1, state="idle")
        assert bus.unit(1).motor(1).position == 100
"""

import typing

import serial

from ._bus import Bus, Host
from ._clock import NothingToCome
from ._dialogue import Dialogue, Exchange
from ._errors import BusyError, ClosedError, Error, NoAnswerError, ProgramError, RefusedError, WaitError
from ._message import Message, request
from ._parts import Events, Fault, Motor, Unit
from ._ports import publish, unpublish
from ._sim import version as __version__
from ._virtual_time import virtual_time

if typing.TYPE_CHECKING:
    from ._explore import Exploration, ExplorationFailed, explore

__all__ = ["Bus", "BusyError", "ClosedError", "Dialogue", "Error", "Events", "Exchange", "Exploration", "ExplorationFailed",
           "Fault", "Host", "Message", "Motor", "NoAnswerError", "NothingToCome", "ProgramError", "RefusedError", "Unit",
           "WaitError", "__version__", "explore", "publish", "request", "unpublish", "virtual_time"]

# serial.serial_for_url("rkm04://...") finds protocol_rkm04.py here.
if "rkm04" not in serial.protocol_handler_packages:
    serial.protocol_handler_packages.append("rkm04")


def __getattr__(name: str) -> typing.Any:
    """What few programs need is loaded when they do."""
    if name in ("Exploration", "ExplorationFailed", "explore"):
        from . import _explore

        return getattr(_explore, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
