# SPDX-License-Identifier: MIT
"""Clients over TCP that come again at once: tcp_client.py WHAT PORT [TIMES]. An exception is a failed test."""
import socket
import sys

REQUEST, ANSWER = bytes.fromhex("7e01000858107e"), bytes.fromhex("7e0001ff080000dbff7e")
BROADCAST = bytes.fromhex("7e00000158107e")


def session(sent, wanted):
    """Connect, send, receive what is wanted, close."""
    with socket.create_connection(("127.0.0.1", int(sys.argv[2])), timeout=30) as client:
        client.sendall(sent)
        heard = b""
        while len(heard) < len(wanted):
            part = client.recv(100)
            assert part, heard
            heard += part
        assert heard == wanted, heard


def again():
    """What has gone does not keep out what comes: a broadcast, and more than the units can receive in half a minute."""
    for _ in range(int(sys.argv[3]) if len(sys.argv) > 3 else 100):
        session(BROADCAST, b"")
        session(REQUEST, ANSWER)
    session(bytes(60000), b"")
    session(REQUEST, ANSWER)


def refused():
    """Many who are sent away."""
    for _ in range(300):
        session(b"", b"rkm04: refused: the bus is in use by a client of the pty\r\n")


{"again": again, "refused": refused}[sys.argv[1]]()
