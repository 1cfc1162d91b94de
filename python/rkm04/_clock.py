# SPDX-License-Identifier: MIT
"""How the threads of a program wait for the virtual time of a bus.

A `Clock` belongs to one bus. Whoever waits (a read of a port, `time.sleep` under `virtual_time()`) calls `wait()`. When every
thread of the program waits, the thread that waits last lets the bus go on to the next byte or the nearest time limit, whichever
comes first. A thread that computes holds time; a thread that is blocked in something else (a lock, a join, a queue written in
C) does not.
"""
from __future__ import annotations

import sys
import threading
import time
from _thread import allocate_lock, get_ident
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Tuple, TypeVar

from ._errors import BusyError, Error

if TYPE_CHECKING:
    from ._bus import Bus
    from ._sim import Sim

Result = TypeVar("Result")
REAL_SLEEP = time.sleep
REAL_MONOTONIC = time.monotonic

_LONG_US = 60_000_000  # a step without a limit, as long as the bus is not idle
_LONG_STEPS = 100_000  # of these, at most
_FREE_LOOKS = 100  # calls that ask the port or the time, without a wait between them, that take no time
_LOOK_US = 100  # what each further one takes
_NAP = 0.0003  # real seconds after which a thread that has done nothing counts as blocked
PATIENCE = 2.0  # real seconds in which a thread that is blocked elsewhere must go on, when all others wait without limit


class NothingToCome(Error):
    """Somebody waits without a time limit for something that cannot come: no byte is under way, and no thread can send one."""

    __module__ = "rkm04"


class TimeLimitError(Error):
    """The program under test has waited for longer than the limit of virtual time."""

    __module__ = "rkm04"


class _Waiter:
    """A thread that waits: until when (None: without limit), for what, and what it has been told."""

    __slots__ = ("deadline", "ready", "lock", "woken", "error")

    def __init__(self, deadline: Optional[int], ready: Callable[[], bool]) -> None:
        self.deadline = deadline
        self.ready = ready
        self.lock = allocate_lock()
        self.lock.acquire()
        self.woken = False
        self.error: Optional[str] = None


def _when_free(call: Callable[[], Result]) -> Result:
    """Do this when the test, in another thread, does not use the bus itself (Bus.advance() of a long time)."""
    while True:
        REAL_SLEEP(_NAP)
        try:
            return call()
        except BusyError:
            pass


