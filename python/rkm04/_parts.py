# SPDX-License-Identifier: MIT
"""What a bus consists of: units, motors, inputs and outputs, power, plant, injected faults, events, files."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Type, Union

from ._errors import ProgramError, always_shown
from ._message import Message, request
from ._time import Time

if TYPE_CHECKING:
    import os

    from ._bus import Bus, Transport

UnitName = Union[int, str]
"""A unit by its address at the start, 3 or "3"; the second one with the same address is "3-2"."""

BitName = Union[int, str]
"""An input, output or variable by its number; an input or output by the name that the device has for it."""

Level = Union[bool, int]
"""The level of an input or output, 0 or 1."""


class Bits:
    """Inputs, outputs or variables of a unit by their numbers: `bus.do[3]`; where the device has names for them, by those, too:
    `bus.di["x.near"]`. As an int: the mask, the first one in bit 0."""

    def __init__(self, unit: "Unit", member: str, first: int, count: int, names: List[str]) -> None:
        self._unit = unit
        self._member = member
        self._first = first
        self._count = count
        self._names = names

    def _place(self, number: BitName) -> int:
        if isinstance(number, str) and number in self._names:
            return self._names.index(number)
        if isinstance(number, bool) or not isinstance(number, int) or not self._first <= number < self._first + self._count:
            numbers = f"{self._first} to {self._first + self._count - 1}" if self._count > 0 else "none"
            names = f" or {', '.join(self._names)}" if self._names else ""
            raise IndexError(f"expected {self._member} {numbers}{names}, found {number!r}")
        return number - self._first

    def __getitem__(self, number: BitName) -> int:
        place = self._place(number)
        return self.mask >> place & 1

    @property
    def mask(self) -> int:
        """All of them, the first in bit 0."""
        return int(self._unit.state[self._member])

    def __int__(self) -> int:
        return self.mask

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[int]:
        mask = self.mask
        return iter([mask >> place & 1 for place in range(self._count)])

    @always_shown
    def __repr__(self) -> str:
        names = self._names or [str(self._first + place) for place in range(self._count)]
        on = [name for name, level in zip(names, self) if level]
        return f"<{self._member} on: {' '.join(on) or 'none'}>"


class Inputs(Bits):
    """The inputs of a unit: `bus.di[3] = 1`."""

    def __setitem__(self, number: BitName, level: Level) -> None:
        self._place(number)
        if level not in (0, 1):
            raise ValueError(f"expected level 0 or 1, found {level!r}")
        self._unit._call("di.set", di={str(number): int(level)})

    def set(self, levels: Mapping[BitName, Level]) -> List[int]:
        """Set several at once. Returns those that keep another level, because the plant or an injected fault holds them."""
        result = self._unit._call("di.set", di={str(number): int(level) for number, level in levels.items()})
        return list(result["overridden"])

    def set_mask(self, mask: int) -> List[int]:
        """Set all of them, the first one in bit 0. Returns as set()."""
        return list(self._unit._call("di.set", mask=mask)["overridden"])


class Motor:
    """A motor of a unit, 1 to 4."""

    def __init__(self, unit: "Unit", number: int) -> None:
        self._unit = unit
        self.number = number

    @property
    def all(self) -> Dict[str, Any]:
        """Everything that is known of it: a member of `motors` in the method `state`."""
        for motor in self._unit.state["motors"]:
            if motor["motor"] == self.number:
                return dict(motor)
        raise ValueError(f"expected a motor from 1 to {len(self._unit.state['motors'])}, found {self.number}")

    @property
    def position(self) -> int:
        """The position counter, -2^31 to 2^31 - 1 steps."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[0]

    @property
    def true_position(self) -> Optional[int]:
        """The true position in the plant, steps; None without a plant."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[1]

    @property
    def state(self) -> str:
        """idle, ready, moving, dwell, wait, block, held, ended or fault."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[2]

    @property
    def speed(self) -> int:
        """Present speed, steps/s; 0: it does not move."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[3]

    @property
    def fault(self) -> Optional[str]:
        """no_label, …; None: no fault."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[4]

    @property
    def led(self) -> str:
        """off, on or blink."""
        return self._unit.bus._transport.axis(self._unit.name, self.number)[5]

    @property
    def program(self) -> str:
        """The commands in memory, oldest first, as the unit gives them in the answer to a Get Command: the request goes over the
        bus, and takes its time."""
        return self._unit.exchange(request("Get Command", self.number)).text

    @property
    def commands(self) -> List[str]:
        """The commands in memory, oldest first, without asking the unit over the bus: no time passes."""
        told = self._unit.bus.call("motor.program", motor=self.number, **_unit(self._unit.name))
        commands: List[str] = told["commands"]
        return commands

    def set(self, text: str) -> Message:
        """Send a program text with a Set Command and wait for the answer. Returns the answer.

        text: at most 9214 characters. Raises ProgramError if the unit refuses it; nothing of it is executed then.
        """
        answer = self._unit.exchange(request("Set Command", self.number, text))
        if answer.flag in (1, 2):
            what = "a wrong value after" if answer.flag == 1 else "an unknown command"
            raise ProgramError(f"unit {self._unit.name}, motor {self.number}: expected a program that the unit accepts, "
                               f"found {what} {answer.text[1:]!r} in {text!r}")
        return answer

    def wait(self, limit: Time = "3600s", **condition: Any) -> int:
        """Bus.wait() for this motor: `motor.wait(state="idle", limit="5s")`."""
        return self._unit.bus.wait(limit=limit, unit=self._unit.name, motor=self.number, **condition)

    @always_shown
    def __repr__(self) -> str:
        motor = self.all
        return f"<motor {self.number} of unit {self._unit.name}: {motor['state']} at {motor['position']}>"


