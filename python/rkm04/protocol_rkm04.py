# SPDX-License-Identifier: MIT
"""`rkm04://`: a port of pyserial onto a bus in this process, in virtual time.

    serial.serial_for_url("rkm04://?node=1&plant=axis.yaml")   # makes a bus; the same URL opens the same bus again
    serial.serial_for_url("rkm04://NAME")                      # a bus that the test has published

`write()` takes the time that the bytes take, `read()` lets time pass until the bytes have come or the timeout is over; both
return at once in real time.
"""
from __future__ import annotations

import socket
import weakref
from typing import Any, Optional

from serial.serialutil import PARITY_NONE, PortNotOpenError, SerialBase, SerialException, SerialTimeoutException

from . import _ports
from ._clock import Clock
from ._errors import ClosedError
from ._virtual_time import ticks


_MANY = 1 << 20  # bytes: more than come


def _never() -> bool:
    return False


class Serial(SerialBase):
    """A port onto an in-process bus. Settings, methods and errors are those of pyserial.

    As at an RS485 adapter, there are no modem lines: CTS follows RTS and DSR follows DTR. RS485 settings are accepted; their
    delays take virtual time.
    """

    _port: Optional[str]
    _baudrate: int
    _bytesize: int
    _parity: str
    _stopbits: float
    _timeout: Optional[float]
    _write_timeout: Optional[float]
    _inter_byte_timeout: Optional[float]
    _rs485_mode: Any
    _break_state: bool
    _rts_state: bool
    _dtr_state: bool

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self._line: Any = None
        self._clock: Clock = Clock()
        self._sent_at = 0  # when the last byte written is out
        self._cancelled_read = self._cancelled_write = False
        self._readable = False
        self._pair: Optional[tuple[socket.socket, socket.socket]] = None
        super().__init__(*args, **kwargs)

    # ---- Open and close ----

    @property
    def bus(self) -> Any:
        """The bus that the port is open onto, or was opened onto last; None: it has never been open."""
        return self._line

    def open(self) -> None:
        """Open the port with the present settings. Raises SerialException."""
        if self._port is None:
            raise SerialException("Port must be configured before it can be used.")
        if self.is_open:
            raise SerialException("Port is already open.")
        try:
            self._line = _ports.bus_for_url(self._port)
            self._clock = _ports.clock_of(self._line)
        except (ValueError, OSError, RuntimeError) as error:
            raise SerialException(f"could not open port {self._port}: {error}") from error
        other = self._clock.port() if self._clock.port is not None else None
        if other is not None:
            raise SerialException(f"could not open port {self._port}: it is open already, by {other!r}")
        self._clock.port = weakref.ref(self)
        self.is_open = True
        try:
            self._reconfigure_port()
        except Exception:
            self.close()
            raise
        self._sent_at = self._clock.now
        self.reset_input_buffer()

    def close(self) -> None:
        """Close the port, when all bytes are out. The bus stays as it is, and the port can be opened again."""
        if self.is_open:
            clock = self._clock
            try:
                if self._break_state:
                    self.break_condition = False
                self.flush()
                clock.receive()
            except ClosedError:
                pass  # the bus has gone, and all bytes with it
            self.is_open = False
            self._cancelled_read = self._cancelled_write = True
            clock.input.clear()
            clock.port = clock.on_input = None
            if self._pair is not None:
                for end in self._pair:
                    end.close()
                self._pair = None

    def _reconfigure_port(self) -> None:
        if self._baudrate is None or not 0 < self._baudrate < 2**32:
            raise ValueError(f"invalid baudrate: {self._baudrate!r}")
        with self._clock.gate:
            self._line.host.configure(self._baudrate, self._bytesize, self._parity, self._stopbits)

    def _need_open(self) -> None:
        if not self.is_open:
            raise PortNotOpenError()

    # ---- Read ----

    @property
    def in_waiting(self) -> int:
        """The number of bytes that have come and are not read yet."""
        self._need_open()
        clock = self._clock
        clock.look()
        with clock.gate:
            return clock.receive()

    def read(self, size: int = 1) -> bytes:
        """Read up to `size` bytes; fewer when the timeout is over. With timeout=None and nothing that could come, raises
        NothingToCome."""
        self._need_open()
        clock = self._clock
        with clock.gate:
            have = clock.receive()
        if have < size:
            self._wait_for(size)
        return self._take(size)

    def _take(self, size: int) -> bytes:
        have = self._clock.input
        data = bytes(have[:size])
        del have[:size]
        if data:
            self._clock.begin_looking()
        if self._pair is not None and not have:
            self._show_readable(False)
        return data

    def _wait_for(self, size: int) -> None:
        clock, have = self._clock, self._clock.input
        if self._timeout == 0:
            clock.look()
            return
        self._cancelled_read = False
        deadline = None if self._timeout is None else clock.now + ticks(self._timeout)
        gap = self._inter_byte_timeout
        while len(have) < size and not self._cancelled_read:
            limit, goal = deadline, size
            if gap:
                goal = len(have) + 1
                if have:
                    end = clock.last_byte + ticks(gap)
                    limit = end if deadline is None else min(deadline, end)
            if not clock.wait(limit, lambda: len(have) >= goal or self._cancelled_read, "read() with timeout=None",
                              goal - len(have)):
                return

    def read_until(self, expected: bytes = b"\n", size: Optional[int] = None) -> bytes:
        """Read until `expected` has come, `size` bytes have, or the timeout is over, which counts from the call on."""
        self._need_open()
        clock, have = self._clock, self._clock.input
        with clock.gate:
            clock.receive()
        deadline = None if self._timeout is None else clock.now + (ticks(self._timeout) if self._timeout else 0)
        self._cancelled_read = False
        while not self._cancelled_read:
            place = have.find(expected)
            if place >= 0:
                end = place + len(expected)
                return self._take(end if size is None else min(end, size))
            if size is not None and len(have) >= size:
                return self._take(size)
            count = len(have)
            if not clock.wait(deadline, lambda: len(have) > count or self._cancelled_read, "read_until() with timeout=None",
                              _MANY if size is None else size - count, expected[-1] if expected else -1):
                break
        return self._take(len(have))

    def cancel_read(self) -> None:
        """Let a read() in another thread return at once."""
        self._cancelled_read = True

    def reset_input_buffer(self) -> None:
        """Discard what has come and is not read yet."""
        self._need_open()
        with self._clock.gate:
            self._clock.receive()
            self._take(len(self._clock.input))

    # ---- Write ----

    def _character_us(self) -> float:
        """The time of a character in µs, as the port is set."""
        return float(1e6 * (1 + self._bytesize + (self._parity != PARITY_NONE) + self._stopbits) / self._baudrate)

    def write(self, data: Any) -> int:
        """Send `data`; returns when the last byte is out, in virtual time. With write_timeout=0 it returns at once, and the
        bytes go out by and by. Raises SerialTimeoutException when write_timeout is over; what has gone out by then has."""
        self._need_open()
        data = bytes(data)
        mode = self._rs485_mode
        if mode is not None and mode.delay_before_tx:
            self._pass(mode.delay_before_tx)
        clock = self._clock
        self._cancelled_write = False
        limit = None if self._write_timeout is None else clock.now + round(self._write_timeout * 1e6)
        with clock.gate:
            host = self._line.host
            host.write(data, wait=False)
            self._sent_at = clock.at(host.out_until)
        if self._write_timeout == 0:
            return len(data)
        clock.wait(self._sent_at if limit is None else min(self._sent_at, limit), self._is_cancelled, "write()")
        if clock.now < self._sent_at:
            left = self._drop_output()
            if not self._cancelled_write:
                raise SerialTimeoutException("Write timeout")
            return len(data) - left
        if mode is not None and mode.delay_before_rx:
            self._pass(mode.delay_before_rx)
        return len(data)

    def _drop_output(self) -> int:
        """Drop the bytes that have not set out. Returns their number."""
        clock = self._clock
        with clock.gate:
            self._sent_at = min(self._sent_at, clock.now + round(self._character_us()))
            return int(self._line.host.reset_output_buffer())

    def _is_cancelled(self) -> bool:
        return self._cancelled_write

    def _pass(self, seconds: float) -> None:
        self._clock.wait(self._clock.now + ticks(seconds), _never)

    @property
    def out_waiting(self) -> int:
        """The number of bytes that are not out yet."""
        self._need_open()
        rest = self._sent_at - self._clock.now - 1  # its end is rounded up
        return 0 if rest <= 0 else -int(-rest // self._character_us())

    def flush(self) -> None:
        """Wait until all bytes are out."""
        self._need_open()
        if self._sent_at > self._clock.now:
            self._clock.wait(self._sent_at, self._is_cancelled, "flush()")

    def cancel_write(self) -> None:
        """Let a write() in another thread return at once."""
        self._cancelled_write = True

    def reset_output_buffer(self) -> None:
        """Drop what has been written and has not set out yet."""
        self._need_open()
        self._drop_output()

    # ---- Lines ----

    def send_break(self, duration: float = 0.25) -> None:
        """Hold the bus at 0 for `duration` seconds of virtual time."""
        self._need_open()
        self.break_condition = True
        try:
            self._pass(duration)
        finally:
            self.break_condition = False

    def _update_break_state(self) -> None:
        with self._clock.gate:
            self._line.host.set_break(bool(self._break_state))

    def _update_rts_state(self) -> None:
        pass

    def _update_dtr_state(self) -> None:
        pass

    @property
    def cts(self) -> bool:
        """Follows RTS."""
        self._need_open()
        return bool(self._rts_state)

    @property
    def dsr(self) -> bool:
        """Follows DTR."""
        self._need_open()
        return bool(self._dtr_state)

    @property
    def ri(self) -> bool:
        """Always off."""
        self._need_open()
        return False

    @property
    def cd(self) -> bool:
        """Always on."""
        self._need_open()
        return True

    # ---- For event loops ----

    def fileno(self) -> int:
        """A descriptor that can be read while bytes are waiting, for select and event loops. Time passes in these only under
        `virtual_time()`."""
        self._need_open()
        if self._pair is None:
            self._pair = socket.socketpair()
            for end in self._pair:
                end.setblocking(False)
            self._readable = False
            self._clock.on_input = weakref.WeakMethod(self._follow_input)
            self._follow_input()
        return self._pair[0].fileno()

    def _follow_input(self) -> None:
        if self._clock.input:
            self._show_readable(True)

    def _show_readable(self, readable: bool) -> None:
        if self._pair is not None and readable != self._readable:
            self._readable = readable
            if readable:
                self._pair[1].send(b"\0")
            else:
                self._pair[0].recv(1)
