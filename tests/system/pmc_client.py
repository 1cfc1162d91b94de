# SPDX-License-Identifier: MIT
"""Host programs of a PMC-2HS for pmc.sh: pmc_client.py modbus|lines PORT, or modbus HOST:PORT; with pymodbus, with pyserial."""
import sys
import time

import serial

LIMIT = 30  # s


def until(what, done):
    end = time.monotonic() + LIMIT
    while not done():
        assert time.monotonic() < end, f"not within {LIMIT} s: {what}"
        time.sleep(0.02)


# ---- Modbus ----------------------------------------------------------------------------------------------------------------


def signed(high, low):
    value = high << 16 | low
    return value - (1 << 32) if value >> 31 else value


class Unit:
    def __init__(self, port):
        from pymodbus.client import ModbusSerialClient, ModbusTcpClient

        host, _, number = port.rpartition(":")
        self.bus = (ModbusTcpClient(host, port=int(number), timeout=LIMIT) if host
                    else ModbusSerialClient(port, baudrate=9600, timeout=LIMIT))
        assert self.bus.connect()

    def holding(self, address, count=1):
        answer = self.bus.read_holding_registers(address, count, 1)
        assert not answer.isError(), answer
        return answer.registers

    def inputs(self, address, count=1):
        answer = self.bus.read_input_registers(address, count, 1)
        assert not answer.isError(), answer
        return answer.registers

    def write(self, address, *words, block=False):
        if len(words) == 1 and not block:
            return self.bus.write_register(address, words[0], 1)
        return self.bus.write_registers(address, list(words), 1)

    def position(self, axis):
        return signed(*self.inputs(0x10 * axis, 2))


def refused(answer, code):
    assert answer.isError() and answer.exception_code == code, f"expected exception {code}, got {answer}"


def check_modbus(port):
    unit = Unit(port)
    assert unit.holding(0x44E, 8) == [10, 400, 400, 50, 10, 100, 1000, 8000]
    for address in range(0x44E, 0x474):
        assert len(unit.holding(address)) == 1
    refused(unit.bus.read_holding_registers(0x474, 1, 1), 2)
    refused(unit.bus.read_coils(0, 1, 1), 1)
    refused(unit.write(0x44E, 501), 3)
    assert not unit.write(0x452, 500).isError() and unit.holding(0x452) == [500]
    # move to 1000, -1000 at 20 000 pulses/s
    assert not unit.write(1, 0x6103, 2000, 2000).isError()
    assert not unit.write(1, 0x7103, 0, 1000, 0xFFFF, 0xFC18).isError()
    until("both axes arrive", lambda: (unit.position(0), unit.position(1)) == (1000, -1000))
    # X+ until it is stopped; another start is refused meanwhile
    until("X is idle", lambda: unit.inputs(6) == [0])
    assert not unit.write(0, 0x0120).isError()
    refused(unit.write(0, 0x0120), 6)
    assert not unit.write(0, 0x0501).isError()
    until("X stops", lambda: unit.inputs(6) == [0])
    # a program: INC 10 V3, END
    assert not unit.write(0x1000, 2, 0, 100, 3, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0, 0, 0).isError()
    before = unit.position(0)
    assert not unit.write(0, 0x0701).isError()
    until("the program ends", lambda: unit.inputs(6) == [0])
    assert unit.position(0) == before + 10
    assert not unit.write(0, 0x0B03).isError()


# ---- Lines -----------------------------------------------------------------------------------------------------------------


class Line:
    def __init__(self, port):
        self.port = serial.Serial(port, 9600, timeout=LIMIT)

    def send(self, line):
        self.port.write(line.encode() + b"\r")

    def ask(self, line):
        self.send(line)
        return self.port.read_until(b"\r").decode().strip()


def check_lines(port):
    line = Line(port)
    assert line.ask("VER") == "VER PMC-2HS 1.00"
    line.send("SPD 2000,2000")
    assert line.ask("SPD") == "SPD 2000,2000"
    line.send("PIC 1000,-10")
    until("both axes arrive", lambda: line.ask("POS") == "POS 000003E8,FFFFFFF6")
    until("X is idle", lambda: line.ask("INR X") == "INR X 0")
    line.send("JOG -X Axis")
    until("X moves", lambda: line.ask("INR X") == "INR X 1")
    line.send("STO X")
    until("X stops", lambda: line.ask("INR X") == "INR X 0")
    assert line.ask("ERD X") == "ERD 00"
    line.send("CLL XY")
    until("the counters are cleared", lambda: line.ask("POS") == "POS 00000000,00000000")
    line.send("HOM Y")
    until("Y searches", lambda: line.ask("INR Y") == "INR Y 5")
    line.send("RST")
    until("Y is reset", lambda: line.ask("INR Y") == "INR Y 0")


{"modbus": check_modbus, "lines": check_lines}[sys.argv[1]](sys.argv[2])
