# SPDX-License-Identifier: MIT
"""A bus behind the control socket of `rkm04 serve`, and starting one."""

from __future__ import annotations

import json
import os
import shutil
import socket
import stat
import subprocess
import tempfile
import threading
import time as real_time
from types import TracebackType
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Type, Union

from . import _sim, _system
from ._bus import Bus, Transport
from ._errors import Error, RefusedError
from ._programs import find_program
from ._remote_host import PATIENCE, TCP, RemoteHost, TcpHost
from ._time import Time, to_us

LASTING = frozenset({"advance", "wait", "restore", "cnc.exchange"})
"""Methods that take as long as there is to do."""


class ControlSocket(Transport):
    """JSON-RPC, one object a line. path: of the socket, or of the control file of a TCP port. timeout: see connect()."""

    def __init__(self, path: str, link: Optional[str], timeout: Optional[float] = None) -> None:
        if timeout is not None and not timeout > 0:
            raise ValueError(f"timeout: expected s of real time above 0, or None, found {timeout!r}")
        self._path = path
        self._timeout = timeout
        self._link = link
        self._next = 0
        self._rest = b""
        self._events: Dict[int, List[Dict[str, Any]]] = {}
        self._lost = 0
        self._host: Optional[RemoteHost] = None
        try:
            self._socket = self._enter(path) if stat.S_ISREG(os.stat(path).st_mode) else _system.connect_socket(path)
        except OSError as error:
            raise Error(f"expected the control socket of a running rkm04 serve at {path}, found: {error.strerror or error}") \
                from None
        try:
            self.framing: str = self.call("units", {}).get("framing", "hdlc")
        except BaseException:
            self._socket.close()
            raise

    def _enter(self, path: str) -> socket.socket:
        """The TCP port of a control file, with its token shown."""
        with open(path, encoding="ascii", errors="replace") as file:
            parts = file.read(200).split()
        host, _, port = parts[0][len("tcp:"):].rpartition(":") if len(parts) == 2 else ("", "", "")
        if not parts or not parts[0].startswith("tcp:") or not port.isdecimal():
            raise Error(f"expected the control socket of a running rkm04 serve at {path}, found another file")
        self._socket = socket.create_connection((host.strip("[]"), int(port)), PATIENCE)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            self.call("authenticate", {"token": parts[1]})
        except BaseException:
            self._socket.close()
            raise
        return self._socket

    def _line(self, end: Optional[float]) -> Dict[str, Any]:
        while b"\n" not in self._rest:
            self._socket.settimeout(None if end is None else max(0.001, end - real_time.monotonic()))
            part = self._socket.recv(65536)
            if not part:
                raise Error(f"expected an answer from {self._path}, found that rkm04 serve has ended")
            self._rest += part
        line, self._rest = self._rest.split(b"\n", 1)
        answer: Dict[str, Any] = json.loads(line)
        return answer

    def _send(self, line: bytes, limit: Optional[float]) -> None:
        self._socket.settimeout(limit)
        try:
            self._socket.sendall(line)
        except socket.timeout:
            self._socket.close()  # only a part of the request may have gone
            raise

    def call(self, method: str, params: Dict[str, Any]) -> Dict[str, Any]:
        self._next += 1
        request = {"jsonrpc": "2.0", "id": self._next, "method": method, "params": params}
        limit = self._timeout if self._timeout is not None or method in LASTING else PATIENCE
        end = None if limit is None else real_time.monotonic() + limit
        try:
            self._send(json.dumps(request).encode() + b"\n", limit)
            while True:
                answer = self._line(end)
                if answer.get("id") == self._next:
                    break
                self._take(answer)
            while method == "shutdown" and "result" in answer and self._socket.recv(65536):
                pass  # it has ended when the connection has
        except socket.timeout:
            raise Error(f"expected an answer from {self._path} to {method} within {limit:g} s of real time, found none") from None
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
    def is_stepped(self) -> bool:
        """Does its time pass in advance() alone?"""
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
        return self.call("advance" if self.is_stepped else "wait", {"until": until, "limit": limit})

    def events(self, subscription: int) -> Tuple[List[Dict[str, Any]], int]:
        # Events that have happened come before the answer.
        self.call("clock", {})
        lost, self._lost = self._lost, 0
        return self._events.pop(subscription, []), lost

    def host(self) -> RemoteHost:
        if self._host is None:
            if self._link is None:
                raise Error("to send and hear bytes: expected the link of the bus, as in connect(path, link=\"/tmp/rkm04\") or "
                            "link=\"socket://127.0.0.1:4001\"")
            if self._link.startswith(TCP):
                self._host = TcpHost(self, self._link[len(TCP):])
            else:
                self._host = _system.open_link(self, self._link)
        return self._host

    def rest(self) -> None:
        if self._host is not None:
            self._host.rest()

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


