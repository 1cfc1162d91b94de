# SPDX-License-Identifier: MIT
"""`virtual_time()`: the time functions of the program under test go by the bus.

Functions of the module `time`, waits of `threading` and the selectors under asyncio's event loops are replaced while the context
lasts, also where a module has them under a name of its own (`from time import sleep`). Modules of the test machinery, and those
that wait for real processes, keep real time.
"""
from __future__ import annotations

import selectors
import sys
import threading
import time
from _thread import allocate_lock
from contextlib import contextmanager
from types import ModuleType
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

from serial.serialutil import Timeout

from . import _system
from ._clock import Clock
from ._time import Time, to_us

_REAL_TIME = ("_pytest", "pytest", "pluggy", "xdist", "execnet", "rkm04", "subprocess", "multiprocessing", "concurrent",
              "debugpy", "_pydevd_bundle", "pydevd", "faulthandler", "pdb", "bdb", "coverage", "importlib")
_NAMES = ("sleep", "time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns")
_REAL: Dict[str, Callable[..., Any]] = {name: getattr(time, name) for name in _NAMES}
_REAL_CONDITION_WAIT = threading.Condition.wait
_SELECTORS: List[Any] = list({
    next(base for base in getattr(selectors, name).__mro__ if "select" in vars(base)): None
    for name in ("SelectSelector", "PollSelector", "EpollSelector", "KqueueSelector") if hasattr(selectors, name)}) + \
    _system.SELECTORS
_REAL_SELECT = {kind: kind.__dict__["select"] for kind in _SELECTORS}

_active: Optional["VirtualTime"] = None
_modules = 0  # how many there were at the last search
_searched: Dict[str, Tuple[int, int]] = {}  # modules that have been searched: identity and size
_places: List[Tuple[ModuleType, str, str]] = []  # where a module has a function under a name of its own


class VirtualTime:
    """Virtual time that is in force. `now` is in seconds since the context was entered."""

    def __init__(self, clock: Clock, start: Optional[float]) -> None:
        self.clock = clock
        self.begin = clock.now
        self.origin = {"time": int(_REAL["time_ns"]() if start is None else start * 1e9),
                       "monotonic": int(_REAL["monotonic_ns"]()), "perf_counter": int(_REAL["perf_counter_ns"]())}

    @property
    def now(self) -> float:
        """Seconds of virtual time since the context was entered."""
        return (self.clock.now - self.begin) / 1e6

    def reading(self, name: str) -> int:
        """The time of a clock of the module `time`, in ns."""
        self.clock.look()
        return self.origin[name] + (self.clock.now - self.begin) * 1000

    def sleep(self, seconds: float) -> None:
        """Let `seconds` of virtual time pass for this thread."""
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if seconds == 0:
            self.clock.look()
        else:
            self.clock.wait(self.clock.now + ticks(seconds), _never, "time.sleep()")


def ticks(seconds: float) -> int:
    """Seconds as whole µs, at least one."""
    return max(1, round(seconds * 1e6))


def _never() -> bool:
    return False


def _here() -> Optional[VirtualTime]:
    """Virtual time, if it holds for the code that called the replaced function."""
    active = _active
    if active is None:
        return None
    name = sys._getframe(2).f_globals.get("__name__", "")
    return None if name.partition(".")[0] in _REAL_TIME else active


def _sleep(seconds: float) -> None:
    active = _here()
    if active is None:
        _REAL["sleep"](seconds)
    else:
        active.sleep(seconds)


def _clock_function(name: str, nanoseconds: bool) -> Callable[[], Any]:
    real = _REAL[name]
    plain = name[:-3] if nanoseconds else name

    def read() -> Any:
        active = _here()
        if active is None:
            return real()
        value = active.reading(plain)
        return value if nanoseconds else value / 1e9

    read.__name__ = read.__qualname__ = name
    read.__doc__ = real.__doc__
    return read


_VIRTUAL: Dict[str, Callable[..., Any]] = {
    name: _sleep if name == "sleep" else _clock_function(name, name.endswith("_ns")) for name in _NAMES}