class Power:
    """The power switch of a unit: `bus.power.off()`. True while it is on."""

    def __init__(self, unit: "Unit") -> None:
        self._unit = unit

    def __call__(self, on: bool) -> None:
        """Switch on or off; nothing happens if it is so already."""
        self._unit._call("power", on=bool(on))

    def on(self) -> None:
        """Switch on: the unit starts as after power-up, with its flash."""
        self(True)

    def off(self) -> None:
        """Switch off: the unit stops in the middle of everything."""
        self(False)

    def cycle(self) -> None:
        """Off and on again, whether it was on or not."""
        self(False)
        self(True)

    def __bool__(self) -> bool:
        return bool(self._unit.state["powered"])

    @always_shown
    def __repr__(self) -> str:
        return f"<power {'on' if self else 'off'}>"


class Unit:
    """A unit on the bus."""

    def __init__(self, bus: "Bus", name: str) -> None:
        self.bus = bus
        self.name = name

    def _call(self, method: str, **params: Any) -> Dict[str, Any]:
        return self.bus.call(method, unit=self.name, **params)

    @property
    def state(self) -> Dict[str, Any]:
        """Everything that is known of it: the method `state` of docs/CONTROL.md."""
        return self._call("state")

    @property
    def node(self) -> int:
        """The address in use, 1 to 16: S1 as it stood at power-up."""
        return int(self.state["node"])

    def motor(self, number: int) -> Motor:
        """One of its motors: 1 to 4 of an RKM04."""
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise ValueError(f"expected a motor from 1 to {self.bus._kind['axes']}, found {number!r}")
        return Motor(self, number)

    @property
    def motors(self) -> List[Motor]:
        """All of them, motor 1 first."""
        return [Motor(self, int(motor["motor"])) for motor in self.state["motors"]]

    @property
    def di(self) -> Inputs:
        """Its inputs: DI 01 to DI 08 of an RKM04."""
        kind = self.bus._kind
        return Inputs(self, "di", 1, int(kind["inputs"]), kind.get("input_names", []))

    @property
    def do(self) -> Bits:
        """Its outputs: DO 01 to DO 08 of an RKM04."""
        kind = self.bus._kind
        return Bits(self, "do", 1, int(kind["outputs"]), kind.get("output_names", []))

    @property
    def var(self) -> Bits:
        """Its variables: VAR 80 to VAR 95 of an RKM04."""
        return Bits(self, "var", int(self.bus._kind["first_variable"]), int(self.bus._kind["variables"]), [])

    @property
    def power(self) -> Power:
        """Its power switch."""
        return Power(self)

    def reset(self) -> None:
        """Power off and on. Raises RefusedError if it has no power."""
        self._call("reset")

    def set_switch(self, node: int, reset: bool = False) -> None:
        """Set the address switch S1 to 1..16, which is read at power-up; reset: power off and on as well."""
        self._call("switch", node=node, reset=reset)

    def send(self, message: Union[bytes, Message]) -> int:
        """Bus.send() to its address."""
        return self.bus.send(self.node, message)

    def exchange(self, message: Union[bytes, Message], limit: Time = "2s") -> Message:
        """Bus.exchange() with its address."""
        return self.bus.exchange(self.node, message, limit)

    def __repr__(self) -> str:
        return f"<unit {self.name}>"


class Fault:
    """An injected fault."""

    def __init__(self, bus: "Bus", id: int) -> None:
        self._bus = bus
        self.id = id

    @property
    def all(self) -> Optional[Dict[str, Any]]:
        """What `fault.list` says of it; None: it is there no more."""
        for fault in self._bus.faults:
            if fault["id"] == self.id:
                return fault
        return None

    @property
    def acted(self) -> int:
        """How often it has acted; 0 if it is there no more."""
        fault = self.all
        return 0 if fault is None else int(fault["acted"])

    def clear(self) -> None:
        """Remove it."""
        self._bus.call("fault.clear", id=self.id)

    def __repr__(self) -> str:
        return f"<fault {self.id}>"


