# SPDX-License-Identifier: MIT
"""Exploration of a test of pytest: each run is set up, called and torn down as a test of its own, so all fixtures are fresh."""
from __future__ import annotations

import os
import re
import sys
from typing import Any, List, Optional, Tuple

import pytest
from _pytest.runner import runtestprotocol

from . import _explore, _system
from ._explore import Fault, Options, Run


class _Next:
    """Stands for the next test: what is around the function stays set up, the function is torn down."""

    def __init__(self, item: pytest.Item) -> None:
        self._item = item

    def listchain(self) -> List[Any]:
        """The nodes from the session down."""
        return [*self._item.listchain()[:-1], self]


def _run(item: Any, nextitem: Any, options: Options, faults: Tuple[Fault, ...], keeps: bool = False) -> Run:
    """Run the test once with these faults. keeps: with all that the report of a failure has."""
    session = _explore.begin_session(faults, options.limit, keeps)
    try:
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
        failed = next((report for report in reports if report.failed), None)
        return Run(faults, None if failed is None else _headline(failed), session.learned, reports)
    finally:
        _explore.end_session()


def _headline(report: pytest.TestReport) -> str:
    crash = getattr(report.longrepr, "reprcrash", None)
    text = str(crash.message if crash is not None else report.longrepr).strip().splitlines()
    return text[0] if text else report.outcome


def _whole(nodeid: str) -> str:
    """The name of a test without the part of an exploration."""
    return re.sub(r"-?part \d+ of \d+", "", nodeid).replace("[]", "")


def _done(item: Any, nextitem: Optional[pytest.Item]) -> None:
    item.session._setupstate.teardown_exact(nextitem)


def explore_item(item: Any, nextitem: Optional[pytest.Item], options: Options, part: Tuple[int, int]) -> List[pytest.TestReport]:
    """The reports of the test: those of its first run, or of the run that failed with the smallest set of faults."""
    neighbour = _Next(item)
    replay = os.environ.get(_explore.REPLAY)
    first = _run(item, neighbour, options, () if replay is None else tuple(_explore.parse_faults(replay)), True)
    reports: List[pytest.TestReport] = first.details
    skipped = any(report.skipped for report in reports)
    if first.failure is None and replay is None and not skipped:
        progress = _explore.Progress(item.name, sys.__stderr__)
        result = _explore.explore_runs(lambda faults: _run(item, neighbour, options, faults), first, options, progress, part)
        text = result.report(f"pytest {_system.quote(_whole(item.nodeid))}")
        if not result:
            reports = _run(item, neighbour, options, result.failures[0].faults, True).details
        for report in reports:
            report.user_properties.append(("rkm04_runs", result.runs))
            if report.when == "call" or report.failed:
                report.sections.append(("rkm04: exploration", text))
    _done(item, nextitem)
    return reports
