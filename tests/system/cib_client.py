# SPDX-License-Identifier: MIT
"""Clients for cib.sh and qemu_cib.sh: cib_client.py WHAT PORT, Modbus masters with pymodbus, of which `silence' wants a stepped
clock and its control socket beside the port; tcp HOST:PORT, the same over TCP; lines HOST:PORT CONTROL, a PLCComS client."""
import json
import socket
import sys
import time

import serial
from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.pdu import ExceptionResponse

LIMIT = 30  # seconds until something counts as never coming
ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE = 1, 2, 3
HOLDING = [*range(0, 9), *range(0x10, 0x15), *range(0x20, 0x25), *range(0x100, 0x10C), *range(0x110, 0x116), *range(0x120, 0x126)]
INPUT = [*range(0, 3), *range(0x10, 0x1B), *range(0x20, 0x2B), 0x30, 0x31, *range(0x100, 0x10C), *range(0x110, 0x116),
         *range(0x120, 0x126)]


def refused(answer, code):
    assert isinstance(answer, ExceptionResponse) and answer.exception_code == code, f"expected exception {code}, got {answer}"


def words(answer):
    assert not answer.isError(), answer
    return answer.registers


def check_tables(bus, unit):
    """Every register there is, and none besides; blocks up to the gaps."""
    for address in range(0, 0x140):
        for read, there in ((bus.read_holding_registers, HOLDING), (bus.read_input_registers, INPUT)):
            answer = read(address, 1, unit)
            if address in there:
                assert len(words(answer)) == 1
            else:
                refused(answer, ILLEGAL_ADDRESS)
    assert len(words(bus.read_holding_registers(0, 9, unit))) == 9
    refused(bus.read_holding_registers(0, 10, unit), ILLEGAL_ADDRESS)
    assert words(bus.read_input_registers(0x30, 2, unit)) == [0x0808, 0x0102]


def check_writes(bus, unit):
    """Every holding register takes a value, and shows it, but APPLY."""
    for address in HOLDING:
        if address != 0x100 and address not in (0x10, 0x20):
            assert not bus.write_register(address, 7, unit).isError()
            assert words(bus.read_holding_registers(address, 1, unit)) == [7]
    for address, value in ((0, 256), (1, 10001), (8, 10001), (0x100, 2)):
        refused(bus.write_register(address, value, unit), ILLEGAL_VALUE)
    refused(bus.write_register(9, 0, unit), ILLEGAL_ADDRESS)
    refused(bus.write_registers(8, [1, 1], unit), ILLEGAL_ADDRESS)
    refused(bus.write_registers(0, [1, 10001], unit), ILLEGAL_VALUE)
    assert words(bus.read_holding_registers(0, 2, unit)) == [7, 7]
    assert not bus.write_register(0x100, 1, unit).isError()
    assert words(bus.read_input_registers(0x100, 1, unit)) == [0x101], "7 is no use of an output"


def check_bits(bus, unit):
    assert not bus.write_coils(0, [True, False] * 4, unit).isError()
    assert bus.read_coils(0, 8, unit).bits[:8] == [True, False] * 4
    assert not bus.write_coil(1, True, unit).isError()
    assert words(bus.read_holding_registers(0, 1, unit)) == [0x57]
    refused(bus.write_coil(8, True, unit), ILLEGAL_ADDRESS)
    refused(bus.write_coils(1, [True] * 8, unit), ILLEGAL_ADDRESS)
    refused(bus.read_coils(0, 9, unit), ILLEGAL_ADDRESS)
    assert not any(bus.read_discrete_inputs(0, 16, unit).bits)
    refused(bus.read_discrete_inputs(0, 17, unit), ILLEGAL_ADDRESS)


def registers(bus, port):
    for unit in (1, 17):
        check_tables(bus, unit)
        check_writes(bus, unit)
        check_bits(bus, unit)
    bus.close()
    bus = serial_master(port, 1)
    assert bus.read_coils(0, 1, 5).isError(), "there is no unit 5"
    bus.close()


def registers_of_1(bus, port):
    check_tables(bus, 1)
    check_writes(bus, 1)
    check_bits(bus, 1)


def read_type(bus, port):
    assert words(bus.read_input_registers(0x30, 1, 1)) == [0x0808]


def motion(bus, port):
    assert not bus.write_registers(0x10, [1, 102, 0, 40, 200], 1).isError()
    end = time.monotonic() + LIMIT
    while (status := words(bus.read_input_registers(0x11, 1, 1))[0]) & 1:
        assert time.monotonic() < end
    assert status & 8, "TRG"
    assert words(bus.read_input_registers(0x13, 2, 1)) == [0, 40]