class Clock:
    """Virtual time in µs, of a bus or, as long as there is none, of a counter."""

    def __init__(self, bus: Optional[Bus] = None) -> None:
        self._sim: Optional[Sim] = None
        self.port: Optional[Callable[[], Any]] = None  # a weak reference to the port that is open onto the bus
        self.input = bytearray()  # bytes that the host has received and the port has not read
        self.last_byte = 0  # time at which the last of them came
        self.on_input: Optional[Callable[[], Any]] = None  # a weak reference to who is told when `input` has become longer
        self.limit: Optional[int] = None  # time after which whoever waits gets TimeLimitError
        self._base = 0
        self._looks = 0
        self._agenda: List[Tuple[int, Callable[[], Any]]] = []
        self._gate = threading.RLock()  # one thread at a time uses the bus
        self._waiters: Dict[int, _Waiter] = {}
        self._members = {get_ident()}
        self._strangers = {thread.ident for thread in threading.enumerate()} - {get_ident()}
        if bus is not None:
            self.attach(bus)

    def attach(self, bus: Bus) -> None:
        """Go by this bus from now on."""
        if self._sim is not None:
            raise RuntimeError("virtual time goes by one bus: expected no second one")
        self._sim = bus.simulation
        self._base -= bus.now

    @property
    def has_bus(self) -> bool:
        """Does it go by a bus?"""
        return self._sim is not None

    @property
    def now(self) -> int:
        """The time in µs."""
        sim = self._sim
        if sim is None:
            return self._base
        try:
            return self._base + sim.now()
        except BusyError:
            return self._base + _when_free(sim.now)

    def at(self, tick: int) -> int:
        """The time of a tick of the bus."""
        return self._base + tick

    @property
    def gate(self) -> Any:
        """The lock that a thread holds while it uses the bus."""
        return self._gate

    def look(self) -> None:
        """Note that the program asks the port or the time. Programs that ask again and again without waiting would never
        end if that took no time."""
        self._looks += 1
        if self._looks > _FREE_LOOKS:
            with self._gate:
                self._pass(_LOOK_US)

    def begin_looking(self) -> None:
        """Note that the program has got something: looks count anew."""
        self._looks = 0

    def receive(self) -> int:
        """Take what the host has received into `input`; return its length."""
        sim = self._sim
        if sim is not None:
            try:
                came = sim.read(-1)
            except BusyError:
                came = _when_free(lambda: sim.read(-1))
            if came:
                self.input += came
                self.last_byte = self.now
                tell = None if self.on_input is None else self.on_input()
                if tell is not None:
                    tell()
        return len(self.input)

    def wait(self, deadline: Optional[int], ready: Callable[[], bool], what: str = "a wait", count: int = 1,
             stop: int = -1) -> bool:
        """Wait until `ready()` or `deadline` (µs; None: no limit). Returns `ready()`. Raises NothingToCome, TimeLimitError.

        count, stop: `ready()` does not hold before so many bytes have come, or the byte `stop` has.
        """
        self._looks = 0
        if self.limit is not None and self.now >= self.limit:
            raise TimeLimitError(f"{what} after the limit of virtual time: expected that the program ends before "
                                 f"{self.limit / 1e6:g} s")
        if self._is_alone():
            return self._wait_alone(deadline, ready, what, count, stop)
        return self._wait_with_others(deadline, ready, what)

    # ---- One thread ----

    def _is_alone(self) -> bool:
        if threading.active_count() == 1:
            return True
        me = get_ident()
        if me not in self._members:
            self._members.add(me)
        return not self._others(me)

    def _others(self, me: int) -> List[threading.Thread]:
        """The other threads of the program: not those that were there before and never waited."""
        members, strangers = self._members, self._strangers
        return [thread for thread in threading.enumerate()
                if thread.ident != me and (thread.ident in members or thread.ident not in strangers)]

    def _wait_alone(self, deadline: Optional[int], ready: Callable[[], bool], what: str, count: int, stop: int) -> bool:
        with self._gate:
            self.receive()
            had = len(self.input)
            while not ready():
                missing = max(1, count + had - len(self.input))
                if deadline is None:
                    if not self._step_freely(missing, stop) and not ready():
                        raise NothingToCome(_explain(what))
                else:
                    left = deadline - self.now
                    if left <= 0:
                        return False
                    self._pass(left, missing, stop)
        return True

    def _step_freely(self, count: int = 1, stop: int = -1) -> bool:
        """Let time pass until bytes have come, or none can come. Returns whether they have."""
        for _ in range(_LONG_STEPS):
            if self._sim is None or self.port is None or self._sim.is_idle():
                return False
            if self._pass(_LONG_US, count, stop):
                return True
        return False

    def schedule(self, tick: int, action: Callable[[], Any]) -> None:
        """Do something when time has come to this tick of the bus."""
        self._agenda.append((self.at(tick), action))
        self._agenda.sort(key=lambda entry: entry[0])

    def _pass(self, ticks: int, count: int = 1, stop: int = -1) -> bool:
        """Let time pass by `ticks`, or until `count` bytes or the byte `stop` have come. Returns whether bytes have."""
        if self._agenda:
            due, action = self._agenda[0]
            left = due - self.now
            if left < ticks:
                if left > 0 and self._pass_plainly(left, count, stop):
                    return True
                del self._agenda[0]
                action()
                return False
        return self._pass_plainly(ticks, count, stop)

    def _pass_plainly(self, ticks: int, count: int, stop: int) -> bool:
        sim = self._sim
        if sim is None:
            self._base += ticks
            return False
        if self.port is None:
            sim.advance(sim.now() + ticks)
            return False
        came = sim.wait_byte(sim.now() + ticks, count, stop)
        if came:
            self.receive()
        return came

    # ---- Several threads ----

    def _wait_with_others(self, deadline: Optional[int], ready: Callable[[], bool], what: str) -> bool:
        me = get_ident()
        waiter = _Waiter(deadline, ready)
        start = REAL_MONOTONIC()
        nap = 0.0002
        with self._gate:
            self._members.add(me)
            self.receive()
            self._waiters[me] = waiter
        try:
            while True:
                with self._gate:
                    if waiter.error is not None:
                        raise NothingToCome(waiter.error)
                    if ready():
                        return True
                    if deadline is not None and self.now >= deadline:
                        return False
                    if waiter.woken:  # somebody else has taken what this one was woken for
                        waiter.woken = False
                        self._waiters[me] = waiter
                    if not self._wake_due(me) and self._all_wait(me):
                        if self._go_on(what, REAL_MONOTONIC() - start):
                            start, nap = REAL_MONOTONIC(), 0.0002
                            continue
                if waiter.lock.acquire(timeout=nap):
                    nap = 0.0002
                else:
                    nap = min(2 * nap, 0.005)
        finally:
            with self._gate:
                self._waiters.pop(me, None)

    def _wake_due(self, me: int) -> bool:
        """Wake every other thread whose wait is over. Returns whether one was, or has been and does not run yet."""
        found = False
        for ident, waiter in self._waiters.items():
            if ident == me:
                continue
            if waiter.woken or waiter.error is not None:
                found = True
            elif waiter.ready() or (waiter.deadline is not None and self.now >= waiter.deadline):
                waiter.woken = True
                waiter.lock.release()
                found = True
        return found

    def _go_on(self, what: str, waited: float) -> bool:
        """All threads wait: let time pass to the nearest limit. Returns False if there is none, and nothing comes, but a thread
        that is blocked elsewhere may still go on."""
        limits = [waiter.deadline for waiter in self._waiters.values() if waiter.deadline is not None]
        if limits:
            self._pass(min(limits) - self.now)
            return True
        if self._step_freely():
            return True
        if self._outside(get_ident()) and waited < PATIENCE:
            return False
        if any(waiter.ready() for waiter in self._waiters.values()):
            return True  # the last thread has done it and ended since
        for waiter in self._waiters.values():
            waiter.error = _explain(what)
            if waiter.lock.locked():
                waiter.lock.release()
        return True

    def _outside(self, me: int) -> List[threading.Thread]:
        return [thread for thread in self._others(me) if thread.ident not in self._waiters]

    def _all_wait(self, me: int) -> bool:
        """Does every thread of the program wait, here or elsewhere?"""
        outside = self._outside(me)
        if not outside:
            return True
        before = _places(outside)
        if before is None:
            return False
        self._gate.release()
        try:
            REAL_SLEEP(_NAP)
        finally:
            self._gate.acquire()
        after = _places(self._outside(me))
        return after == before and not any(_runs(thread) for thread in outside) and not self._wake_due(me)


def _explain(what: str) -> str:
    limit = "" if "timeout=None" in what else " without a time limit"
    return (f"{what}{limit} would never end: no byte is under way to the host, no thread of the program is left "
            "that could send a request, and units do not send unasked")


def _places(threads: List[threading.Thread]) -> Optional[Dict[int, object]]:
    """Where each thread is in its code; None: one has not begun yet."""
    frames = sys._current_frames()
    places: Dict[int, object] = {}
    for thread in threads:
        if thread.ident is None:
            return None
        frame = frames.get(thread.ident)
        places[thread.ident] = (id(frame), frame.f_lasti if frame is not None else -1)
    return places


def _runs(thread: threading.Thread) -> bool:
    """Does the system say that the thread has work to do? (Linux; elsewhere its place in the code has to do.)"""
    try:
        with open(f"/proc/self/task/{thread.native_id}/stat", "rb") as file:
            return file.read().rpartition(b")")[2].split()[0] == b"R"
    except OSError:
        return False

