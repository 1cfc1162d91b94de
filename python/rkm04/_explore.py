# SPDX-License-Identifier: MIT
"""Exploration: run a test again and again, each time with one fault at another place, and report the smallest set of faults
under which it fails.

The first run, without faults, shows which messages pass and how many bytes they have. Every further run is fresh (new bus, same
seed) and has one fault (`pairs=True`: also two) at one of these places.
"""
from __future__ import annotations

import itertools
import os
import random
import sys
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, TypeVar, Union

from . import _system
from ._errors import RefusedError
from ._message import Message
from ._ports import clock_of
from ._time import to_us

REPLAY = "RKM04_REPLAY"  # environment variable: the faults of one run
KINDS = ("lost byte", "flipped bit", "late answer", "no answer", "wrong check value", "power cycle", "input flickers",
         "flash fails", "power fails in store")
PLACES = ("each message", "each byte", "each slot")
ATTRIBUTE = "__rkm04_exploration__"  # of an explored test: its Options
START = 946_684_800.0  # time.time() at the beginning of each run: the same in all
_SLOT_US = 1000
_FLASH_OPERATIONS = 16  # of one Store Flash, at most, for which a fault is tried

Parameters = Tuple[Tuple[str, Union[str, int]], ...]


@dataclass(frozen=True)
class Fault:
    """A fault of one run: a kind of `fault.inject` (docs/FAULTS.md) with its parameters, or `reset` at a tick."""

    kind: str
    parameters: Parameters = ()
    place: str = ""  # in words
    bus: int = 0  # which bus of the test, in the order in which they are made

    def __str__(self) -> str:
        words = [self.kind, *(f"{name}={value}" for name, value in self.parameters)]
        return " ".join(words + ([f"bus={self.bus}"] if self.bus else []))

    @property
    def values(self) -> Dict[str, Union[str, int]]:
        """The parameters as a dictionary."""
        return dict(self.parameters)


def fault(kind: str, place: str = "", **parameters: Union[str, int]) -> Fault:
    """A fault with its parameters."""
    return Fault(kind, tuple(parameters.items()), place)


def format_faults(faults: Sequence[Fault]) -> str:
    """The faults of a run as the value of RKM04_REPLAY."""
    return "; ".join(str(each) for each in faults) or "none"


def parse_faults(text: str) -> List[Fault]:
    """The faults of a run from the value of RKM04_REPLAY. Raises ValueError."""
    faults = []
    for part in text.split(";"):
        words = part.split()
        if words in ([], ["none"]):
            continue
        values: Dict[str, Union[str, int]] = {}
        for word in words[1:]:
            name, equals, value = word.partition("=")
            if not equals:
                raise ValueError(f"{REPLAY}: {word!r}: expected NAME=VALUE, as in `no_answer skip=2 count=1'")
            values[name] = int(value) if value.isdigit() else value
        number = values.pop("bus", 0)
        faults.append(Fault(words[0], tuple(values.items()), bus=int(number)))
    return faults


@dataclass(frozen=True)
class Passed:
    """A message that passed on a bus in the first run."""

    begin: int  # tick of its first bit
    end: int  # tick of its last bit
    length: int  # bytes on the wires
    from_host: bool
    text: str  # in words


@dataclass
class Facts:
    """What the first run shows of one bus."""

    messages: List[Passed] = field(default_factory=list)
    end: int = 0  # tick at which the test ended
    inputs: Sequence[int] = tuple(range(1, 9))


