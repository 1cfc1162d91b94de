# SPDX-License-Identifier: MIT
"""Programs that know nothing of the emulator, over `rkm04://`: pyserial's miniterm, pymodbus."""

import os
import select
import subprocess
import sys

import pytest
from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusIOException

import rkm04

MINITERM = """
import fcntl, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
import rkm04
from serial.tools import miniterm
miniterm.main()
"""


def read_until(terminal, text):
    """What comes on a terminal until `text` has."""
    heard = b""
    while text not in heard:
        readable, _, _ = select.select([terminal], [], [], 60)
        assert readable, heard
        heard += os.read(terminal, 1000)
    return heard


@pytest.mark.skipif(sys.platform == "win32", reason="needs a terminal that a program can open: a pty")
def test_miniterm_talks_to_a_unit():
    import pty

    terminal, child = pty.openpty()
    program = subprocess.Popen([sys.executable, "-c", MINITERM, "--raw", "rkm04://?node=1&framing=plain", "19200"], stdin=child,
                               stdout=child, stderr=child, start_new_session=True)
    try:
        read_until(terminal, b"followed by Ctrl+H")
        os.write(terminal, bytes.fromhex("01000101"))
        assert b"01.02,06.03.2009" in read_until(terminal, b"2009")
        os.write(terminal, b"\x1d")  # Ctrl-] ends it
        assert program.wait(60) == 0
    finally:
        program.kill()
        program.wait()
        os.close(terminal)
        os.close(child)


def test_pymodbus_gets_no_answer_in_virtual_time():
    with rkm04.Bus() as bus, rkm04.virtual_time(bus) as now:
        url = rkm04.publish(bus)
        client = ModbusSerialClient(port=url, baudrate=19200, timeout=0.3, retries=2)
        assert client.connect()
        try:
            answer = client.read_holding_registers(0, count=2)
            assert answer.isError()
        except ModbusIOException as error:
            assert "No response" in str(error)
        client.close()
        assert 0.9 < now.now < 1.2
        assert bus.unit(1).state["line"]["bytes"] == 3 * 8
        rkm04.unpublish(url)
