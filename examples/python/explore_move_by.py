# SPDX-License-Identifier: MIT
"""This test fails, and exploration shows why: pytest explore_move_by.py

When the answer to `F300 R` is lost, the library sends the request again, and the unit executes it twice."""
import rkm04
from rkm_host import Axis, Unit


@rkm04.explore(faults=["lost byte", "no answer"], budget=200)
def test_move_by(rkm04_bus, rkm04_port, rkm04_time):
    with Unit(rkm04_port) as unit:
        Axis(unit, motor=1).move_by(300)
    assert rkm04_bus.unit(1).motor(1).position == 300
