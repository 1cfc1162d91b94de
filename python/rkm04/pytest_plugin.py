# SPDX-License-Identifier: MIT
"""The pytest plugin: fixtures, marker, failure reports, exploration. docs/PYTHON.md describes them."""
from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Dict, Generator, Iterator, List, Optional, Tuple

import pytest

from . import _explore, _ports, _report, _system
from ._virtual_time import virtual_time

MARK = "rkm04"
EXPLORED = "rkm04_explored"
_OPTIONS = ("units", "plant", "framing", "clock", "device", "seed", "readings")
_BUSES = pytest.StashKey[List[Any]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of the plugin."""
    group = parser.getgroup("rkm04", "virtual RKM04")
    group.addoption("--rkm04-transport", choices=("inprocess", "pty", "rfc2217", "tcp"), default="inprocess",
                    help="what rkm04_port is: a URL rkm04:// in this process (default), the pty of an `rkm04 serve', or its "
                         "URL rfc2217:// or socket://")
    group.addoption("--rkm04-trace", metavar="DIR", help="keep a trace (VCD) of each test that uses rkm04_bus in DIR")
    group.addoption("--rkm04-shard", metavar="I/N", help="of each exploration, do part I of N (1/N to N/N)")


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker; check the options."""
    config.addinivalue_line("markers", f"{MARK}({', '.join(_OPTIONS)}): how the bus of the test is made, as in "
                                       "@pytest.mark.rkm04(units='1,2', plant='axis.yaml')")
    config.addinivalue_line("markers", f"{EXPLORED}: the tests that @rkm04.explore runs again and again; set by itself")
    _shard(config)
    if _transport_of(config) == "pty" and not _system.HAS_PTYS:
        raise pytest.UsageError("--rkm04-transport=pty: there are no ptys on Windows: expected inprocess, rfc2217 or tcp")
    try:
        _explore.parse_faults(os.environ.get(_explore.REPLAY, ""))
    except ValueError as error:
        raise pytest.UsageError(str(error)) from None


def _shard(config: pytest.Config) -> Tuple[int, int]:
    """(part from 0 on, parts) of --rkm04-shard."""
    text = config.getoption("--rkm04-shard")
    if text is None:
        return 0, 1
    part, _, parts = str(text).partition("/")
    if not (part.isdigit() and parts.isdigit() and 1 <= int(part) <= int(parts)):
        raise pytest.UsageError(f"--rkm04-shard {text}: expected I/N with 1 <= I <= N, as in 3/16")
    return int(part) - 1, int(parts)


# ---- Fixtures ----------------------------------------------------------------------------------------------------------------


def _settings(node: pytest.Item) -> Dict[str, Any]:
    """The settings of the bus: those of the nearest marker win."""
    settings: Dict[str, Any] = {}
    for mark in node.iter_markers(MARK):
        if mark.args:
            raise pytest.UsageError(f"{node.nodeid}: marker rkm04: expected keyword arguments only: {', '.join(_OPTIONS)}")
        for name, value in mark.kwargs.items():
            if name not in _OPTIONS:
                raise pytest.UsageError(f"{node.nodeid}: marker rkm04: unknown argument {name!r}: expected one of "
                                        f"{', '.join(_OPTIONS)}")
            settings.setdefault(name, value)
    plant = settings.get("plant")
    if isinstance(plant, str) and "\n" not in plant and not os.path.isabs(plant):
        settings["plant"] = str(node.path.parent / plant)
    return settings


def _transport(request: pytest.FixtureRequest) -> str:
    return str(request.config.getoption("--rkm04-transport"))


def _trace(request: pytest.FixtureRequest, bus: Any) -> None:
    """Write a trace if --rkm04-trace says so."""
    if request.config.getoption("--rkm04-trace"):
        directory = _record_directory(request.config)
        directory.mkdir(parents=True, exist_ok=True)
        bus.trace(str(directory / (_report.file_name(request.node.nodeid) + ".vcd")), force=True)


@pytest.fixture
def rkm04_serve(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A running `rkm04 serve`, for software that is not Python. Settings: marker rkm04."""
    from . import serve

    directory = _record_directory(request.config)
    directory.mkdir(parents=True, exist_ok=True)
    with serve(**_settings(request.node), arguments=["--allow-folder", str(directory)]) as server:
        request.node.stash.setdefault(_BUSES, []).append(server)
        _trace(request, server)
        yield server


@pytest.fixture
def rkm04_bus(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A fresh bus, in this process; with another --rkm04-transport that of `rkm04_serve`. Settings: marker rkm04."""
    node = request.node
    if _transport(request) != "inprocess":
        yield request.getfixturevalue("rkm04_serve")
        return
    from . import Bus

    settings = _settings(node)
    settings.pop("clock", None)
    bus = Bus(**settings)
    node.stash.setdefault(_BUSES, []).append(bus)
    _explore.bus_made(bus)
    _trace(request, bus)
    try:
        yield bus
    finally:
        bus.close()


@pytest.fixture
def rkm04_port(request: pytest.FixtureRequest, rkm04_bus: Any) -> Iterator[str]:
    """What the program under test opens: a URL `rkm04://...`, the path of a pty, or a URL `rfc2217://...` or `socket://...`, by
    --rkm04-transport."""
    transport = _transport(request)
    if transport != "inprocess":
        server = request.getfixturevalue("rkm04_serve")
        yield {"pty": server.link, "rfc2217": server.rfc2217_url, "tcp": server.tcp_url}[transport]
        return
    url = _ports.publish(rkm04_bus)
    try:
        yield url
    finally:
        _ports.unpublish(url)


@pytest.fixture
def rkm04_time(request: pytest.FixtureRequest, rkm04_bus: Any) -> Iterator[Any]:
    """Virtual time for the program under test, as by `rkm04.virtual_time()`. With another --rkm04-transport time is real, and
    the value is None."""
    if _transport(request) != "inprocess":
        yield None
        return
    with virtual_time(rkm04_bus, start=_explore.START if _explore.session() is not None else None) as time:
        yield time


# ---- Results -----------------------------------------------------------------------------------------------------------------


def _buses(item: pytest.Item) -> List[Any]:
    """The buses of a test: that of the fixture, and those that URLs have made."""
    return item.stash.get(_BUSES, []) + _ports.made()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, Any, Any]:
    """Fail a test that has passed although one of its faults has never acted."""
    session = _explore.session()
    try:
        result = yield
    finally:
        if session is not None and not session.faults:
            session.learn()
    if session is None:
        for bus in _buses(pyfuncitem):
            for text in _report.idle_faults(bus):
                pytest.fail(f"{text}: the test has not tried what it was to try", pytrace=False)
    return result


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Add what is known of the buses to the report of a failure."""
    report = yield
    session = _explore.session()
    if report.failed and report.when in ("setup", "call") and (session is None or session.keeps):
        for number, bus in enumerate(_buses(item)):
            title = "rkm04" if number == 0 else f"rkm04, bus {number + 1}"
            for name, text in _report.sections(bus, item.nodeid, _record_directory(item.config)):
                report.sections.append((f"{title}: {name}", text))
    return report


def _record_directory(config: pytest.Config) -> Path:
    """Where recordings of failures are kept: with the traces, else in pytest's cache."""
    directory = config.getoption("--rkm04-trace")
    if directory:
        return Path(directory).absolute()
    cache = getattr(config, "cache", None)
    return Path(cache.mkdir("rkm04")) if cache is not None else Path(tempfile.gettempdir())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, Any, Any]:
    """Forget the buses that URLs have made."""
    try:
        return (yield)
    finally:
        _ports.forget_made()
        if _BUSES in item.stash:
            del item.stash[_BUSES]


