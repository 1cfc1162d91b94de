# SPDX-License-Identifier: MIT
"""RKM04 units for tests of host software: a bus in this process, in virtual time.

    import rkm04

    with rkm04.Bus() as bus:
        bus.unit(1).motor(1).set("F100 R")
        bus.wait(motor=1, state="idle")
        assert bus.unit(1).motor(1).position == 100
"""

from typing import TYPE_CHECKING, Any

import serial

from ._bus import Bus, Host
from ._clock import NothingToCome, TimeLimitError
from ._dialogue import Dialogue, Exchange
from ._errors import BusyError, ClosedError, Error, NoAnswerError, ProgramError, RefusedError, WaitError
from ._message import Message, request
from ._parts import Events, Fault, Motor, Unit
from ._ports import publish, unpublish
from ._sim import version as __version__
from ._virtual_time import virtual_time

if TYPE_CHECKING:
    from ._explore import Exploration, ExplorationFailed, explore
    from ._remote import RemoteBus, connect, serve

__all__ = ["Bus", "BusyError", "ClosedError", "Dialogue", "Error", "Events", "Exchange", "Exploration", "ExplorationFailed",
           "Fault", "Host", "Message", "Motor", "NoAnswerError", "NothingToCome", "ProgramError", "RefusedError", "RemoteBus",
           "TimeLimitError", "Unit", "WaitError", "__version__", "connect", "explore", "publish", "request", "serve", "unpublish",
           "virtual_time"]

_LATER = {"Exploration": "_explore", "ExplorationFailed": "_explore", "explore": "_explore", "RemoteBus": "_remote",
          "connect": "_remote", "serve": "_remote"}
"""What few programs need is loaded when they do."""

# serial.serial_for_url("rkm04://...") finds protocol_rkm04.py here.
if "rkm04" not in serial.protocol_handler_packages:
    serial.protocol_handler_packages.append("rkm04")


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f".{_LATER[name]}", __name__), name)
    globals()[name] = value
    return value
