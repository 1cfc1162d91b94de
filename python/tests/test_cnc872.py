# SPDX-License-Identifier: MIT
"""A CNC872 in the process of the test: its texts as settings, methods, conditions, time, a snapshot."""

import pytest

import rkm04

CONFIG = '<ChannelConfig><Axis Name="X"/><Axis Name="Y"/></ChannelConfig>\n'
PLC = "DATA\nPASSES DW 0\nNEAR BIT 0\nDATA_END\nMODULE_MAIN\n\tLOD PASSES\n\tAD CNST.1\n\tSTO PASSES\nMODULE_MAIN_END\n"
MACHINE = "switches:\n  - {cell: NEAR, axis: X, at_least: 5000}\n"
SETTINGS = {"config": CONFIG, "plc": PLC, "nc": "G1 X10 F1000\n", "machine": MACHINE}


def test_texts_methods_and_conditions():
    with rkm04.Bus(device="cnc872", settings=SETTINGS) as bus:
        bus.call("cnc.panel", start=True)
        bus.wait(cell={"NEAR": 1}, limit="1s")
        assert 5 * 65536000 <= bus.call("cnc.get", cells=["B_INK_EX[0]"])["cells"]["B_INK_EX[0]"] < 5.1 * 65536000
        bus.call("cnc.set", cells={"STOP_REQ": 1})
        bus.advance("500ms")
        values = bus.call("cnc.get", cells=["PO_STOP", "PASSES"])
        assert values["cells"] == {"PO_STOP": 1, "PASSES": values["t"]}, "a pass of the PLC program in each ms"


def test_what_is_wrong_is_refused():
    with pytest.raises((ValueError, rkm04.Error), match="nc:2:4: "):
        rkm04.Bus(device="cnc872", settings={"nc": "G1 X1 F1\nG1 Q1\n"})
    with rkm04.Bus(device="cnc872", settings=SETTINGS) as bus:
        with pytest.raises(rkm04.RefusedError, match="NO_CELL"):
            bus.call("cnc.get", cells=["NO_CELL"])
        with pytest.raises(rkm04.RefusedError, match="NO_CELL"):
            bus.wait(cell={"NO_CELL": 1}, limit="1s")


def test_events_of_cells():
    with rkm04.Bus(device="cnc872", settings=SETTINGS) as bus:
        with bus.events(cells=["PO_F", "NEAR", "PASSES"]) as changes:
            assert changes.cells == {"PO_F": 0, "NEAR": 0, "PASSES": 0}
            bus.call("cnc.panel", start=True)
            bus.wait(cell={"NEAR": 1}, limit="1s")
            bits = [(event["t_us"], event["cell"], event["value"]) for event in changes if event["cell"] != "PASSES"]
            assert bits == [(1000, "PO_F", 1), (bus.now - 1, "NEAR", 1)]
        with pytest.raises(rkm04.RefusedError, match="NO_CELL"):
            bus.events(cells=["NO_CELL"])


def test_exchange_is_a_cycle_in_one_call():
    with rkm04.Bus(device="cnc872", settings=SETTINGS) as bus:
        bus.call("cnc.panel", start=True)
        assert bus.call("cnc.exchange", slots=199, get=["PO_F"]) == {"t": 199, "cells": {"PO_F": 1}}
        assert bus.call("cnc.exchange", set={"STOP_REQ": 1}, slots=17, get=["PO_STOP", "B_INK_EX"]) == {
            "t": 216, "cells": {"PO_STOP": 1, "B_INK_EX": 207170098}}
        assert bus.call("cnc.exchange", slots=0) == {"t": 216, "cells": {}}
        with pytest.raises(rkm04.RefusedError, match="may only be read"):
            bus.call("cnc.exchange", set={"PO_F": 1})
        assert bus.call("cnc.exchange", get=["PASSES"]) == {"t": 217, "cells": {"PASSES": 217}}


@pytest.mark.parametrize("options", [{"units": "1,1"}, {"units": 2}, {"turnaround": 5}, {"timed": False}, {"framing": "plain"},
                                     {"plant": {"motors": {1: {"turn": 400}}}}, {"readings": {"hold-exit": "latch"}},
                                     {"version_text": "x"}])
def test_options_of_a_bus_are_refused(options):
    with pytest.raises((ValueError, rkm04.Error), match="no bus|address|unknown parameter|make no steps"):
        rkm04.Bus(device="cnc872", **options)


def test_there_is_no_host():
    with rkm04.Bus(device="cnc872") as bus:
        with pytest.raises(ValueError, match="the device cnc872 has no bus"):
            bus.host.write(b"\x04")
        with pytest.raises(ValueError, match="the device cnc872 has no bus"):
            bus.exchange(1, b"\x04")


def test_a_long_program_is_in_a_snapshot(tmp_path):
    with rkm04.Bus(device="cnc872") as bus:
        bus.call("cnc.load", text="G1 X1 F1000\nG1 X0 F1000\n" * 100_000)  # 2.4 MB
        bus.call("cnc.panel", start=True)
        bus.snapshot(file=str(tmp_path / "long"))
        bus.advance("100ms")
        position = bus.unit(1).motor(1).position
        assert position > 0
        bus.restore(file=str(tmp_path / "long"))
        assert bus.unit(1).motor(1).position == 0
        bus.advance("100ms")
        assert bus.unit(1).motor(1).position == position
