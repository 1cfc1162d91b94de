# SPDX-License-Identifier: MIT
"""What a bus in this process costs; one JSON object a line, with the limit that each figure has to keep.

    PYTHONPATH=build/release/python python3 python/bench/bench_bus.py [--check]

Times are real, in us, the least of several rounds, so that other work on the machine counts little. --check: exit status 1 if a
figure is above its limit.
"""
from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from typing import Callable, List

import rkm04

ROUNDS = 7
VERSION = rkm04.request("Version")


def least(call: Callable[[], object], number: int) -> float:
    """us of a call."""
    best = float("inf")
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for _ in range(number):
            call()
        best = min(best, (time.perf_counter() - begin) / number)
    return best * 1e6


def python_cpu(code: str) -> float:
    """us of processor time of a Python that runs the code."""
    best = float("inf")
    for _ in range(ROUNDS):
        before = os.times()
        subprocess.run([sys.executable, "-c", code], check=True)
        after = os.times()
        best = min(best, after.children_user - before.children_user + after.children_system - before.children_system)
    return best * 1e6


def use_bus(units: str) -> Callable[[], object]:
    def call() -> None:
        rkm04.Bus(units=units).close()

    return call


def main() -> int:
    bus = rkm04.Bus()
    motor = bus.unit(1).motor(1)
    figures = [
        ("import rkm04", python_cpu("import rkm04") - python_cpu(""), 60_000),
        ("fresh bus, 1 unit", least(use_bus("1"), 100), 200),
        ("fresh bus, 16 units", least(use_bus("1-16"), 20), 200),
        ("advance 1 ms", least(lambda: bus.advance("1ms"), 1000), 5),
        ("request and answer", least(lambda: bus.exchange(1, VERSION), 200), 60),
        ("position of a motor", least(lambda: motor.position, 1000), 5),
        ("state of a unit", least(lambda: bus.unit(1).state, 100), None),
    ]
    above: List[str] = []
    for name, us, limit in figures:
        print(json.dumps({"bench": name, "us": round(us, 2), "limit_us": limit}), flush=True)
        if limit is not None and us > limit:
            above.append(name)
    return 1 if "--check" in sys.argv[1:] and above else 0


if __name__ == "__main__":
    sys.exit(main())