class Faults:
    """Injected faults (docs/FAULTS.md): a list of what `fault.list` says of each."""

    def __init__(self, bus: "Bus") -> None:
        self._bus = bus

    def inject(self, kind: str, **params: Any) -> Fault:
        """Inject one: `bus.faults.inject("drop", direction="to_units", skip=3, count=1)`.

        kind and parameters: those of `fault.inject` in docs/CONTROL.md; times as in Bus.advance(). What is a word of Python has
        an underscore after it: for_="1s".
        """
        given = {name.rstrip("_"): value for name, value in params.items()}
        return Fault(self._bus, int(self._bus.call("fault.inject", kind=kind, **given)["id"]))

    def clear(self) -> int:
        """Remove all. Returns how many there were."""
        return int(self._bus.call("fault.clear")["cleared"])

    def list(self) -> List[Dict[str, Any]]:
        """Each with its kind, its parameters, and how often it has `acted`."""
        faults: List[Dict[str, Any]] = self._bus.call("fault.list")["faults"]
        return faults

    def kinds(self) -> Dict[str, Any]:
        """What inject() takes: `kinds`, each with its `parameters`, and those that all have, `common`."""
        told: Dict[str, Any] = self._bus.call("fault.kinds")
        return told

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        return iter(self.list())

    def __len__(self) -> int:
        return len(self.list())

    @always_shown
    def __repr__(self) -> str:
        return f"<faults: {', '.join(str(fault['kind']) for fault in self) or 'none'}>"


class Plant:
    """The simulated mechanics (docs/PLANT.md)."""

    def __init__(self, bus: "Bus") -> None:
        self._bus = bus

    def state(self, unit: Optional[UnitName] = None) -> Optional[Dict[str, Any]]:
        """The present state of a unit's plant; None without one."""
        plant: Optional[Dict[str, Any]] = self._bus.call("plant.get", **_unit(unit))["plant"]
        return plant

    def set(self, plant: "PlantSource") -> None:
        """Give all units this plant: the path of a file, its text, the same as a dict; None: none."""
        self._bus.call("plant.set", plant=read_plant(plant))

    def turn(self, motor: int, position: int, unit: Optional[UnitName] = None) -> None:
        """Turn an axis by hand to a true position, steps."""
        self._bus.call("plant.set", motor=motor, position=position, **_unit(unit))

    def jam(self, motor: int, jammed: bool = True, unit: Optional[UnitName] = None) -> None:
        """Block an axis, or free it."""
        self._bus.call("plant.set", motor=motor, jammed=jammed, **_unit(unit))

    def cut_lead(self, motor: int, missing: bool = True, unit: Optional[UnitName] = None) -> None:
        """Take a lead of a motor away, or give it back."""
        self._bus.call("plant.set", motor=motor, missing_lead=missing, **_unit(unit))


PlantSource = Union[None, str, "os.PathLike[str]", Mapping[str, Any]]
"""A plant: the path of a file, a text of more than one line, a dict as in the file, or None."""


def read_plant(plant: PlantSource) -> Any:
    """What `plant.set` takes: a text, a dict or None."""
    if plant is None or isinstance(plant, Mapping):
        return plant
    if isinstance(plant, str) and "\n" in plant:
        return plant
    with open(plant, encoding="utf-8") as file:
        return file.read()


def _unit(unit: Optional[UnitName]) -> Dict[str, Any]:
    return {} if unit is None else {"unit": unit}


class Events:
    """What happens on a bus from now on: `with bus.events("step", motor=1) as steps: …; for step in steps: …`.

    Iterating takes the events that have come so far, dicts as in docs/CONTROL.md, each once.
    """

    def __init__(self, transport: "Transport", kinds: List[str], motor: Any, unit: Any, cells: Any = None) -> None:
        params: Dict[str, Any] = {}
        if kinds:
            params["kinds"] = kinds
        if motor is not None:
            params["motor"] = motor
        if unit is not None:
            params["unit"] = unit
        if cells is not None:
            params["cells"] = list(cells)
        self._transport = transport
        answer = transport.call("subscribe", params)
        self._number: int = answer["subscription"]
        self.cells: Dict[str, int] = answer.get("cells", {})
        """What the cells were at the beginning."""
        self._closed = False
        self.lost = 0
        """How many events were lost because nobody took them (more than 64 MiB)."""

    def take(self) -> List[Dict[str, Any]]:
        """The events since the last call."""
        if self._closed:
            return []
        events, lost = self._transport.events(self._number)
        self.lost += lost
        return events

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        return iter(self.take())

    def close(self) -> None:
        """End it; what has come and was not taken is forgotten."""
        if not self._closed:
            self._closed = True
            self._transport.call("unsubscribe", {"subscription": self._number})

    def __enter__(self) -> "Events":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        # What was gathered in the block can be read after it.
        rest = self.take()
        self.close()
        self.take = lambda: [rest.pop(0) for _ in range(len(rest))]  # type: ignore[method-assign]


class File:
    """A file that is being written about a bus. Ended by stop(), by the end of a `with` block, or with the bus."""

    def __init__(self, bus: "Bus", path: str, method: str, params: Dict[str, Any]) -> None:
        self._bus = bus
        self._method = method
        self._params = params
        self._stopped = False
        self.path = path
        """Its name."""

    def stop(self) -> None:
        """End it. Raises RefusedError if it could not be written."""
        if not self._stopped:
            self._stopped = True
            self._bus.call(self._method, **self._params)

    def __enter__(self) -> "File":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.stop()
