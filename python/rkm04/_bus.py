# SPDX-License-Identifier: MIT
"""A bus with its units and a host at its end, in this process and in virtual time."""

from __future__ import annotations

import json
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Type, Union

from . import _ports, _sim
from ._dialogue import Dialogue
from ._errors import NoAnswerError, WaitError, always_shown
from ._message import Message
from ._parts import Bits, Events, Faults, File, Inputs, Plant, PlantSource, Power, Unit, UnitName, read_plant
from ._time import Time, to_us

if TYPE_CHECKING:
    import os

    Path = Union[str, "os.PathLike[str]"]

BREAK_SHORTEST = 573
"""us: eleven bits at 19200 baud."""


Axis = Tuple[int, Optional[int], str, int, Optional[str], str]


class Transport:
    """How a bus is reached. What is common to one in this process and one behind a control socket."""

    def call(self, method: str, params: Dict[str, Any]) -> Dict[str, Any]:
        raise NotImplementedError

    def now(self) -> int:
        raise NotImplementedError

    def next_event(self) -> Optional[int]:
        raise NotImplementedError

    def advance(self, ticks: int) -> None:
        raise NotImplementedError

    def events(self, subscription: int) -> Tuple[List[Dict[str, Any]], int]:
        raise NotImplementedError

    def axis(self, unit: str, motor: int) -> Axis:
        """What can be seen of a motor: position, true position, state, speed, fault, LED."""
        for seen in self.call("state", {"unit": unit})["motors"]:
            if seen["motor"] == motor:
                return (seen["position"], seen["true_position"], seen["state"], seen["speed"], seen["fault"], seen["led"])
        raise ValueError(f"expected a motor of unit {unit}, found {motor}")

    def wait(self, until: Dict[str, Any], limit: int) -> Dict[str, Any]:
        """Let time pass until a condition holds, at most `limit` us."""
        return self.call("advance", {"until": until, "limit": limit})

    def host(self) -> "Host":
        raise NotImplementedError

    def frame(self, node: int, message: bytes) -> bytes:
        """The bytes on the wires of a message to a node."""
        raise NotImplementedError

    def hear_message(self, limit: int) -> Optional[bytes]:
        """Let time pass until a whole message has come to the host, at most `limit` us. Returns it; None: none came."""
        raise NotImplementedError

    def rest(self) -> None:
        """An exchange is over."""

    def close(self) -> None:
        raise NotImplementedError


class InProcess(Transport):
    """The extension."""

    def __init__(self, options: Dict[str, Any]) -> None:
        self.sim = _sim.Sim(json.dumps(options))

    def call(self, method: str, params: Dict[str, Any]) -> Dict[str, Any]:
        if method == "shutdown" and not params:
            now = self.sim.now()
            self.sim.close()
            return {"t_us": now}
        result: Dict[str, Any] = json.loads(self.sim.call(method, json.dumps(params)))
        return result

    def now(self) -> int:
        return self.sim.now()

    def next_event(self) -> Optional[int]:
        return self.sim.next_event()

    def advance(self, ticks: int) -> None:
        self.sim.advance(self.sim.now() + ticks)

    def events(self, subscription: int) -> Tuple[List[Dict[str, Any]], int]:
        lines, lost, _ = self.sim.events(subscription)
        return [json.loads(line) for line in lines.splitlines()], lost

    def axis(self, unit: str, motor: int) -> Axis:
        return self.sim.axis(unit, motor)

    def host(self) -> "Host":
        return InProcessHost(self.sim)

    def frame(self, node: int, message: bytes) -> bytes:
        return self.sim.frame(node, message)

    def hear_message(self, limit: int) -> Optional[bytes]:
        heard = self.sim.hear_message(self.sim.now() + limit)
        return None if heard is None else heard[2]

    def close(self) -> None:
        self.sim.close()