def silence(bus, port):
    """Half a request, and then, behind silence, a whole one; and both halves within it."""
    bus.close()
    control = port + ".control"
    request = bytes.fromhex("010400300002") + b"\x71\xc4"
    answer = bytes.fromhex("01040408080102")
    passed = 0
    with serial.Serial(port, 19200, timeout=LIMIT) as wire:
        for part, pause in ((request[:4], 101000), (request, 10000), (request[:4], 90000), (request[4:], 10000)):
            wire.write(part)
            passed += len(part)
            end = time.monotonic() + LIMIT
            while call(control, "state")["line"]["bytes"] < passed:  # time stands until all of it is there
                assert time.monotonic() < end
            call(control, "advance", ticks=pause)
            if part[-1] == request[-1]:
                assert wire.read(9)[:7] == answer
                passed += 9


def tcp(address):
    host, port = address.rsplit(":", 1)
    bus = ModbusTcpClient(host, port=int(port), timeout=LIMIT, retries=0)
    assert bus.connect()
    check_tables(bus, 17)
    check_writes(bus, 17)
    check_bits(bus, 17)
    refused(bus.read_input_registers(0x30, 1, 9), 0x0B)
    bus.close()
    with socket.create_connection((host, int(port)), timeout=LIMIT) as wrong:  # another protocol: the connection is closed
        wrong.sendall(bytes.fromhex("000100010006010400300001"))
        assert wrong.recv(100) == b""


class Lines:
    """A client of PLCComS: lines with an end of CR LF."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=LIMIT)
        self.file = self.socket.makefile("r", encoding="ascii", newline="\r\n")

    def read(self):
        line = self.file.readline()
        assert line.endswith("\r\n"), line
        return line[:-2]

    def ask(self, line, *answers):
        self.socket.sendall(line.encode() + b"\r\n")
        for answer in answers:
            got = self.read()
            assert got == answer, f"{line}: expected {answer}, got {got}"


def call(control, method, **params):
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(control)
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params}
        connection.sendall(json.dumps(request).encode() + b"\n")
        answer = json.loads(connection.makefile().readline())
        assert "result" in answer, answer
        return answer["result"]


def advance(control, ticks):
    call(control, "advance", ticks=ticks)


def lines(address, control):
    """Z1 to Z4 of the specification, with two clients at a stopped clock."""
    client, other = Lines(address), Lines(address)
    advance(control, 50000)
    client.ask("GET:CIB1.MCA.MCSTAT", "GET:CIB1.MCA.MCSTAT,32")
    client.ask("get:cib1.mca.p*", "GET:CIB1.MCA.P2,0", "GET:CIB1.MCA.P1,0", "GET:CIB1.MCA.POS,0", "GET:")
    client.ask("EN:CIB1.MCA.TRG", "WARNING:252 Changed active variables in public file: '[2/58]'")
    advance(control, 10000)
    for line in ("P1,-3", "P2,100", "CMD,102", "SEQ,1"):
        other.ask(f"SET:CIB1.MCA.{line}", f"DIFF:CIB1.MCA.{line}")
    advance(control, 31000)
    other.ask("GET:CIB1.MCA.POS", "GET:CIB1.MCA.POS,-3")
    advance(control, 9001)
    assert client.read() == "DIFF:CIB1.MCA.TRG,1"
    advance(control, 94999)
    other.ask("SET:CIB1.MCA.SEQ,2", "DIFF:CIB1.MCA.SEQ,2")
    advance(control, 200000)
    assert client.read() == "DIFF:CIB1.MCA.TRG,0"
    assert client.read() == "DIFF:CIB1.MCA.TRG,1"
    for line, answer in (("GET:test", "ERROR:33 Unknown variable name in request: 'GET:test'"),
                         ("FOO:1", "ERROR:32 Unknown command name in request: 'FOO:1'"),
                         ("SET:CIB1.DO,256", "ERROR:35 Wrong parameter value in request: 'SET:CIB1.DO,256'"),
                         ("SET:CIB1.DI,1", "ERROR:21 Unable to send data to PLC.")):
        client.ask(line, answer)
    Lines(address).ask("hello", "ERROR:30 Bad client request: 'hello'")
    client.ask("LIST:*RUN", "LIST:__PLC_RUN,BOOL", "LIST:")


def serial_master(port, timeout):
    bus = ModbusSerialClient(port, baudrate=19200, parity="N", timeout=timeout, retries=0)
    assert bus.connect()
    return bus


def serial_client(what, port):
    bus = serial_master(port, LIMIT)
    {"registers": registers, "registers_of_1": registers_of_1, "type": read_type, "motion": motion,
     "silence": silence}[what](bus, port)
    bus.close()


def main():
    what, *where = sys.argv[1:]
    if what == "tcp":
        tcp(*where)
    elif what == "lines":
        lines(*where)
    else:
        serial_client(what, *where)


if __name__ == "__main__":
    main()
