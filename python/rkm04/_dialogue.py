# SPDX-License-Identifier: MIT
"""What has passed on the bus, as exchanges of a request and its answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Union, overload

from ._errors import always_shown
from ._message import RKM04, Kind, Message, number_of
from ._time import Time, to_us

if TYPE_CHECKING:
    Base = Sequence["Exchange"]
else:
    Base = Sequence


class Exchange:
    """A request and what came of it; or something that was no answer to anything.

    tick: us at which its first byte began; end: at which its last byte, that of the answer if there is one, had passed.
    node: address that it was sent to, 0: all; of what has no request, of the sender. None: not known.
    request: None if an answer came without one, or if the bytes were dropped.
    answer: None: none came. dropped: why the request or the answer was dropped; None: it was not.
    refused: what the unit objects to, in words; None: nothing.
    """

    __slots__ = ("tick", "end", "node", "request", "answer", "dropped", "refused", "events", "device")

    def __init__(self, event: Dict[str, Any], device: str = RKM04) -> None:
        self.device = device
        self.tick: int = event["start_us"]
        self.end: int = event["t_us"]
        self.node: Optional[int] = None
        self.request: Optional[Message] = None
        self.answer: Optional[Message] = None
        self.dropped: Optional[str] = None
        self.refused: Optional[str] = None
        self.events: List[Dict[str, Any]] = []
        self._add(event)

    def _add(self, event: Dict[str, Any]) -> None:
        """Take in an event `message` of docs/CONTROL.md."""
        self.events.append(event)
        self.end = event["t_us"]
        self.dropped = self.dropped or event["dropped"]
        self.refused = self.refused or event["refused"]
        data = bytes.fromhex(event["message"])
        if event["answer"]:
            self.answer = Message(data, True, self.device) if data else self.answer
            self.node = self.node if self.node is not None else _sender(event)
        else:
            self.request = Message(data, False, self.device) if data else None
            self.node = event["dnode"] if data else None

    @property
    def words(self) -> str:
        """The exchange in words, one line."""
        parts = [message.words for message in (self.request, self.answer) if message is not None]
        if self.dropped:
            parts.append(f"dropped: {self.dropped}")
        elif self.request is not None and self.answer is None:
            parts.append("no answer")
        if self.refused:
            parts.append(f"refused: {self.refused}")
        return " | ".join(parts)

    def __repr__(self) -> str:
        node = "?" if self.node is None else "all" if self.node == 0 else str(self.node)
        return f"<{self.tick / 1e6:.6f} s node {node}: {self.words}>"


def _sender(event: Dict[str, Any]) -> Optional[int]:
    """The address of the unit that has sent an answer: hdlc names it as the sender, plain as the addressee."""
    node: int = event["snode"] or event["dnode"]
    return node or None


class Count(int):
    """A number of exchanges, which knows what was counted, for assertions that fail."""

    what: str
    """What was sought, in words."""
    found: "Dialogue"
    """The exchanges that were found."""
    dialogue: "Dialogue"
    """All exchanges at that time."""


class Dialogue(Base):
    """A list of exchanges, in the order in which they began. That of a bus grows with it; what its methods return does not."""

    def __init__(self, pull: Optional[Callable[[], List[Dict[str, Any]]]] = None, exchanges: Sequence[Exchange] = (),
                 device: Callable[[], str] = lambda: RKM04) -> None:
        self._pull = pull
        self._device = device
        self._exchanges: List[Exchange] = list(exchanges)
        self._open: List[Exchange] = []
        self._sought = ""
        self._among: Optional[Dialogue] = None

    def _update(self) -> List[Exchange]:
        if self._pull is not None:
            for event in self._pull():
                self._take(event)
        return self._exchanges

    def _take(self, event: Dict[str, Any]) -> None:
        waiting = self._find_open(event) if event["answer"] else None
        if waiting is not None:
            self._open.remove(waiting)
            waiting._add(event)
            return
        exchange = Exchange(event, self._device())
        self._exchanges.append(exchange)
        if exchange.request is not None and exchange.dropped is None:
            self._open.append(exchange)
            del self._open[:-16]

    def _find_open(self, event: Dict[str, Any]) -> Optional[Exchange]:
        """The request that an answer belongs to: the last one to that unit, with its number if the answer has one, as those of
        an RKM04."""
        node = _sender(event)
        number = event["value"] if self._device() == RKM04 else None
        for exchange in reversed(self._open):
            if node is not None and exchange.node not in (node, 0):
                continue
            if number in (None, 255) or exchange.request is None or exchange.request.number == number:
                return exchange
        return None

    def __len__(self) -> int:
        return len(self._update())

    @overload
    def __getitem__(self, at: int) -> Exchange: ...
    @overload
    def __getitem__(self, at: slice) -> "Dialogue": ...
    def __getitem__(self, at: Union[int, slice]) -> Union[Exchange, "Dialogue"]:
        exchanges = self._update()
        return Dialogue(exchanges=exchanges[at]) if isinstance(at, slice) else exchanges[at]

    def __iter__(self) -> Iterator[Exchange]:
        return iter(list(self._update()))

    def sent(self, kind: Optional[Kind] = None, *, motor: Optional[int] = None, text: Optional[str] = None,
             node: Optional[int] = None) -> "Dialogue":
        """The exchanges whose request is of this kind, motor, text and addressee; what is None does not matter.

        kind: "Set Command" or 2. motor: 0 (all) to 4. text: all of it. node: 0 (all units) to 16.
        The result is empty, and so false, if there are none: `assert bus.dialogue.sent("Version")`.
        """
        number = None if kind is None else number_of(kind)
        all_of_it = self._update()
        found = Dialogue(exchanges=[
            exchange for exchange in all_of_it
            if exchange.request is not None
            and (number is None or exchange.request.number == number)
            and (motor is None or exchange.request.motor == motor)
            and (text is None or exchange.request.text == text)
            and (node is None or exchange.node == node)
        ])
        sought = {"motor": motor, "text": text, "node": node}
        words = ["any request" if kind is None else f"{kind!r}"]
        found._sought = ", ".join(words + [f"{name}={value!r}" for name, value in sought.items() if value is not None])
        found._among = Dialogue(exchanges=all_of_it)
        return found

    def count(self, kind: Any = None, *, motor: Optional[int] = None, text: Optional[str] = None,
              node: Optional[int] = None) -> Count:
        """How many exchanges `sent` finds."""
        found = self.sent(kind, motor=motor, text=text, node=node)
        count = Count(len(found))
        count.what, count.found, count.dialogue = found._sought, found, found._among or found
        return count

    def between(self, first: Time, last: Time) -> "Dialogue":
        """The exchanges that began at first <= tick < last, us of the bus or texts as in "1.5s"."""
        low, high = to_us(first), to_us(last)
        return Dialogue(exchanges=[exchange for exchange in self._update() if low <= exchange.tick < high])

    def answered(self) -> "Dialogue":
        """The exchanges with a whole answer."""
        return Dialogue(exchanges=[exchange for exchange in self._update() if exchange.answer is not None])

    def dropped(self) -> "Dialogue":
        """The exchanges of which something was dropped."""
        return Dialogue(exchanges=[exchange for exchange in self._update() if exchange.dropped is not None])

    def clear(self) -> None:
        """Forget what has passed so far."""
        self._update()
        self._exchanges.clear()
        self._open.clear()

    @property
    def words(self) -> str:
        """All of it in words, a line an exchange."""
        return "\n".join(repr(exchange)[1:-1] for exchange in self._update())

    def __eq__(self, other: object) -> bool:
        """Equal to a list of texts if these are the exchanges in words."""
        if isinstance(other, list) and all(isinstance(each, str) for each in other):
            return [exchange.words for exchange in self] == other
        return list(self) == list(other) if isinstance(other, (Dialogue, list)) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    @always_shown
    def __repr__(self) -> str:
        if not self and self._among is not None:
            last = "; ".join(exchange.words for exchange in self._among[-3:]) or "nothing"
            return f"<no exchange with {self._sought}; the last of {len(self._among)}: {last}>"
        if len(self) > 10:
            return f"<dialogue of {len(self)} exchanges>"
        return f"<dialogue\n{self.words}>" if self else "<dialogue: nothing>"
