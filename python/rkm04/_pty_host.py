# SPDX-License-Identifier: MIT
"""The host's port of a running emulator at a pty, or at a serial device that leads to it."""

from __future__ import annotations

import os
import select
import sys
import termios
from typing import TYPE_CHECKING

from ._remote_host import PATIENCE, RemoteHost

if TYPE_CHECKING:
    from ._remote import ControlSocket

assert sys.platform != "win32"


class PtyHost(RemoteHost):
    """A host that has opened the pty of a running emulator."""

    def __init__(self, control: "ControlSocket", link: str) -> None:
        super().__init__(control)
        self._fd = os.open(link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self.configure()

    def configure(self, baudrate: int = 19200, bytesize: int = 8, parity: str = "N", stopbits: float = 1) -> None:
        speed = getattr(termios, f"B{baudrate}", None)
        sizes = {5: termios.CS5, 6: termios.CS6, 7: termios.CS7, 8: termios.CS8}
        if speed is None or bytesize not in sizes or parity not in ("N", "E", "O") or stopbits not in (1, 2):
            raise ValueError("expected a speed that terminals have, 5 to 8 data bits, parity N, E or O, and 1 or 2 stop bits")
        flags = termios.CREAD | termios.CLOCAL | sizes[bytesize] | (termios.CSTOPB if stopbits == 2 else 0)
        if parity != "N":
            flags |= termios.PARENB | (termios.PARODD if parity == "O" else 0)
        attributes = termios.tcgetattr(self._fd)
        attributes[:6] = [0, 0, flags, 0, speed, speed]
        termios.tcsetattr(self._fd, termios.TCSANOW, attributes)
        self._settings = (baudrate, bytesize, parity, stopbits)

    def _put(self, data: bytes) -> None:
        at = 0
        while at < len(data):
            select.select([], [self._fd], [], PATIENCE)
            at += os.write(self._fd, data[at:])

    def _fetch(self, seconds: float) -> None:
        if select.select([self._fd], [], [], seconds)[0]:
            try:
                self._heard += os.read(self._fd, 65536)
            except BlockingIOError:
                pass

    def reset_output_buffer(self) -> int:
        termios.tcflush(self._fd, termios.TCOFLUSH)
        return 0

    def close(self) -> None:
        os.close(self._fd)
