# SPDX-License-Identifier: MIT
"""Tests of the host library. `pytest test_axis.py` runs them in virtual time; with --rkm04-transport=pty the same tests run over
the pty of an `rkm04 serve`, where timeouts are real and motions take no time (--clock max)."""
import pytest

from rkm_host import Axis, NoAnswer, Unit, UnitError

pytestmark = pytest.mark.rkm04(plant="axis.plant.yaml", clock="max")


@pytest.fixture
def unit(rkm04_port, rkm04_time):
    with Unit(rkm04_port) as unit:
        yield unit


def test_version(unit):
    assert unit.version() == "01.02,06.03.2009"


def test_a_refused_text_says_where(unit):
    with pytest.raises(UnitError, match="flag 2 at 'x'"):
        unit.set_command(1, "F5x")


def test_home_and_move(unit, rkm04_bus):
    axis = Axis(unit, motor=1)
    axis.home()
    assert unit.position(1) == 0
    axis.move_to(2000)
    axis.move_by(-500)
    assert unit.position(1) == 1500
    assert rkm04_bus.dialogue.sent("Set Command", motor=1, text="V1000 G2000")


def test_a_lost_answer_is_asked_for_again(unit, rkm04_bus):
    rkm04_bus.faults.inject("no_answer", count=1)
    assert unit.version() == "01.02,06.03.2009"
    assert rkm04_bus.dialogue.count("Version") == 2


def test_a_unit_without_power(unit, rkm04_bus):
    rkm04_bus.power(False)
    with pytest.raises(NoAnswer):
        unit.version()