def pytest_assertrepr_compare(op: str, left: object, right: object) -> Optional[List[str]]:
    """Explain comparisons of dialogues and of what they count."""
    return _report.explain(op, left, right)


# ---- Exploration -------------------------------------------------------------------------------------------------------------


def _options(item: pytest.Item) -> Optional[_explore.Options]:
    return getattr(getattr(item, "function", None), _explore.ATTRIBUTE, None)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark explored tests, so that -m can choose them."""
    if _options(item) is not None:
        item.add_marker(EXPLORED)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """With pytest-xdist an exploration is several tests, which the workers share."""
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    part, parts = _shard(metafunc.config)
    if getattr(metafunc.function, _explore.ATTRIBUTE, None) is None or (workers == 1 and parts == 1):
        return
    pieces = 4 * workers if workers > 1 else 1
    shares = [(part + parts * piece, parts * pieces) for piece in range(pieces)]
    metafunc.fixturenames.append("_rkm04_part")
    metafunc.parametrize("_rkm04_part", shares, ids=[f"part {number + 1} of {total}" for number, total in shares], indirect=True)


@pytest.fixture
def _rkm04_part(request: pytest.FixtureRequest) -> Any:
    return request.param


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: Optional[pytest.Item]) -> Optional[bool]:
    """Run an explored test again and again."""
    options = _options(item)
    if options is None or _transport_of(item.config) != "inprocess":
        return None
    from ._explore_pytest import explore_item

    callspec = getattr(item, "callspec", None)
    part = callspec.params.get("_rkm04_part", (0, 1)) if callspec is not None else (0, 1)
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in explore_item(item, nextitem, options, part):
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def _transport_of(config: pytest.Config) -> str:
    return str(config.getoption("--rkm04-transport"))
