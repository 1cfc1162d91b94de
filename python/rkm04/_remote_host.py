# SPDX-License-Identifier: MIT
"""The host's port at the end of the bus of a running emulator: over TCP here, at a pty in _posix.py."""

from __future__ import annotations

import select
import socket
import time as real_time
from typing import TYPE_CHECKING, List, Optional, Tuple

from ._bus import BREAK_SHORTEST, Host
from ._errors import Error
from ._time import Time, to_us

if TYPE_CHECKING:
    from ._remote import ControlSocket

PATIENCE = 30.0
"""s of real time for what rkm04 does at once."""

TCP = "socket://"
"""A link that is no path: HOST:PORT of raw TCP follows, as pyserial writes it."""


class RemoteHost(Host):
    """What hosts of running emulators have in common. They differ in how bytes come and go."""

    what = "a pty"
    """What carries the bytes, for messages."""

    def __init__(self, control: "ControlSocket") -> None:
        self._control = control
        self._heard = b""
        self._until = 0
        self._settings: Tuple[int, int, str, float] = (19200, 8, "N", 1)

    def _put(self, data: bytes) -> None:
        """Hand over all bytes."""
        raise NotImplementedError

    def _fetch(self, seconds: float) -> None:
        """Add what comes to `_heard`, or wait so long for something to come."""
        raise NotImplementedError

    def write(self, data: bytes, baudrate: Optional[int] = None, bytesize: Optional[int] = None, parity: Optional[str] = None,
              stopbits: Optional[float] = None, wait: bool = True) -> int:
        given = (baudrate, bytesize, parity, stopbits)
        if any(value is not None for value in given):
            new = [old if value is None else value for value, old in zip(given, self._settings)]
            self.configure(*new)  # type: ignore[arg-type]
        unit = self._control.call("units", {})["units"][0]
        before = self._bytes(unit)
        self._put(data)
        if wait and self._settings == (19200, 8, "N", 1):
            self._wait_passed(unit, before + len(data))
        self._until = self._control.now()
        return len(data)

    def _bytes(self, unit: str) -> int:
        return int(self._control.call("state", {"unit": unit})["line"]["bytes"])

    def _wait_passed(self, unit: str, wanted: int) -> None:
        """Bytes and requests take different ways: wait until the bus has carried them."""
        end = real_time.monotonic() + PATIENCE
        while self._bytes(unit) < wanted:
            if real_time.monotonic() > end:
                raise Error(f"expected the bus to carry what was written within {PATIENCE:.0f} s of real time; it did not")
            self._fetch(0.0005)

    def read(self, size: int = -1) -> bytes:
        self._fetch(0)
        end = len(self._heard) if size < 0 else size
        data, self._heard = self._heard[:end], self._heard[end:]
        return data

    def read_ticks(self, size: int = -1) -> List[Tuple[int, int]]:
        raise Error(f"{self.what} does not say when bytes have come: use bus.events(\"byte\")")

    @property
    def in_waiting(self) -> int:
        self._fetch(0)
        return len(self._heard)

    @property
    def out_until(self) -> int:
        return self._until

    @property
    def lost(self) -> int:
        return 0

    @property
    def idle(self) -> bool:
        raise Error("the control socket does not say whether the bus is at rest: use a bus in this process")

    def wait_byte(self, limit: Time) -> bool:
        end = self._control.now() + to_us(limit)
        self._fetch(0.001)
        while not self._heard:
            now = self._control.now()
            if now >= end:
                self._fetch(0.02)  # what had passed by then may still be on its way to here
                break
            if self._control.is_stepped:
                self._control.advance(min(1000, end - now))
                self._fetch(0.001)
            else:
                self._fetch(0.005)
        return bool(self._heard)

    def set_break(self, on: bool) -> None:
        raise Error(f"{self.what} cannot hold the wires at 0: use bus.faults.inject(\"break\")")

    def send_break(self, time: Time = BREAK_SHORTEST) -> None:
        raise Error(f"{self.what} cannot hold the wires at 0: use bus.faults.inject(\"break\", for_=time)")

    def rest(self) -> None:
        """An exchange is over: let a program have the bus, where one at a time has it."""

    def close(self) -> None:
        """Leave the bus."""
        raise NotImplementedError


class TcpHost(RemoteHost):
    """A host that has connected to the TCP port of the bus. It connects when it is used: one at a time has the bus."""

    what = "a TCP connection"

    def __init__(self, control: "ControlSocket", address: str) -> None:
        super().__init__(control)
        host, _, port = address.rpartition(":")
        if not host or not port.isdecimal():
            raise Error(f"expected a link {TCP}HOST:PORT, found {TCP}{address}")
        self._address = (host.strip("[]"), int(port))
        self._socket: Optional[socket.socket] = None

    def configure(self, baudrate: int = 19200, bytesize: int = 8, parity: str = "N", stopbits: float = 1) -> None:
        if (baudrate, bytesize, parity, stopbits) != self._settings:
            raise Error("a TCP connection has no speed and no parity: use the RFC 2217 port, or a bus in this process")

    def _connected(self) -> socket.socket:
        if self._socket is None:
            try:
                self._socket = socket.create_connection(self._address, PATIENCE)
            except OSError as error:
                raise Error(f"expected the TCP port of the bus at {self._address[0]}:{self._address[1]}, found: "
                            f"{error.strerror or error}") from None
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return self._socket

    def _put(self, data: bytes) -> None:
        try:
            self._connected().sendall(data)
        except OSError:
            self._refuse()

    def _fetch(self, seconds: float) -> None:
        if self._socket is None:
            real_time.sleep(seconds)
        elif select.select([self._socket], [], [], seconds)[0]:
            try:
                came = self._socket.recv(65536)
            except OSError:
                came = b""
            if not came:
                self._refuse()
            self._heard += came

    def _refuse(self) -> None:
        self.close()
        raise Error(f"expected to have the bus at {self._address[0]}:{self._address[1]}, found that another client has it, one "
                    "at a time, or that rkm04 serve has ended")

    def rest(self) -> None:
        self.close()

    def reset_output_buffer(self) -> int:
        return 0

    def close(self) -> None:
        """Leave: the emulator takes the next client at once."""
        gone, self._socket = self._socket, None
        if gone is not None:
            gone.close()
