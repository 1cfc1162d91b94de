# SPDX-License-Identifier: MIT
"""A CIB module in the process of the test: settings, methods, Modbus through a port."""

import pytest
import serial

import rkm04

READ_TYPE = bytes.fromhex("01040030000131c5")
TYPE = bytes.fromhex("0104020808bf36")


def test_settings_commands_and_conditions():
    with rkm04.Bus(device="cib", settings={"comm_timeout": 1000, "setup": {"do5-8": {"use": "do"}}}) as bus:
        bus.call("cib.command", drive="A", command=102, p1=3000, p2=500)
        motor = bus.unit(1).motor(1)
        motor.wait(state="idle", limit="10s")
        assert motor.position < 3000, "the watchdog has stopped the drive: no request came for a second"
        assert bus.call("cib.do", outputs={"6": 1})["on"] & 0x20
        with pytest.raises(rkm04.RefusedError, match="drive: expected"):
            bus.call("cib.command", drive="C", command=0)


def test_a_wrong_setup_is_refused():
    with pytest.raises((ValueError, rkm04.Error), match="do3-4.use"):
        rkm04.Bus(device="cib", settings={"setup": {"do1-2": {"use": "do"}}})


def test_modbus_through_a_port():
    with rkm04.Bus(device="cib") as bus:
        url = rkm04.publish(bus)
        try:
            with serial.serial_for_url(url, baudrate=19200, timeout=0.5) as port:
                port.write(READ_TYPE)
                assert port.read(7) == TYPE
                assert bus.now == pytest.approx(8 * 520.8 + 1823 + 7 * 520.8, abs=10), "3.5 characters before the answer"
        finally:
            rkm04.unpublish(url)
