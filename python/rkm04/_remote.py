# SPDX-License-Identifier: MIT
"""A bus behind the control socket of `rkm04 serve`, and starting one."""

from __future__ import annotations

import json
import os
import select
import shutil
import socket
import stat
import subprocess
import tempfile
import threading
import time as real_time
from types import TracebackType
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Type, Union

from . import _sim
from ._bus import BREAK_SHORTEST, Bus, Host, Transport
from ._errors import Error, RefusedError
from ._programs import find_program
from ._time import Time, to_us

PATIENCE = 30.0
"""s of real time for what rkm04 does at once."""


def _connect(path: str) -> socket.socket:
    """A Unix socket. A path of one has at most 107 bytes: a longer one is reached through its folder."""
    made, folder = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM), -1
    try:
        if len(os.fsencode(path)) > 107:
            folder = os.open(os.path.dirname(path), os.O_PATH)
        made.connect(path if folder < 0 else f"/proc/self/fd/{folder}/{os.path.basename(path)}")
    except OSError:
        made.close()
        raise
    finally:
        if folder >= 0:
            os.close(folder)
    return made


class ControlSocket(Transport):
    """JSON-RPC, one object a line. path: of the socket, or of the control file of a TCP port."""

    def __init__(self, path: str, link: Optional[str]) -> None:
        self._path = path
        self._link = link
        self._next = 0
        self._rest = b""
        self._events: Dict[int, List[Dict[str, Any]]] = {}
        self._lost = 0
        self._host: Optional[PtyHost] = None
        try:
            self._socket = self._enter(path) if stat.S_ISREG(os.stat(path).st_mode) else _connect(path)
        except OSError as error:
            raise Error(f"expected the control socket of a running rkm04 serve at {path}, found: {error.strerror or error}") \
                from None
        self.framing: str = self.call("units", {}).get("framing", "hdlc")

    def _enter(self, path: str) -> socket.socket:
        """The TCP port of a control file, with its token shown."""
        with open(path, encoding="ascii", errors="replace") as file:
            parts = file.read(200).split()
        host, _, port = parts[0][len("tcp:"):].rpartition(":") if len(parts) == 2 else ("", "", "")
        if not parts or not parts[0].startswith("tcp:") or not port.isdecimal():
            raise Error(f"expected the control socket of a running rkm04 serve at {path}, found another file")
        self._socket = socket.create_connection((host.strip("[]"), int(port)))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            self.call("authenticate", {"token": parts[1]})
        except BaseException:
            self._socket.close()
            raise
        return self._socket

    def _line(self) -> Dict[str, Any]:
        while b"\n" not in self._rest:
            part = self._socket.recv(65536)
            if not part:
                raise Error(f"expected an answer from {self._path}, found that rkm04 serve has ended")
            self._rest += part
        line, self._rest = self._rest.split(b"\n", 1)
        answer: Dict[str, Any] = json.loads(line)
        return answer

    def call(self, method: str, params: Dict[str, Any]) -> Dict[str, Any]:
        self._next += 1
        request = {"jsonrpc": "2.0", "id": self._next, "method": method, "params": params}
        try:
            self._socket.sendall(json.dumps(request).encode() + b"\n")
            while True:
                answer = self._line()
                if answer.get("id") == self._next:
                    break
                self._take(answer)
        except OSError as error:
            raise Error(f"expected an answer from {self._path}, found: {error.strerror or error}") from None
        if "error" in answer:
            refused = RefusedError(answer["error"]["message"])
            refused.code = answer["error"]["code"]
            raise refused
        result: Dict[str, Any] = answer["result"]
        return result

    def _take(self, answer: Dict[str, Any]) -> None:
        if answer.get("method") == "event":
            event = answer["params"]
            self._events.setdefault(event.pop("subscription"), []).append(event)
        elif answer.get("method") == "lost":
            self._lost += answer["params"]["events"]

    @property
    def _stepped(self) -> bool:
        return bool(self.call("clock", {})["clock"] == "stepped")

    def now(self) -> int:
        return int(self.call("clock", {})["t_us"])

    def next_event(self) -> Optional[int]:
        raise Error("the control socket does not say when something happens next: use a bus in this process, or wait()")

    def advance(self, ticks: int) -> None:
        clock = self.call("clock", {})
        if clock["clock"] == "stepped":
            self.call("advance", {"ticks": ticks})
        else:
            self.call("wait", {"until": {"t": clock["t_us"] + ticks}})

    def wait(self, until: Dict[str, Any], limit: int) -> Dict[str, Any]:
        return self.call("advance" if self._stepped else "wait", {"until": until, "limit": limit})

    def events(self, subscription: int) -> Tuple[List[Dict[str, Any]], int]:
        # Events that have happened come before the answer.
        self.call("clock", {})
        lost, self._lost = self._lost, 0
        return self._events.pop(subscription, []), lost

    def host(self) -> "PtyHost":
        if self._host is None:
            if self._link is None:
                raise Error("to send and hear bytes: expected the link of the bus, as in connect(path, link=\"/tmp/rkm04\")")
            self._host = PtyHost(self, self._link)
        return self._host

    def frame(self, node: int, message: bytes) -> bytes:
        return _sim.frame(self.framing, node, message)

    def hear_message(self, limit: int) -> Optional[bytes]:
        host, end, data = self.host(), self.now() + limit, b""
        while host.wait_byte(max(0, end - self.now())):
            data += host.read()
            found = _sim.unframe(self.framing, data)
            if found is not None:
                return found[3]
        return None

    def close(self) -> None:
        if self._host is not None:
            self._host.close()
        self._socket.close()


