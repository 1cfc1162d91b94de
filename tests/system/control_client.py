# SPDX-License-Identifier: MIT
"""control_client.py: a client of the control socket, as small as can be, for the system tests."""
import json
import os
import select
import socket
import stat
import time

LIMIT = 60  # seconds until something counts as never coming


class Refused(Exception):
    """An error answer."""

    def __init__(self, error):
        super().__init__(f"{error['code']}: {error['message']}")
        self.code, self.message = error["code"], error["message"]


def entrance(path):
    """(family, address, token) of a control socket, or of a control file."""
    if stat.S_ISSOCK(os.stat(path).st_mode):
        return socket.AF_UNIX, path, None
    with open(path, encoding="ascii") as file:
        address, token = file.read().split()
    host, port = address[len("tcp:"):].rsplit(":", 1)
    return (socket.AF_INET6 if host[0] == "[" else socket.AF_INET), (host.strip("[]"), int(port)), token


class Client:
    """path: of a control socket, or of a control file; with admit=False its token is not shown."""

    def __init__(self, path, receive_buffer=None, admit=True):
        family, address, token = entrance(path)
        self.socket = socket.socket(family, socket.SOCK_STREAM)
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(LIMIT)
        self.socket.connect(address)
        self.buffer = b""
        self.last = 0
        self.events = []  # notifications that came before answers
        if token and admit:
            self.call("authenticate", token=token)
            self.last = 0

    def send(self, data):
        self.socket.sendall(data)

    def line(self):
        """The next line as an object; None: the connection has been closed."""
        while b"\n" not in self.buffer:
            more = self.socket.recv(1 << 20)
            if not more:
                return None
            self.buffer += more
        line, self.buffer = self.buffer.split(b"\n", 1)
        return json.loads(line)

    def silent(self, seconds=0.0):
        """Is there nothing to be read?"""
        return b"\n" not in self.buffer and not select.select([self.socket], [], [], seconds)[0]

    def request(self, method, **params):
        self.last += 1
        request = {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}
        self.send(json.dumps(request).encode() + b"\n")
        return self.last

    def answer(self, number):
        """The answer to a request; events before it are kept."""
        while True:
            line = self.line()
            assert line is not None, "the connection was closed"
            if "id" not in line:
                self.events.append(line)
            elif line["id"] == number:
                if "error" in line:
                    raise Refused(line["error"])
                return line["result"]
            else:
                raise AssertionError(f"expected the answer to {number}, got {line}")

    def call(self, method, **params):
        return self.answer(self.request(method, **params))

    def refused(self, method, **params):
        """The error of a request that has to be refused."""
        try:
            result = self.call(method, **params)
        except Refused as error:
            return error
        raise AssertionError(f"{method} {params}: expected to be refused, got {result}")

    def close(self):
        self.socket.close()


def soon(what, condition):
    """Wait until the condition holds."""
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end, f"not within {LIMIT} s: {what}"
        time.sleep(0.01)