class Host:
    """The host's port at the end of the bus. Its own speed and characters need not be those of the units (19200 8N1): then both
    hear what comes of it."""

    def configure(self, baudrate: int = 19200, bytesize: int = 8, parity: str = "N", stopbits: float = 1) -> None:
        """Set the port: baudrate from 1 on, bytesize 5 to 8, parity N, E, O, M or S, stopbits 1, 1.5 or 2."""
        raise NotImplementedError

    def write(self, data: bytes, baudrate: Optional[int] = None, bytesize: Optional[int] = None, parity: Optional[str] = None,
              stopbits: Optional[float] = None, wait: bool = True) -> int:
        """Send bytes from now on, after those under way. Returns their number.

        With `wait`, time passes until the last one has passed; without, they are under way. Settings that are given stay.
        """
        raise NotImplementedError

    def read(self, size: int = -1) -> bytes:
        """Take up to `size` bytes that have come; -1: all. No time passes."""
        raise NotImplementedError

    def read_ticks(self, size: int = -1) -> List[Tuple[int, int]]:
        """The same as a list of (tick at which it had passed, byte)."""
        raise NotImplementedError

    @property
    def in_waiting(self) -> int:
        """How many bytes have come and were not read; at most 1048576, more are lost."""
        raise NotImplementedError

    @property
    def out_until(self) -> int:
        """Tick at which the host's last byte has passed, us."""
        raise NotImplementedError

    @property
    def lost(self) -> int:
        """How many bytes were lost because too many were not read."""
        raise NotImplementedError

    @property
    def idle(self) -> bool:
        """Is the bus at rest: no byte under way, no answer to come?"""
        raise NotImplementedError

    def wait_byte(self, limit: Time) -> bool:
        """Let time pass until there is a byte to read, at most for `limit`. Returns whether there is one."""
        raise NotImplementedError

    def set_break(self, on: bool) -> None:
        """Hold the wires at 0 from now on, or no more."""
        raise NotImplementedError

    def send_break(self, time: Time = BREAK_SHORTEST) -> None:
        """Hold the wires at 0 for this time, which passes."""
        raise NotImplementedError

    def reset_input_buffer(self) -> None:
        """Forget what has come and was not read."""
        self.read(-1)

    def reset_output_buffer(self) -> int:
        """Forget what was written and has not set out. Returns the number of bytes."""
        raise NotImplementedError


class InProcessHost(Host):
    def __init__(self, sim: _sim.Sim) -> None:
        self._sim = sim
        self._until = 0
        self._settings: Tuple[int, int, str, float] = (19200, 8, "N", 1)

    def configure(self, baudrate: int = 19200, bytesize: int = 8, parity: str = "N", stopbits: float = 1) -> None:
        self._sim.configure(baudrate, bytesize, parity, int(2 * stopbits))
        self._settings = (baudrate, bytesize, parity, stopbits)

    def write(self, data: bytes, baudrate: Optional[int] = None, bytesize: Optional[int] = None, parity: Optional[str] = None,
              stopbits: Optional[float] = None, wait: bool = True) -> int:
        if baudrate is not None or bytesize is not None or parity is not None or stopbits is not None:
            old = self._settings
            self.configure(old[0] if baudrate is None else baudrate, old[1] if bytesize is None else bytesize,
                           old[2] if parity is None else parity, old[3] if stopbits is None else stopbits)
        data = bytes(data)
        self._until = self._sim.write(data)
        if wait:
            self._sim.advance(self._until)
        return len(data)

    def read(self, size: int = -1) -> bytes:
        return self._sim.read(size)

    def read_ticks(self, size: int = -1) -> List[Tuple[int, int]]:
        return self._sim.read_ticks(size)

    @property
    def in_waiting(self) -> int:
        return self._sim.in_waiting()

    @property
    def out_until(self) -> int:
        return self._until

    @property
    def lost(self) -> int:
        return self._sim.lost()

    @property
    def idle(self) -> bool:
        return self._sim.is_idle()

    def wait_byte(self, limit: Time) -> bool:
        return self._sim.wait_byte(self._sim.now() + to_us(limit))

    def set_break(self, on: bool) -> None:
        self._sim.set_break(on)

    def send_break(self, time: Time = BREAK_SHORTEST) -> None:
        self._sim.set_break(True)
        self._sim.advance(self._sim.now() + to_us(time))
        self._sim.set_break(False)

    def reset_output_buffer(self) -> int:
        return self._sim.purge()