class PtyHost(Host):
    """A host that has opened the pty of a running emulator."""

    def __init__(self, control: ControlSocket, link: str) -> None:
        self._control = control
        self._fd = os.open(link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self._heard = b""
        self._until = 0
        self._settings: Tuple[int, int, str, float] = (19200, 8, "N", 1)
        self.configure()

    def configure(self, baudrate: int = 19200, bytesize: int = 8, parity: str = "N", stopbits: float = 1) -> None:
        import termios

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

    def write(self, data: bytes, baudrate: Optional[int] = None, bytesize: Optional[int] = None, parity: Optional[str] = None,
              stopbits: Optional[float] = None, wait: bool = True) -> int:
        given = (baudrate, bytesize, parity, stopbits)
        if any(value is not None for value in given):
            new = [old if value is None else value for value, old in zip(given, self._settings)]
            self.configure(*new)  # type: ignore[arg-type]
        unit = self._control.call("units", {})["units"][0]
        before = self._bytes(unit)
        at = 0
        while at < len(data):
            select.select([], [self._fd], [], PATIENCE)
            at += os.write(self._fd, data[at:])
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
            real_time.sleep(0.0005)

    def _fetch(self, seconds: float) -> None:
        if select.select([self._fd], [], [], seconds)[0]:
            try:
                self._heard += os.read(self._fd, 65536)
            except BlockingIOError:
                pass

    def read(self, size: int = -1) -> bytes:
        self._fetch(0)
        end = len(self._heard) if size < 0 else size
        data, self._heard = self._heard[:end], self._heard[end:]
        return data

    def read_ticks(self, size: int = -1) -> List[Tuple[int, int]]:
        raise Error("a pty does not say when bytes have come: use bus.events(\"byte\")")

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
                self._fetch(0.02)  # what had passed by then may still be on its way through the pty
                break
            if self._control._stepped:
                self._control.advance(min(1000, end - now))
                self._fetch(0.001)
            else:
                self._fetch(0.005)
        return bool(self._heard)

    def set_break(self, on: bool) -> None:
        raise Error("a pty cannot hold the wires at 0: use bus.faults.inject(\"break\")")

    def send_break(self, time: Time = BREAK_SHORTEST) -> None:
        raise Error("a pty cannot hold the wires at 0: use bus.faults.inject(\"break\", for_=time)")

    def reset_output_buffer(self) -> int:
        import termios

        termios.tcflush(self._fd, termios.TCOFLUSH)
        return 0

    def close(self) -> None:
        os.close(self._fd)


class RemoteBus(Bus):
    """A bus of a running `rkm04 serve`; made by connect() and serve(). What a Bus can do, it can, in the time of that clock.

    link: the pty that host software opens; None if it is not known. rfc2217_url: what pyserial opens instead, of a bus that
    serve() has started; otherwise None.
    """

    def __init__(self, transport: ControlSocket, link: Optional[str], process: "Optional[Process]" = None) -> None:
        super().__init__(transport=transport)
        self.link = link
        self._process = process
        address = process.ready.get("rfc2217") if process is not None else None
        self.rfc2217_url: Optional[str] = None if address is None else f"rfc2217://{address}"

    @property
    def bus(self) -> "RemoteBus":
        """This bus."""
        return self

    def record(self, path: Any, force: bool = False) -> Any:
        """Not possible with a running emulator: start it with serve(record=…)."""
        raise Error("a running emulator cannot begin a recording: expected rkm04.serve(record=\"x.record\"), or "
                    "snapshot(file=…), which is a recording of all that has come in")

    def close(self) -> None:
        """End the connection, and the emulator if serve() has started it."""
        self._transport.close()
        if self._process is not None:
            process, self._process = self._process, None
            process.end()


def connect(path: "Union[str, os.PathLike[str]]", link: "Union[None, str, os.PathLike[str]]" = None) -> RemoteBus:
    """The bus of a running `rkm04 serve`, by the path of its control socket or control file.

    link: the link to its pty, for send(), exchange() and host; if left out, the path without ".control" if that is there.
    """
    path = os.fspath(path)
    if link is None and path.endswith(".control") and os.path.exists(path[:-len(".control")]):
        link = path[:-len(".control")]
    link = None if link is None else os.fspath(link)
    return RemoteBus(ControlSocket(path, link), link)


class Process:
    """A running `rkm04 serve` in a folder of its own."""

    def __init__(self, arguments: Sequence[str]) -> None:
        self.folder = tempfile.mkdtemp(prefix="rkm04-")
        self.link = os.path.join(self.folder, "bus")
        self.log = os.path.join(self.folder, "log")
        command = [find_program("rkm04"), "serve", "--link", self.link, *arguments]
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=log)
        try:
            self.ready = self._await_ready()
        except BaseException:
            self.end()
            raise

    def _await_ready(self) -> Dict[str, Any]:
        assert self.process.stdout is not None
        limit = threading.Timer(PATIENCE, self.process.kill)
        limit.start()
        line = self.process.stdout.readline()
        if not limit.is_alive():
            raise Error(f"expected READY from rkm04 serve within {PATIENCE:.0f} s, found nothing. {self._said()}")
        limit.cancel()
        if not line.endswith(b"\n"):
            raise Error(f"expected READY from rkm04 serve, found that it has ended: {self._said()}")
        ready: Dict[str, Any] = json.loads(line.split(b" ", 1)[1])
        return ready

    def _said(self) -> str:
        with open(self.log, encoding="utf-8", errors="replace") as log:
            return log.read()[-2000:].strip()

    def end(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def serve(units: Union[int, str] = 1, *, clock: str = "real", device: str = "rkm04", framing: Optional[str] = None,
          plant: "Union[None, str, os.PathLike[str]]" = None, seed: Optional[int] = None,
          readings: Optional[Mapping[str, Any]] = None, version_text: Optional[str] = None, turnaround: Optional[Time] = None,
          record: "Union[None, str, os.PathLike[str]]" = None, arguments: Sequence[str] = ()) -> RemoteBus:
    """Start `rkm04 serve` on a free link and wait until it is ready. It ends with the `with` block, or with close().

        with rkm04.serve(units="1,2", clock="x10") as bus:
            subprocess.run(["my-program", bus.link], check=True)
            assert bus.unit(2).motor(1).position == 500

    clock: "real", "xN" (N times as fast), "max", "stepped". plant, record: paths of files. arguments: more options of
    `rkm04 serve`. The rest: as for Bus. Raises Error with what rkm04 has said if it does not start.
    """
    options = ["--rfc2217", "127.0.0.1:0", "--node", str(units), "--clock", clock, "--device", device]
    given = {"--framing": framing, "--plant": plant, "--seed": seed, "--version-text": version_text, "--record": record,
             "--turnaround": None if turnaround is None else to_us(turnaround)}
    for name, value in given.items():
        if value is not None:
            options += [name, os.fspath(value) if isinstance(value, os.PathLike) else str(value)]
    if readings:
        options += ["--readings", ",".join(f"{name}={value}" for name, value in readings.items())]
    process = Process([*options, *arguments])
    try:
        return RemoteBus(ControlSocket(process.ready["control"], process.link), process.link, process)
    except BaseException:
        process.end()
        raise
