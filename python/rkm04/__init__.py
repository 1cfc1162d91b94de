# SPDX-License-Identifier: MIT
"""RKM04 units for tests of host software: a bus in this process, in virtual time.

    import rkm04

    with rkm04.Bus() as bus:
        bus.unit(1).motor(1).set("F100 R")
        bus.wait(motor=1, state="idle")
        assert bus.unit(1).motor(1).position == 100
"""

from ._bus import Bus, Host
from ._dialogue import Dialogue, Exchange
from ._errors import BusyError, ClosedError, Error, NoAnswerError, ProgramError, RefusedError, WaitError
from ._message import Message, request
from ._parts import Events, Fault, Motor, Unit
from ._sim import version as __version__

__all__ = ["Bus", "BusyError", "ClosedError", "Dialogue", "Error", "Events", "Exchange", "Fault", "Host", "Message", "Motor",
           "NoAnswerError", "ProgramError", "RefusedError", "Unit", "WaitError", "__version__", "request"]