class RemoteBus(Bus):
    """A bus of a running `rkm04 serve`; made by connect() and serve(). What a Bus can do, it can, in the time of that clock.

    link: the pty that host software opens; None if it is not known, and on Windows. port: what pyserial opens: the link, or a URL
    socket://HOST:PORT where there is none. tcp_url, rfc2217_url: socket:// and rfc2217:// of a bus that serve() has started;
    otherwise None.
    """

    def __init__(self, transport: ControlSocket, link: Optional[str], process: "Optional[Process]" = None) -> None:
        super().__init__(transport=transport)
        self._process = process
        ready = process.ready if process is not None else {}
        self.tcp_url: Optional[str] = f"{TCP}{ready['tcp']}" if ready.get("tcp") else None
        self.rfc2217_url: Optional[str] = f"rfc2217://{ready['rfc2217']}" if ready.get("rfc2217") else None
        self.port: Optional[str] = link
        self.link: Optional[str] = None if link is None or link.startswith(TCP) else link

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


def connect(path: "Union[str, os.PathLike[str]]", link: "Union[None, str, os.PathLike[str]]" = None,
            timeout: Optional[float] = None) -> RemoteBus:
    """The bus of a running `rkm04 serve`, by the path of its control socket or control file.

    link: the link to its pty, for send(), exchange() and host, or "socket://HOST:PORT", its TCP port; if left out, the path
    without ".control" if that is there. timeout: s of real time that a request may take before Error is raised; if left out,
    30 s, and no limit for advance(), wait(), restore() and the exchange of cells of a CNC872.
    """
    path = os.fspath(path)
    if link is None and path.endswith(".control") and os.path.exists(path[:-len(".control")]):
        link = path[:-len(".control")]
    link = None if link is None else os.fspath(link)
    return RemoteBus(ControlSocket(path, link, timeout), link)


class Process:
    """A running `rkm04 serve` in a folder of its own."""

    def __init__(self, arguments: Sequence[str]) -> None:
        self.folder = tempfile.mkdtemp(prefix="rkm04-")
        self.link = _system.link_in(self.folder)
        self.log = os.path.join(self.folder, "log")
        self.ready: Dict[str, Any] = {}
        command = [find_program("rkm04"), "serve", *_system.serve_arguments(self.folder, arguments)]
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

    def _shut_down(self) -> None:
        control = ControlSocket(self.ready["control"], None)
        try:
            control.call("shutdown", {})
        finally:
            control.close()

    def end(self) -> None:
        """Let it end, and remove its folder."""
        _system.end_process(self.process, self._shut_down)
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
          record: "Union[None, str, os.PathLike[str]]" = None, arguments: Sequence[str] = (),
          timeout: Optional[float] = None) -> RemoteBus:
    """Start `rkm04 serve` on a free link, on Windows at a free TCP port, and wait until it is ready. It ends with the `with`
    block, or with close().

        with rkm04.serve(units="1,2", clock="x10") as bus:
            subprocess.run(["my-program", bus.port], check=True)
            assert bus.unit(2).motor(1).position == 500

    clock: "real", "xN" (N times as fast), "max", "stepped". plant, record: paths of files. arguments: more options of
    `rkm04 serve`. timeout: as for connect(). The rest: as for Bus. Raises Error with what rkm04 has said if it does not start.
    """
    options = ["--tcp", "127.0.0.1:0", "--rfc2217", "127.0.0.1:0", "--node", str(units), "--clock", clock, "--device", device]
    given = {"--framing": framing, "--plant": plant, "--seed": seed, "--version-text": version_text, "--record": record,
             "--turnaround": None if turnaround is None else to_us(turnaround)}
    for name, value in given.items():
        if value is not None:
            options += [name, os.fspath(value) if isinstance(value, os.PathLike) else str(value)]
    if readings:
        options += ["--readings", ",".join(f"{name}={value}" for name, value in readings.items())]
    process = Process([*options, *arguments])
    try:
        link = process.link or f"{TCP}{process.ready['tcp']}"
        return RemoteBus(ControlSocket(process.ready["control"], link, timeout), link, process)
    except BaseException:
        process.end()
        raise
