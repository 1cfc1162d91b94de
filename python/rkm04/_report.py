# SPDX-License-Identifier: MIT
"""What the report of a failed test says of its buses."""
from __future__ import annotations

import difflib
import os
import re
from pathlib import Path
from typing import Any, Iterator, List, Optional, Tuple

from . import _system
from ._dialogue import Count, Dialogue
from ._errors import Error
from ._message import Message

_LINES = 60  # of a dialogue, at most: the last ones


def file_name(nodeid: str) -> str:
    """A file name for a test."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", nodeid).strip("-")[-120:]


def idle_faults(bus: Any) -> List[str]:
    """What to say of injected faults that have never acted. A bus that has been closed says nothing."""
    try:
        faults = bus.faults.list()
    except Error:
        return []
    return [f"injected fault {each['id']} ({each['kind']}) has never acted" for each in faults if each["acted"] == 0]


def sections(bus: Any, nodeid: str, directory: Path) -> Iterator[Tuple[str, str]]:
    """(title, text) of what is known of a bus. A bus that has been closed says nothing."""
    try:
        yield "dialogue", "\n".join(dialogue_lines(bus.dialogue)) or "nothing has passed on the bus"
        yield "units", "\n".join(_unit_lines(bus))
        faults = [_fault_line(each) for each in bus.faults.list()]
        if faults:
            yield "injected faults", "\n".join(faults)
        yield "recording", _keep_recording(bus, directory / f"{file_name(nodeid)}.record")
    except Error:
        return


def dialogue_lines(dialogue: Dialogue) -> List[str]:
    """A dialogue as in the log of --wire, the last lines of it."""
    events = sorted(((event, exchange.device) for exchange in dialogue for event in exchange.events),
                    key=lambda each: int(each[0]["t_us"]))
    lines = [_event_line(event, device) for event, device in events[-_LINES:]]
    if len(events) > _LINES:
        lines.insert(0, f"({len(events) - _LINES} earlier messages)")
    return lines


def _event_line(event: Any, device: str) -> str:
    sender = "+".join("host" if name == "master" else str(name) for name in event["from"])
    data = bytes.fromhex(event["message"])
    if event["dropped"] is not None and not data:
        what = f"dropped: {event['dropped']}"
    else:
        what = Message(data, event["answer"], device).words
        what += f"; dropped: {event['dropped']}" if event["dropped"] is not None else ""
    what += f"; refused: {event['refused']}" if event["refused"] is not None else ""
    receiver = "" if not data else " > host" if event["answer"] else f" > {event['dnode'] or 'all'}"
    raw = " ".join(re.findall("..", event["bytes"]))
    return f"{event['start_us']:>12} {event['t_us']:>12}  {sender + receiver:<12} {what} | {raw}"


def _unit_lines(bus: Any) -> Iterator[str]:
    for unit in bus.units:
        state = unit.state
        inputs = [number + 1 for number in range(8) if state["di"] >> number & 1]
        outputs = [number + 1 for number in range(8) if state["do"] >> number & 1]
        yield (f"unit {unit.name} at {state['t_us']} us: {'on' if state['powered'] else 'no power'}; "
               f"inputs on: {_numbers(inputs)}; outputs on: {_numbers(outputs)}")
        for motor in state["motors"]:
            true = "" if motor["true_position"] is None else f" (true position {motor['true_position']})"
            wait = "" if not motor["waits_for"] else f"; waits for {motor['waits_for']}"
            fault = "" if not motor["fault"] else f"; fault {motor['fault']}"
            command = "" if not motor["command"] else f" in {motor['command']} (command {motor['index']})"
            yield f"  motor {motor['motor']}: {motor['state']}{command} at {motor['position']}{true}{fault}{wait}"


def _numbers(numbers: List[int]) -> str:
    return " ".join(f"{number:02d}" for number in numbers) or "none"


def _fault_line(fault: Any) -> str:
    left_out = ("id", "kind", "skip", "state", "acted", "left", "probability", "from_us", "until_us")
    values = " ".join(f"{name}={value}" for name, value in fault.items() if name not in left_out and value is not None)
    return f"fault {fault['id']}: {fault['kind']}{' ' * bool(values)}{values}: {fault['state']}, has acted {fault['acted']} times"


def _keep_recording(bus: Any, path: Path) -> str:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        bus.snapshot(file=str(path), force=True)
    except (Error, OSError) as error:
        return f"not kept: {error}"
    try:
        near = os.path.relpath(path)
    except ValueError:  # on another drive of Windows
        near = ".."
    shown = str(path) if near.startswith("..") else near
    return f"{shown}\nrepeat it: rkm04 replay --wire bus.log --trace run.vcd {_system.quote(shown)}"


# ---- Assertions --------------------------------------------------------------------------------------------------------------


def explain(op: str, left: object, right: object) -> Optional[List[str]]:
    """Lines for a comparison that has failed; None: it has nothing to do with a dialogue."""
    for count in (left, right):
        if isinstance(count, Count):
            found = [f"  {line}" for line in dialogue_lines(count.found)] or ["  none"]
            return [f"{left!r} {op} {right!r}: exchanges with {count.what}, of {len(count.dialogue)} in all", *found]
    if isinstance(left, Dialogue) and isinstance(right, list) and op == "==":
        return ["the dialogue is another one", *_difference([each.words for each in left], [str(each) for each in right])]
    return None


def _difference(seen: List[str], expected: List[str]) -> List[str]:
    return [line.rstrip("\n") for line in difflib.ndiff(expected, seen) if not line.startswith("?")] + [
        "(-: expected, +: seen)"]
