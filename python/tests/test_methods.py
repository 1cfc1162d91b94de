# SPDX-License-Identifier: MIT
"""Every method of docs/CONTROL.md has its counterpart."""

import pathlib
import re

import pytest

import rkm04
from rkm04._parts import Faults, Inputs, Motor, Plant, Power

CONTROL = pathlib.Path(__file__).resolve().parents[2] / "docs" / "CONTROL.md"

COUNTERPARTS = {
    "units": rkm04.Bus.units,
    "device": rkm04.Bus.device,
    "ready": rkm04.Bus.ready,
    "state": rkm04.Unit.state,
    "motor.program": Motor.commands,
    "di.set": Inputs.set,
    "reset": rkm04.Unit.reset,
    "power": Power.__call__,
    "switch": rkm04.Unit.set_switch,
    "clock": rkm04.Bus.clock,
    "advance": rkm04.Bus.advance,
    "wait": rkm04.Bus.wait,
    "subscribe": rkm04.Bus.events,
    "unsubscribe": rkm04.Events.close,
    "collected": rkm04.Bus.call,
    "trace.start": rkm04.Bus.trace,
    "trace.stop": rkm04.Bus.trace,
    "plant.get": Plant.state,
    "plant.set": Plant.set,
    "fault.inject": Faults.inject,
    "fault.clear": Faults.clear,
    "fault.list": Faults.list,
    "fault.kinds": Faults.kinds,
    "service.open": rkm04.Bus.call,
    "service.bytes": rkm04.Bus.call,
    "service.close": rkm04.Bus.call,
    "snapshot": rkm04.Bus.snapshot,
    "restore": rkm04.Bus.restore,
    "shutdown": rkm04.Bus.close,
}
CONNECTIONS = {"collected"}  # of a control socket alone, for clients that cannot take every event
DEVICES = {"pmc": "pmc-2hs"}  # whose methods begin so: rkm04.Bus.call


def documented():
    names = re.findall(r"^### (`.*)$", CONTROL.read_text(encoding="utf-8"), re.M)
    return [name for heading in names for name in re.findall(r"`([^`]+)`", heading)]


def device_of(method):
    return DEVICES.get(method.split(".")[0], "rkm04")


def test_every_method_has_its_counterpart():
    assert sorted(name for name in documented() if device_of(name) == "rkm04") == sorted(COUNTERPARTS)


@pytest.mark.parametrize("method", [method for method in documented() if method not in CONNECTIONS])
def test_every_method_is_known_in_this_process(method):
    with rkm04.Bus(device=device_of(method)) as bus:
        try:
            bus.call(method)
        except rkm04.RefusedError as error:
            assert error.code != -32601, error

