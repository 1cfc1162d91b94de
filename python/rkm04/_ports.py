# SPDX-License-Identifier: MIT
"""Which bus a URL `rkm04://...` stands for."""
from __future__ import annotations

import itertools
from typing import Any, Callable, Dict, List, Optional, Tuple

from . import _virtual_time
from ._clock import Clock

FORM = "rkm04://NAME, or rkm04://?node=1&plant=FILE&framing=hdlc&seed=1&device=rkm04&echo=0"

_named: Dict[str, Any] = {}
_made: Dict[str, Any] = {}
_numbers = itertools.count(1)


def clock_of(bus: Any) -> Clock:
    """The clock of a bus: that of the virtual time in force if it has no bus yet, else one of its own."""
    known: Optional[Clock] = getattr(bus, "_clock", None)
    active = _virtual_time.active_clock()
    if active is not None and active is not known:
        if known is None and not active.has_bus:
            active.attach(bus)
            bus._clock = active
            return active
        raise RuntimeError("virtual_time() goes by another bus: expected one bus for the program under test; give it as "
                           "virtual_time(bus)")
    if known is None:
        known = Clock(bus)
        bus._clock = known
    return known


def publish(bus: Any, name: Optional[str] = None) -> str:
    """Let `serial_for_url("rkm04://NAME")` open a port onto `bus`. Without `name`: a name that no other bus has. Returns the
    URL. The name is free again after `unpublish()`, or when the bus is closed."""
    if name is None:
        name = f"bus{next(_numbers)}"
        while name in _named:
            name = f"bus{next(_numbers)}"
    elif not name or any(character in name for character in "/?#"):
        raise ValueError(f"name {name!r}: expected a name without /, ? and #")
    if _named.get(name, bus) is not bus:
        raise ValueError(f"name {name!r}: another bus has it")
    _named[name] = bus
    return f"rkm04://{name}"


def unpublish(name: str) -> None:
    """Forget the name of a bus, given as name or as URL."""
    _named.pop(name[len("rkm04://"):] if name.startswith("rkm04://") else name, None)


def forget(bus: Any) -> None:
    """Forget a bus that is closed: its names are free again, and its URL makes a new one."""
    for known in (_named, _made):
        for name in [name for name, other in known.items() if other is bus]:
            del known[name]


def forget_made() -> None:
    """Forget the buses that URLs with parameters have made: the next such URL makes a new one."""
    _made.clear()


def made() -> List[Any]:
    """The buses that URLs with parameters have made."""
    return list(_made.values())


def bus_for_url(url: str) -> Any:
    """The bus that `url` stands for: a published one, or one that is made from the parameters and kept, so that the same URL
    opens the same bus again. Raises ValueError."""
    from urllib.parse import urlsplit

    parts = urlsplit(url)
    if parts.scheme.lower() != "rkm04" or parts.path not in ("", "/") or parts.fragment:
        raise ValueError(f"URL {url!r}: expected {FORM}")
    if parts.netloc:
        if parts.query:
            raise ValueError(f"URL {url!r}: a name and parameters: expected one of them, as in {FORM}")
        if parts.netloc not in _named:
            known = ", ".join(sorted(_named)) or "none"
            raise ValueError(f"URL {url!r}: there is no bus {parts.netloc!r}; names are: {known}")
        return _named[parts.netloc]
    if url not in _made:
        _made[url] = _make(url, parts.query)
    return _made[url]


def _flag(text: str) -> bool:
    if text not in ("0", "1"):
        raise ValueError("expected 0 or 1")
    return text == "1"


_PARAMETERS: Dict[str, Tuple[str, Callable[[str], Any]]] = {
    "node": ("units", str), "units": ("units", str), "plant": ("plant", str), "framing": ("framing", str),
    "seed": ("seed", int), "device": ("device", str)}


def _make(url: str, query: str) -> Any:
    from urllib.parse import parse_qsl

    from . import Bus

    values: Dict[str, Any] = {}
    echo = False
    for name, text in parse_qsl(query, keep_blank_values=True):
        if name != "echo" and name not in _PARAMETERS:
            raise ValueError(f"URL {url!r}: unknown parameter {name!r}: expected one of {', '.join(_PARAMETERS)}, echo")
        try:
            if name == "echo":
                echo = _flag(text)
            else:
                keyword, convert = _PARAMETERS[name]
                if keyword in values:
                    raise ValueError("expected once")
                values[keyword] = convert(text)
        except ValueError as error:
            raise ValueError(f"URL {url!r}: {name}={text}: {error}") from None
    bus = Bus(**values)
    if echo:
        bus.faults.inject("echo")
    return bus