@dataclass
class Options:
    """What to explore."""

    faults: Sequence[Union[str, Dict[str, Any]]] = ("lost byte", "flipped bit", "late answer", "no answer")
    at: str = "each message"
    budget: int = 200
    pairs: bool = False
    late: Union[str, int] = "1s"
    inputs: Sequence[int] = ()
    seed: int = 1
    limit: Union[str, int] = "3600s"

    def __post_init__(self) -> None:
        for name in ("late", "limit"):
            try:
                to_us(getattr(self, name))
            except (TypeError, ValueError) as error:
                raise ValueError(f"{name}: {error}") from None
        for kind in self.faults:
            if not isinstance(kind, str):
                _check_fault(kind)
            elif kind not in KINDS:
                raise ValueError(f"faults: {kind!r}: expected one of {', '.join(KINDS)}, or a dictionary for fault.inject")
        if self.at not in PLACES:
            raise ValueError(f"at: {self.at!r}: expected one of {', '.join(PLACES)}")
        if self.budget < 1:
            raise ValueError(f"budget: {self.budget}: expected at least 1 run")
        if "input flickers" in self.faults and not self.inputs:
            raise ValueError("inputs: expected the inputs that flicker, as in inputs=[1, 3]")


def _check_fault(fault: Dict[str, Any]) -> None:
    """Raises ValueError if `fault.inject` refuses it; otherwise each run would fail."""
    from . import Bus

    if "kind" not in fault:
        raise ValueError(f"faults: {fault!r}: expected a kind of fault.inject in it")
    if "unit" in fault:
        return  # the test says which units there are
    with Bus() as bus:
        try:
            bus.call("fault.inject", **fault)
        except RefusedError as error:
            raise ValueError(f"faults: {error}") from None


# ---- The places --------------------------------------------------------------------------------------------------------------