def _device_name(transport: Transport) -> Callable[[], str]:
    """The name of the device, asked for once. It holds the transport alone: a bus is freed when nobody has it any more."""
    names: List[str] = []

    def name() -> str:
        if not names:
            names.append(str(transport.call("device", {})["name"]))
        return names[0]

    return name


class Bus:
    """A bus with its units in this process, in virtual time. The same calls give the same results, always.

        with rkm04.Bus(units="1,2", plant="axis.yaml") as bus:
            bus.unit(1).motor(1).set("F1000 R")
            bus.wait(unit=1, motor=1, state="idle", limit="10s")
            assert bus.unit(1).motor(1).position == 1000

    units: addresses, 3 or "1,2,5-8"; at most 16 units, 1 to 16 each.
    device: kind of the units, one that `rkm04 devices` lists. framing: "hdlc" or "plain".
    plant: path of a file, its text, or a dict.
    seed: of faults with a probability, 0 to 2^63 - 1. readings: as in docs/READINGS.md, {"hold-exit": "latch"}.
    version_text: at most 255 characters. turnaround: from the end of a request to its answer, 0 to 1 s.
    settings: of another device, as recordings have them: {"comm_timeout": 500} of a CIB module, {"nc": TEXT} of a CNC872.
    timed: False: bytes take no time. journal: False: what comes in is not kept, and snapshots cannot be written to files.
    """

    def __init__(self, units: Union[int, str] = 1, *, device: str = "rkm04", framing: Optional[str] = None,
                 plant: PlantSource = None, seed: int = 1, readings: Optional[Mapping[str, Any]] = None,
                 version_text: Optional[str] = None, turnaround: Optional[Time] = None, timed: bool = True,
                 journal: bool = True, settings: Optional[Mapping[str, Any]] = None,
                 transport: Optional[Transport] = None) -> None:
        if transport is None:
            given = {**(settings or {}), "framing": framing or ("hdlc" if device == "rkm04" else None),
                     "plant": read_plant(plant), "readings": readings, "version_text": version_text,
                     "turnaround": None if turnaround is None else to_us(turnaround)}
            options: Dict[str, Any] = {name: value for name, value in given.items() if value is not None}
            options.update(units=units, device=device, seed=seed, timed=timed, journal=journal)
            transport = InProcess(options)
        self._transport = transport
        self._host: Optional[Host] = None
        self._names: Optional[List[str]] = None
        self._snapshots = 0
        self._messages = Events(transport, ["message"], None, None)
        self._device: Optional[Dict[str, Any]] = None
        self._dialogue = Dialogue(self._messages.take, device=_device_name(transport))

    # ---- Anything ----

    def call(self, method: str, **params: Any) -> Dict[str, Any]:
        """Do a method of docs/CONTROL.md: `bus.call("di.set", mask=3)`. Returns its result. Raises RefusedError."""
        return self._transport.call(method, params)

    def close(self) -> None:
        """End its files and free it, and its name in URLs. A closed bus raises ClosedError; closing it twice does nothing."""
        _ports.forget(self)
        self._transport.close()

    def __enter__(self) -> "Bus":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    @property
    def simulation(self) -> _sim.Sim:
        """The extension's object of a bus in this process. Raises TypeError for one behind a control socket."""
        if not isinstance(self._transport, InProcess):
            raise TypeError(f"expected a bus in this process, as rkm04.Bus() makes it, found {self!r}")
        return self._transport.sim

    @property
    def ready(self) -> Dict[str, Any]:
        """What `rkm04 serve` says in its line READY: `pty`, `link`, `tcp`, …; None for what there is not, as in this process."""
        return self.call("ready")

    # ---- Units ----

    @property
    def device(self) -> Dict[str, Any]:
        """What the units are: `name`, how many `axes`, `inputs`, `outputs`, …"""
        return self.call("device")

    @property
    def _kind(self) -> Dict[str, Any]:
        if self._device is None:
            self._device = self.device
        return self._device

    @property
    def units(self) -> List[Unit]:
        """All units, in the order in which they were given."""
        if self._names is None:
            self._names = [str(name) for name in self.call("units")["units"]]
        return [Unit(self, name) for name in self._names]

    def unit(self, name: Optional[UnitName] = None) -> Unit:
        """A unit by its address at the start, 3 or "3-2"; without: the only one."""
        units = self.units
        if name is None and len(units) == 1:
            return units[0]
        for unit in units:
            if unit.name == str(name):
                return unit
        names = ", ".join(unit.name for unit in units)
        if name is None:
            raise ValueError(f"expected a unit, as in bus.unit({units[0].name}): there are {names}")
        raise ValueError(f"expected one of the units {names}, found {name!r}")

    @property
    def di(self) -> Inputs:
        """Inputs of the only unit."""
        return self.unit().di

    @property
    def do(self) -> Bits:
        """Outputs of the only unit."""
        return self.unit().do

    @property
    def power(self) -> Power:
        """The power switch of the only unit."""
        return self.unit().power

    # ---- Time ----

    @property
    def now(self) -> int:
        """The present tick, us since the bus was made. It never decreases."""
        return self._transport.now()

    @property
    def next_event(self) -> Optional[int]:
        """A tick before which nothing happens of itself, us; None: nothing ever does."""
        return self._transport.next_event()

    def advance(self, time: Time) -> int:
        """Let virtual time pass: us, "250ms", or a timedelta. Returns the present tick."""
        self._transport.advance(to_us(time))
        return self._transport.now()

    def wait(self, condition: Union[Mapping[str, Any], Callable[[], object], None] = None, limit: Time = "3600s",
             **more: Any) -> int:
        """Let virtual time pass until a condition holds. Returns the tick.

        condition: one of docs/CONTROL.md as a dict, its members as keywords (`bus.wait(motor=1, state="idle")`), or a function,
        which is called at least once a ms. limit: the longest virtual time, one hour if left out.
        Raises WaitError, which says what there was instead.
        """
        if callable(condition):
            return self._wait_for(condition, to_us(limit))
        until = dict(condition or {}, **more)
        result = self._transport.wait(until, to_us(limit))
        if not result["holds"]:
            raise WaitError(f"expected {json.dumps(until)} within {_seconds(to_us(limit))}, seen at {_seconds(self.now)}: "
                            f"{result['text']}")
        return int(result["t_us"])

    def _wait_for(self, condition: Callable[[], object], limit: int) -> int:
        end = self.now + limit
        while not condition():
            now = self.now
            if now >= end:
                name = getattr(condition, "__name__", condition)
                raise WaitError(f"expected {name!r} to return true within {_seconds(limit)}, seen at {_seconds(now)}: "
                                "it does not")
            self._transport.advance(min(1000, end - now))
        return self.now

    @property
    def clock(self) -> str:
        """ "stepped": time passes in the calls that say so, always in this process. "real", "xN", "max": it passes by itself."""
        return str(self.call("clock")["clock"])

    @clock.setter
    def clock(self, clock: str) -> None:
        self.call("clock", clock=clock)

    # ---- Messages ----

    @property
    def host(self) -> Host:
        """The host's port at the end of the bus. Raises ValueError if the device has no bus."""
        if not self._kind.get("bus", True):
            raise ValueError(f"the device {self._kind['name']} has no bus")
        if self._host is None:
            self._host = self._transport.host()
        return self._host

    def send(self, node: int, message: Union[bytes, Message]) -> int:
        """Send a message, framed, to a node: 1 to 16, 0: all. Time passes until it has passed. Returns the tick."""
        self.host.write(self._transport.frame(node, bytes(message)))
        return self.now

    def exchange(self, node: int, message: Union[bytes, Message], limit: Time = "2s") -> Message:
        """Send a message and wait for the answer. What came before is forgotten.

        limit: longest virtual time from the end of the request to the end of the answer. Raises NoAnswerError.
        """
        self.host.reset_input_buffer()
        self.send(node, message)
        heard = self._transport.hear_message(to_us(limit))
        self._transport.rest()
        if heard is None:
            words = Message(bytes(message), False, str(self._kind["name"])).words
            raise NoAnswerError(f"expected an answer of node {node} to {words} within "
                                f"{_seconds(to_us(limit))}, seen none at {_seconds(self.now)}")
        return Message(heard, True, str(self._kind["name"]))

    @property
    def dialogue(self) -> Dialogue:
        """What has passed on the wires: a list of exchanges."""
        return self._dialogue

    # ---- What is done to it ----

    @property
    def faults(self) -> Faults:
        """Injected faults."""
        return Faults(self)

    @property
    def plant(self) -> Plant:
        """The simulated mechanics."""
        return Plant(self)

    def snapshot(self, name: Optional[str] = None, *, file: Optional["Path"] = None, force: bool = False) -> str:
        """Keep the state of the whole bus: in memory under a name (made up if left out; at most 64), or in a file, which is a
        recording of all that has come in. force: replace a file of another kind. Returns the name, or the path."""
        if file is not None:
            self.call("snapshot", file=str(file), force=force)
            return str(file)
        if name is None:
            self._snapshots += 1
            name = f"snapshot {self._snapshots}"
        self.call("snapshot", name=name)
        return name

    def restore(self, name: Optional[str] = None, *, file: Optional["Path"] = None) -> None:
        """Come back to a snapshot: the last one that snapshot() has made up a name for, the one of this name, or a file.
        Ticks go on: what followed then follows now, later."""
        if file is not None:
            self.call("restore", file=str(file))
        else:
            self.call("restore", name=name if name is not None else f"snapshot {self._snapshots}")

    # ---- What is seen of it ----

    def events(self, *kinds: str, motor: Union[None, int, List[int]] = None,
               unit: Union[None, UnitName, List[UnitName]] = None, cells: Optional[Sequence[str]] = None) -> Events:
        """What happens from now on: kinds of docs/CONTROL.md ("step", "outputs", …), of some motors and units; all if left
        out. cells: changes of these cells of a device that has some, and no other kinds if none are named. At most 15 at a
        time."""
        return Events(self._transport, list(kinds), motor, unit, cells)

    def trace(self, path: "Path", force: bool = False) -> File:
        """Write a file about what happens from now on: .vcd, .csv, .jsonl for what the units do, .log, .pcapng for what passes
        on the wires. force: overwrite a file of another kind. At most 16 at a time."""
        result = self.call("trace.start", file=str(path), force=force)
        return File(self, str(path), "trace.stop", {"trace": result["trace"]})

    def record(self, path: "Path", force: bool = False) -> File:
        """Write a recording, which `rkm04 replay` repeats and compares. At tick 0 only, before anything is sent."""
        self.call("record.start", file=str(path), force=force)
        return File(self, str(path), "record.stop", {})

    @always_shown
    def __repr__(self) -> str:
        return f"<{type(self).__name__} with units {', '.join(unit.name for unit in self.units)} at {_seconds(self.now)}>"


def _seconds(us: int) -> str:
    """ "1.250000 s", as messages of rkm04 have it."""
    return f"{us // 1_000_000}.{us % 1_000_000:06d} s"
