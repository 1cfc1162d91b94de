# SPDX-License-Identifier: MIT
"""A motion of five minutes, polled five times a second; in virtual time it takes milliseconds."""
import time

from rkm_host import Axis, Unit


def test_five_minutes(rkm04_port, rkm04_time):
    with Unit(rkm04_port) as unit:
        unit.set_command(1, "S100 V100")
        begin = time.monotonic()
        Axis(unit, motor=1, speed=100).move_by(30000)
        assert 300 < time.monotonic() - begin < 301