def _condition_wait(self: Any, timeout: Optional[float] = None) -> bool:
    """As threading.Condition.wait(), in virtual time."""
    active = _active
    if active is None or sys._getframe(1).f_globals.get("__name__", "").partition(".")[0] in _REAL_TIME:
        return _REAL_CONDITION_WAIT(self, timeout)
    if not self._is_owned():
        raise RuntimeError("cannot wait on un-acquired lock")
    clock = active.clock
    waiter = allocate_lock()
    waiter.acquire()
    self._waiters.append(waiter)
    saved = self._release_save()
    got = False
    try:
        deadline = None if timeout is None else clock.now + (ticks(timeout) if timeout > 0 else 0)
        got = clock.wait(deadline, lambda: not waiter.locked(), "a wait of threading")
        return got
    finally:
        self._acquire_restore(saved)
        if not got:
            try:
                self._waiters.remove(waiter)
            except ValueError:
                pass


def _select_function(real: Callable[..., Any]) -> Callable[..., Any]:
    def select(self: Any, timeout: Optional[float] = None) -> Any:
        active = _here()
        if active is None:
            return real(self, timeout)
        clock = active.clock
        clock.receive()
        events = real(self, 0)
        if events or (timeout is not None and timeout <= 0):
            return events

        def ready() -> bool:
            nonlocal events
            events = real(self, 0)
            return bool(events)

        clock.wait(None if timeout is None else clock.now + ticks(timeout), ready, "a wait of the event loop")
        return events

    return select


_VIRTUAL_SELECT = {kind: _select_function(real) for kind, real in _REAL_SELECT.items()}


def _search() -> None:
    """Find the modules that have a function of `time` under a name of their own; only if there are new modules."""
    global _modules
    if _modules == len(sys.modules):
        return
    _modules = len(sys.modules)
    wanted = {id(function): name for name, function in _REAL.items()}
    for name, module in list(sys.modules.items()):
        if not isinstance(module, ModuleType) or module is time or name.partition(".")[0] in _REAL_TIME:
            continue
        attributes = vars(module)
        seen = (id(module), len(attributes))
        if _searched.get(name) != seen:
            _searched[name] = seen
            for attribute, value in list(attributes.items()):
                if id(value) in wanted and (module, attribute, wanted[id(value)]) not in _places:
                    _places.append((module, attribute, wanted[id(value)]))


def _replace() -> None:
    _search()
    for module, attribute, name in _places:
        if vars(module).get(attribute) is _REAL[name]:
            setattr(module, attribute, _VIRTUAL[name])
    for name in _NAMES:
        setattr(time, name, _VIRTUAL[name])
    setattr(Timeout, "TIME", staticmethod(_VIRTUAL["monotonic"]))
    setattr(threading.Condition, "wait", _condition_wait)
    for kind in _SELECTORS:
        kind.select = _VIRTUAL_SELECT[kind]


def _put_back() -> None:
    for module, attribute, name in _places:
        if vars(module).get(attribute) is _VIRTUAL[name]:
            setattr(module, attribute, _REAL[name])
    for name in _NAMES:
        setattr(time, name, _REAL[name])
    setattr(Timeout, "TIME", _REAL["monotonic"])
    setattr(threading.Condition, "wait", _REAL_CONDITION_WAIT)
    for kind in _SELECTORS:
        kind.select = _REAL_SELECT[kind]


def active_clock() -> Optional[Clock]:
    """The clock of the virtual time that is in force; None: real time."""
    return None if _active is None else _active.clock


@contextmanager
def virtual_time(bus: Any = None, *, start: Optional[float] = None, limit: Optional[Time] = "86400s") -> Iterator[VirtualTime]:
    """Let the time of the program under test be that of `bus`.

    While the context lasts, `time.sleep`, `time.time`, `time.monotonic`, `time.perf_counter` (and their `_ns`),
    `threading.Event.wait`, `Condition.wait` and what is built on them (`queue.Queue.get`, `Barrier`, `Semaphore`, `Timer`), and
    the event loops of asyncio go by virtual time. It passes only while the whole program waits, and then at once.

    bus: a `Bus`. None: the first bus that a port is opened on (`rkm04://...`); until then time is a counter.
    start: the value of `time.time()` at the beginning, seconds since 1970; None: the present one.
    limit: virtual time after which whoever waits gets TimeLimitError, so that a program which waits in vain comes to an end.
        None: no limit.

    The value of the context has `now`, the seconds of virtual time that have passed.
    """
    global _active
    if _active is not None:
        raise RuntimeError("virtual_time() is in force already: expected one context at a time")
    from ._ports import clock_of

    clock = Clock() if bus is None else clock_of(bus)
    _active = VirtualTime(clock, start)
    before = clock.limit
    if limit is not None and before is None:
        clock.limit = clock.now + to_us(limit)
    _replace()
    try:
        yield _active
    finally:
        clock.limit = before
        _active = None
        _put_back()
