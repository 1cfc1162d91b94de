# SPDX-License-Identifier: MIT
"""Nothing is left of a bus that is closed."""

import gc
import os
import sys
import tracemalloc
import weakref

import rkm04

BUSES = 10_000
WARM = 500
SANITIZED = bool(os.environ.get("RKM04_SANITIZER"))
"""A sanitizer keeps what is freed in a quarantine: the memory of the process says nothing."""


def use_bus():
    with rkm04.Bus(units="1,2") as bus:
        bus.unit(1).motor(1).set("F10 R")
        bus.faults.inject("no_answer", count=1)
        bus.snapshot()
        with bus.events("step") as steps:
            bus.advance("20ms")
        assert list(steps) and len(bus.dialogue) == 1


def resident():
    if sys.platform == "win32":
        return private_bytes()
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def private_bytes():
    """Memory of this process alone, as Windows counts it."""
    import ctypes
    from ctypes import wintypes

    class Counters(ctypes.Structure):
        _fields_ = [("size", wintypes.DWORD), ("faults", wintypes.DWORD)] + [
            (name, ctypes.c_size_t) for name in ("peak", "working_set", "peak_paged", "paged", "peak_pool", "pool", "pagefile",
                                                 "peak_pagefile", "private")]

    counters = Counters(size=ctypes.sizeof(Counters))
    library = ctypes.WinDLL("kernel32", use_last_error=True)
    library.K32GetProcessMemoryInfo.argtypes = [wintypes.HANDLE, ctypes.c_void_p, wintypes.DWORD]
    assert library.K32GetProcessMemoryInfo(wintypes.HANDLE(-1), ctypes.byref(counters), counters.size)
    return counters.pagefile


def test_ten_thousand_buses_leave_no_memory():
    buses = BUSES // 20 if SANITIZED else BUSES // 5 if sys.platform == "win32" else BUSES
    for _ in range(WARM):
        use_bus()
    gc.collect()
    tracemalloc.start()
    for _ in range(10):
        use_bus()
    gc.collect()
    before, rss = tracemalloc.get_traced_memory()[0], resident()
    tracemalloc.stop()
    for _ in range(buses):
        use_bus()
    gc.collect()
    if not SANITIZED:
        assert resident() - rss < 2 << 20, "memory of the process grows"
    tracemalloc.start()
    for _ in range(10):
        use_bus()
    gc.collect()
    assert tracemalloc.get_traced_memory()[0] - before < 10_000
    tracemalloc.stop()


def test_a_bus_that_nobody_closes_is_freed_too():
    for _ in range(WARM):
        rkm04.Bus().unit(1)
    gc.collect()
    before = resident()
    for _ in range(2 * WARM):
        rkm04.Bus(units="1-16").unit(1)
    gc.collect()
    if not SANITIZED:
        assert resident() - before < 8 << 20


def test_a_bus_is_freed_when_nobody_has_it_any_more():
    gc.collect()
    gc.disable()
    try:
        bus = weakref.ref(rkm04.Bus())
        assert bus() is None
        unit = weakref.ref(rkm04.Bus(units="1-16").unit(1))
        assert unit() is None
    finally:
        gc.enable()