def _bytes_of(options: Options, facts: Facts, from_host: bool) -> Iterator[Tuple[int, str]]:
    """(number of the byte in its direction, where that is)."""
    before = 0
    for message in facts.messages:
        if message.from_host == from_host:
            chosen = range(message.length) if options.at == "each byte" else [message.length // 2]
            for number in chosen:
                yield before + number, f"byte {number + 1} of {message.length} of {message.text}"
            before += message.length


def _moments(options: Options, facts: Facts) -> Iterator[Tuple[int, str]]:
    """(tick, when that is) for faults that do not belong to a byte."""
    if options.at == "each slot":
        for tick in range(_SLOT_US, facts.end, _SLOT_US):
            yield tick, f"tick {tick}"
    else:
        for message in facts.messages:
            yield message.end + 1, f"after {message.text}"


def _faults_of_kind(kind: str, options: Options, facts: Facts) -> Iterator[Fault]:
    answers = [message for message in facts.messages if not message.from_host]
    if kind in ("lost byte", "flipped bit"):
        for from_host in (True, False):
            for number, place in _bytes_of(options, facts, from_host):
                direction = "to_units" if from_host else "to_master"
                if kind == "lost byte":
                    yield fault("drop", f"{place} is lost", direction=direction, skip=number, count=1)
                else:
                    yield fault("flip", f"a bit of {place} is flipped", direction=direction, mask=1 << number % 8, skip=number,
                                count=1)
    elif kind in ("late answer", "no answer", "wrong check value"):
        for number, message in enumerate(answers):
            if kind == "late answer":
                yield fault("delay", f"{message.text} is late by {options.late}", delay=options.late, skip=number, count=1)
            elif kind == "no answer":
                yield fault("no_answer", f"{message.text} is not sent", skip=number, count=1)
            else:
                yield fault("wrong_fcs", f"{message.text} has a wrong check value", skip=number, count=1)
    elif kind == "power cycle":
        for tick, place in _moments(options, facts):
            yield fault("reset", f"the power fails {place}", at=tick)
    elif kind == "input flickers":
        for tick, place in _moments(options, facts):
            for number in options.inputs:
                for level in (0, 1):
                    yield fault("input", f"input {number:02d} is {level} for 5 ms {place}", input=number, level=level, after=tick,
                                duration="5ms", count=1)
    elif any("Store Flash" in message.text for message in facts.messages):
        stores = sum(message.from_host and "Store Flash" in message.text for message in facts.messages)
        for number in range(_FLASH_OPERATIONS * stores):
            if kind == "flash fails":
                yield fault("flash", f"flash operation {number + 1} fails", operation="write", skip=number, count=1)
            else:
                yield fault("power", f"the power fails in flash operation {number + 1}", operation=number + 1, duration="1s")


def places(options: Options, facts: Sequence[Facts]) -> List[Fault]:
    """All faults that the options ask for, at all places that the first run showed; kinds take turns."""
    lists: List[List[Fault]] = []
    for number, bus in enumerate(facts):
        for kind in options.faults:
            if isinstance(kind, str):
                found = list(_faults_of_kind(kind, options, bus))
            else:
                answers = sum(not message.from_host for message in bus.messages)
                found = [fault(**{"skip": n, "count": 1, "place": f"opportunity {n + 1}", **kind}) for n in range(answers)]
            lists.append([Fault(each.kind, each.parameters, each.place, number) for each in found])
    return [each for turn in itertools.zip_longest(*lists) for each in turn if each is not None]


def thin(found: Sequence[Any], budget: int) -> List[Any]:
    """At most `budget` of them, evenly spread."""
    if len(found) <= budget:
        return list(found)
    return [found[number * len(found) // budget] for number in range(budget)]


def plan(options: Options, facts: Sequence[Facts]) -> Tuple[List[Tuple[Fault, ...]], int]:
    """(the runs, the number of runs that there are without a budget). Single faults come first."""
    single = places(options, facts)
    room = options.budget if not options.pairs else max(1, options.budget // 2, options.budget - len(single) ** 2)
    runs: List[Tuple[Fault, ...]] = [(each,) for each in thin(single, room)]
    total = len(single)
    if options.pairs:
        total += len(single) * (len(single) - 1) // 2
        rest = options.budget - len(runs)
        pairs: List[Tuple[Fault, ...]] = list(itertools.combinations(single, 2)) if len(single) <= 2000 else []
        if len(pairs) > rest:
            pairs = random.Random(options.seed).sample(pairs, max(0, rest))
        runs += pairs
    return runs, total


# ---- The runs ----------------------------------------------------------------------------------------------------------------


@dataclass
class Run:
    """One run of the test. `failure`: what failed, in words; None: passed. `facts`: of each bus. `details`: the runner's own."""

    faults: Tuple[Fault, ...]
    failure: Optional[str]
    facts: Sequence[Facts] = ()
    details: Any = None


@dataclass
class Exploration:
    """The result: `runs` done of `total` that there are; `failures` with the smallest sets of faults first."""

    runs: int = 0
    total: int = 0
    failures: List[Run] = field(default_factory=list)

    def __bool__(self) -> bool:
        return not self.failures

    def report(self, command: str) -> str:
        """The result in words. `command`: what runs the test, for the line that repeats the failing run."""
        head = f"{self.runs} runs with faults (of {self.total} possible): "
        if not self.failures:
            return head + "all passed"
        first = self.failures[0]
        lines = [head + f"{len(self.failures)} failed", f"smallest set of faults under which the test fails: {len(first.faults)}"]
        lines += [f"  - {each.place or each}" for each in first.faults]
        lines += [f"fails with: {first.failure}", "repeat exactly this run:"]
        lines += ["  " + _system.command_with(REPLAY, format_faults(first.faults), command)]
        others = self.failures[1:]
        if others:
            lines.append("it also fails with:")
            lines += ["  - " + " and ".join(each.place or str(each) for each in run.faults) for run in others[:10]]
            if len(others) > 10:
                lines.append(f"  and in {len(others) - 10} more runs")
        return "\n".join(lines)


class Progress:
    """A line on a terminal that shows how far the exploration is; nothing elsewhere."""

    def __init__(self, name: str, stream: Any = None) -> None:
        self._name = name
        self._stream = sys.stderr if stream is None else stream
        self._on = bool(getattr(self._stream, "isatty", lambda: False)()) and "PYTEST_XDIST_WORKER" not in os.environ

    def show(self, done: int, total: int, failed: int) -> None:
        """Show that `done` of `total` runs are done, and `failed` have failed."""
        if self._on and total:
            filled = 24 * done // total
            self._stream.write(f"\r{self._name}: [{'#' * filled:<24}] {done}/{total} runs, {failed} failed ")
            self._stream.flush()

    def end(self) -> None:
        """Clear the line."""
        if self._on:
            self._stream.write("\r\033[K")
            self._stream.flush()


def share(runs: Sequence[Any], part: Tuple[int, int]) -> List[Any]:
    """The runs of part `part[0]` (from 0 on) of `part[1]`."""
    return list(runs[part[0]::part[1]])


def explore_runs(run: Callable[[Tuple[Fault, ...]], Run], first: Run, options: Options, progress: Progress,
                 part: Tuple[int, int] = (0, 1)) -> Exploration:
    """Do the runs. `first`: the one without faults. `run`: runs the test with these faults."""
    runs, total = plan(options, first.facts)
    runs = share(runs, part)
    result = Exploration(total=total)
    for faults in runs:
        done = run(faults)
        result.runs += 1
        if done.failure is not None:
            result.failures.append(_smallest(run, done))
        progress.show(result.runs, len(runs), len(result.failures))
    progress.end()
    result.failures.sort(key=lambda failed: len(failed.faults))
    return result


def _smallest(run: Callable[[Tuple[Fault, ...]], Run], failed: Run) -> Run:
    """The same failure with fewer faults, if one alone does it."""
    if len(failed.faults) > 1:
        for each in failed.faults:
            alone = run((each,))
            if alone.failure is not None:
                return alone
    return failed


# ---- What a run does to a bus that is made in it -----------------------------------------------------------------------------


class Session:
    """The buses of the run under way, and the faults that they get when they are made."""

    def __init__(self, faults: Sequence[Fault], limit: Union[str, int], keeps: bool) -> None:
        self.faults = faults
        self.limit = to_us(limit)
        self.keeps = keeps  # the report of a failure is wanted in full
        self.buses: List[Any] = []
        self.learned: List[Facts] = []

    def prepare(self, bus: Any) -> None:
        """Inject the faults of this run into a bus that has just been made."""
        mine = [each for each in self.faults if each.bus == len(self.buses)]
        self.buses.append(bus)
        clock_of(bus).limit = clock_of(bus).now + self.limit
        before: Dict[Tuple[str, Any], int] = {}
        for each in sorted(mine, key=lambda each: int(each.values.get("skip", 0))):
            values = each.values
            if each.kind == "reset":
                schedule_reset(bus, int(values["at"]))
                continue
            if "skip" in values:  # an opportunity that another fault of the kind takes is not seen by this one
                rival = (each.kind, values.get("direction"))
                values["skip"] = int(values["skip"]) - before.get(rival, 0)
                before[rival] = before.get(rival, 0) + 1
            bus.call("fault.inject", kind=each.kind, **values)

    def learn(self) -> None:
        """Keep what the run has shown, before its buses end."""
        self.learned = [facts_of(bus) for bus in self.buses]


_session: Optional[Session] = None


def begin_session(faults: Sequence[Fault], limit: Union[str, int], keeps: bool = False) -> Session:
    """From now on, buses that are made belong to this run."""
    global _session
    _session = Session(faults, limit, keeps)
    return _session


def session() -> Optional[Session]:
    """The run under way; None: no exploration."""
    return _session


def end_session() -> None:
    """The run is over."""
    global _session
    _session = None


def bus_made(bus: Any) -> None:
    """Called for each bus that is made for a test."""
    if _session is not None:
        _session.prepare(bus)


# ---- What a run has shown ----------------------------------------------------------------------------------------------------


def facts_of(bus: Any) -> Facts:
    """What the first run shows of a bus."""
    events = sorted(((event, exchange.device) for exchange in bus.dialogue for event in exchange.events),
                    key=lambda each: int(each[0]["start_us"]))
    requests = answers = 0
    messages = []
    for event, device in events:
        data = bytes.fromhex(event["message"])
        words = Message(data, event["answer"], device).words if data else "a broken frame"
        if event["answer"]:
            answers += 1
            text = f"answer {answers} ({words})"
        else:
            requests += 1
            text = f"request {requests} ({words})"
        messages.append(Passed(int(event["start_us"]), int(event["t_us"]), len(event["bytes"]) // 2, not event["answer"], text))
    return Facts(messages, bus.now)


def schedule_reset(bus: Any, tick: int) -> None:
    """Switch the power of all units off and on when the program under test waits at this tick or later."""
    clock_of(bus).schedule(tick, lambda: [unit.power.cycle() for unit in bus.units])


# ---- For programs ------------------------------------------------------------------------------------------------------------


class ExplorationFailed(AssertionError):
    """A test fails under a set of faults. `exploration` has all results."""

    def __init__(self, exploration: Exploration, text: str) -> None:
        super().__init__(text)
        self.exploration = exploration


Test = TypeVar("Test", bound=Callable[..., Any])


def explore(test: Optional[Callable[..., Any]] = None, *, faults: Sequence[Union[str, Dict[str, Any]]] = Options.faults,
            at: str = "each message", budget: int = 200, pairs: bool = False, late: Union[str, int] = "1s",
            inputs: Sequence[int] = (), seed: int = 1, limit: Union[str, int] = "3600s",
            bus: Optional[Callable[[], Any]] = None) -> Any:
    """Run a test again and again, each time with one fault at another place, and report the smallest set of faults under which
    it fails.

    As a decorator, `@rkm04.explore(...)`, of a test of pytest that uses the fixtures `rkm04_bus`, `rkm04_port`, `rkm04_time`. As
    a function, `rkm04.explore(test, ...)`, of a function `test(bus)`: returns an Exploration, raises ExplorationFailed.

    faults: kinds: "lost byte", "flipped bit", "late answer", "no answer", "wrong check value", "power cycle", "input flickers",
        "flash fails", "power fails in store"; or dictionaries of parameters of `fault.inject`, to which skip is added.
    at: "each message" (a byte in its middle; power and inputs: after it), "each byte", "each slot" (power and inputs: each ms).
    budget: the number of runs, 1 or more; more places than that are thinned out evenly.
    pairs: also two faults at a time, within the budget.
    late: by how much an answer is late: µs, or a string with a unit.
    inputs: the inputs that flicker, 1 to 8.
    seed: for the choice of pairs.
    limit: virtual time after which a run that still waits fails: µs, or a string with a unit.
    bus: makes the bus of each run of a function; None: `Bus()`.
    """
    if isinstance(faults, str):
        raise ValueError(f"faults: expected a list of kinds, as in [{faults!r}]")
    options = Options(tuple(faults), at, budget, pairs, late, tuple(inputs), seed, limit)
    if test is None:
        def mark(function: Test) -> Test:
            setattr(function, ATTRIBUTE, options)
            return function

        return mark
    return _explore_function(test, options, bus)


def _explore_function(test: Callable[..., Any], options: Options, make: Optional[Callable[[], Any]]) -> Exploration:
    from . import Bus
    from ._virtual_time import virtual_time

    def run(faults: Tuple[Fault, ...]) -> Run:
        session = begin_session(faults, options.limit)
        line = (make or Bus)()
        try:
            bus_made(line)
            with virtual_time(line, start=START):
                test(line)
            failure = None
        except Exception as error:  # whatever a test fails with
            if not faults:
                raise
            failure = f"{type(error).__name__}: {error}".splitlines()[0]
        finally:
            if not faults:
                session.learn()
            end_session()
            line.close()
        return Run(faults, failure, session.learned)

    name = getattr(test, "__name__", "test")
    replay = os.environ.get(REPLAY)
    if replay is not None:
        done = run(tuple(parse_faults(replay)))
        result = Exploration(runs=1, total=1, failures=[done] if done.failure else [])
    else:
        result = explore_runs(run, run(()), options, Progress(name))
    if not result:
        raise ExplorationFailed(result, result.report(f"python {sys.argv[0]}"))
    return result
