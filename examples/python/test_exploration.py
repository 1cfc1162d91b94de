# SPDX-License-Identifier: MIT
"""What does the library do when a byte or an answer is lost, anywhere?"""
import rkm04
from rkm_host import Axis, Unit


@rkm04.explore(faults=["lost byte", "flipped bit", "no answer", "late answer"], budget=200)
def test_move_to(rkm04_bus, rkm04_port, rkm04_time):
    with Unit(rkm04_port) as unit:
        Axis(unit, motor=1).move_to(300)
    assert rkm04_bus.unit(1).motor(1).position == 300
