# SPDX-License-Identifier: MIT
"""A PMC-2HS in the process of the test: a program, methods, lines of text through a port, at their speed."""

import pytest
import serial

import rkm04

PROGRAM = "X: 00 REP 1\nX: 01 INC 100 V3 50\nX: 02 RPE\nX: 03 END\n"


def test_a_program_runs():
    with rkm04.Bus(device="pmc-2hs", settings={"rep_counts": "passes"}) as bus:
        assert bus.call("pmc.program", text=PROGRAM)["text"] == PROGRAM
        bus.call("pmc.run", axes="x")
        motor = bus.unit(1).motor(1)
        motor.wait(state="program", limit="10ms")
        motor.wait(state="idle", limit="10s")
        assert motor.position == 100
        with pytest.raises(rkm04.RefusedError, match="2:3: expected"):
            bus.call("pmc.program", text="0 END\n1 FOO\n")


def test_lines_through_a_port():
    with rkm04.Bus(device="pmc-2hs") as bus:
        url = rkm04.publish(bus)
        try:
            with serial.serial_for_url(url, baudrate=9600, timeout=0.5) as port:
                port.write(b"POS\r")
                assert port.read_until(b"\r") == b"POS 00000000,00000000\r"
                assert bus.now == pytest.approx(26 * 1041.67, abs=10), "26 bytes at 9600 baud"
        finally:
            rkm04.unpublish(url)


@pytest.mark.parametrize("timed", [True, False])
def test_messages_of_modbus_are_exchanged(timed):
    with rkm04.Bus("1,2", device="pmc-1hs", settings={"face": "modbus"}, timed=timed) as bus:
        assert bytes(bus.exchange(2, bytes.fromhex("03 04 4E 00 02"))) == bytes.fromhex("03 04 00 0A 01 90")
        assert bytes(bus.exchange(1, bytes.fromhex("05 00 00 FF 00"))) == bytes.fromhex("85 01"), "an exception"
        with pytest.raises(rkm04.NoAnswerError):
            bus.exchange(3, bytes.fromhex("03 04 4E 00 02"), limit="100ms")
        assert [exchange.node for exchange in bus.dialogue] == [2, 1, 3]


def test_texts_are_in_the_flash_of_the_unit():
    settings = {"program": "X: 00 ABS 7 V3\nX: 01 END\n", "parameters": "[X]\nmultiplier = 20\n"}
    with rkm04.Bus(device="pmc-1hs", settings=settings) as bus:
        bus.call("pmc.run")
        bus.wait(motor=1, position=7, limit="1s")
        assert "multiplier = 20\n" in bus.call("pmc.parameters")["text"]


@pytest.mark.parametrize("name, text, said", [
    ("program", "X: 99 NOP\n", "program:1:4: error: expected"),
    ("program", "X: 00 END # \0\n", 'expected "program", a text without the character 0'),
    ("program", 7, 'expected "program", a text'),
    ("program", "Y: 00 END\n", "program:1:1: error: expected"),
    ("parameters", "[X]\nmultiplier = 0\n", "parameters:2:"),
])
def test_a_wrong_text_is_refused(name, text, said):
    with pytest.raises(rkm04.RefusedError) as error:
        rkm04.Bus(device="pmc-1hs", settings={name: text})
    assert said in str(error.value)
