# SPDX-License-Identifier: MIT
"""Host software with pyserial, as pyserial.sh runs it: pyserial_client.py WHAT URL. An exception is a failed test."""
import sys
import time

import serial

LIMIT = 60  # seconds until an answer counts as never coming
# Frames of --framing plain: an unknown message (all bytes FF, which RFC 2217 has to double), and Get Position of motor 1.
UNKNOWN = bytes.fromhex("01 00 01 ff"), bytes.fromhex("01 00 04 ff ff 00 00")
POSITION = bytes.fromhex("01 00 02 04 31"), bytes.fromhex("01 00 0d 04 31 0a 20 20 20 20 20 20 20 20 20 30")


def opened(url, **settings):
    settings = {"baudrate": 19200, "timeout": LIMIT, **settings}
    return serial.serial_for_url(url, **settings)


def ask(port, exchange):
    request, wanted = exchange
    port.write(request)
    answer = port.read(len(wanted))
    assert answer == wanted, f"expected {wanted.hex(' ')}, got {answer.hex(' ')}"


def talk(url):
    """Open, talk, close, and all that again."""
    for _ in range(3):
        with opened(url) as port:
            for exchange in UNKNOWN, POSITION, UNKNOWN:
                ask(port, exchange)


def reset(url):
    """What has come in is forgotten. The line has to be without pace, so that an answer comes in one piece."""
    with opened(url) as port:
        port.write(POSITION[0])
        end = time.monotonic() + LIMIT
        while not port.in_waiting and time.monotonic() < end:
            time.sleep(0.01)
        assert port.in_waiting
        port.reset_input_buffer()
        assert port.in_waiting == 0, port.in_waiting
        port.reset_output_buffer()
        ask(port, UNKNOWN)


def settings(url):
    """Every setting is taken; the line is what it was when all is set back."""
    with opened(url) as port:
        for values in ({"baudrate": [50, 1200, 9600, 115200, 4000000, 19200]}, {"bytesize": [5, 6, 7, 8]},
                       {"parity": list("EOMSN")}, {"stopbits": [2, 1.5, 1]}, {"xonxoff": [True, False]},
                       {"rtscts": [True, False]}, {"dsrdtr": [True, False]}):
            for name, each in values.items():
                for value in each:
                    setattr(port, name, value)
                    assert getattr(port, name) == value
        ask(port, POSITION)


def lines(url):
    """Modem lines and break."""
    with opened(url) as port:
        for level in False, True, False, True:
            port.rts = level
            port.dtr = level
        assert (port.cts, port.dsr, port.cd, port.ri) == (True, True, True, False)
        port.send_break(0.05)
        port.break_condition = True
        port.break_condition = False
        ask(port, POSITION)
    with opened(url + ("&" if "?" in url else "?") + "poll_modem") as port:
        assert port.cts


def keep(url):
    """Keep the line until standard input ends."""
    with opened(url) as port:
        ask(port, UNKNOWN)
        print("open", flush=True)
        sys.stdin.read()
        ask(port, UNKNOWN)


def slow(url, seconds=LIMIT):
    """A client of 9600 baud asks twice and prints what it receives."""
    with opened(url, baudrate=9600, timeout=seconds) as port:
        for _ in range(2):
            port.write(POSITION[0])
            print(port.read(len(POSITION[1])).hex(), flush=True)


def garbled(url):
    """The same on a line on which no answer comes whole: what comes within half a second."""
    slow(url, 0.5)


def exclusive(url):
    """A client that keeps others out comes again at once, many times; a second one beside it is kept out."""
    for _ in range(1000):
        with opened(url, exclusive=True) as port:
            ask(port, UNKNOWN)
    with opened(url, exclusive=True) as port:
        try:
            opened(url, exclusive=True)
        except serial.SerialException:
            ask(port, POSITION)
        else:
            raise AssertionError("two have it for themselves")


what, where = sys.argv[1:]
cases = {"talk": talk, "reset": reset, "settings": settings, "lines": lines, "keep": keep, "slow": slow, "garbled": garbled,
         "exclusive": exclusive}
cases[what](where)
