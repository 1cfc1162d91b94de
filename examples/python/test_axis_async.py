# SPDX-License-Identifier: MIT
"""The asyncio variant of the library, over pyserial-asyncio and pytest-asyncio."""
import pytest

from rkm_host_async import AsyncUnit

pytestmark = pytest.mark.asyncio


async def test_a_motion(rkm04_port, rkm04_time):
    unit = await AsyncUnit.open(rkm04_port)
    await unit.set_command(1, "V1000 G2000")
    await unit.wait(1)
    assert await unit.position(1) == 2000
    unit.close()


async def test_a_lost_answer(rkm04_bus, rkm04_port, rkm04_time):
    rkm04_bus.faults.inject("no_answer", count=1)
    unit = await AsyncUnit.open(rkm04_port)
    assert await unit.position(1) == 0
    assert rkm04_bus.dialogue.count("Get Position") == 2
    unit.close()
