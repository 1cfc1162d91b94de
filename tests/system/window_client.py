#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""window_client.py CASE ADDRESS: the window as a page of another origin, a careless script or a flood would see it. ADDRESS is
what the program has printed, with the token."""
import base64
import http.client
import json
import os
import socket
import struct
import sys
import time
import urllib.parse

LIMIT = 30


class Closed(Exception):
    pass


class Window:
    def __init__(self, address):
        url = urllib.parse.urlsplit(address)
        self.host, self.port = url.hostname, url.port
        self.name = url.netloc
        self.token = urllib.parse.parse_qs(url.query)["token"][0]
        self.cookie = f"rkm04-{self.port}={self.token}"

    def get(self, path, method="GET", **headers):
        """(status, headers, body)"""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=LIMIT)
        connection.putrequest(method, path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name, value)
        connection.endheaders()
        answer = connection.getresponse()
        return answer.status, dict((name.lower(), value) for name, value in answer.getheaders()), answer.read()

    def socket(self, cookie=None, origin=None, host=None):
        """A WebSocket, or the status with which it was refused."""
        stream = socket.create_connection((self.host, self.port), timeout=LIMIT)
        key = base64.b64encode(os.urandom(16)).decode()
        lines = ["GET /socket HTTP/1.1", f"Host: {host or self.name}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Protocol: rkm04-window"]
        if origin != "":
            lines.append(f"Origin: {origin or 'http://' + self.name}")
        if cookie != "":
            lines.append(f"Cookie: {cookie or self.cookie}")
        stream.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        head = b""
        while b"\r\n\r\n" not in head:
            data = stream.recv(1)
            if not data:
                return "closed"
            head += data
        status = head.split()[1].decode()
        return Socket(stream) if status == "101" else status


class Socket:
    def __init__(self, stream):
        self.stream = stream

    def send(self, text, opcode=1):
        data = text if isinstance(text, bytes) else text.encode()
        length = len(data)
        head = bytes([0x80 | opcode])
        if length < 126:
            head += bytes([0x80 | length])
        elif length < 65536:
            head += struct.pack(">BH", 0x80 | 126, length)
        else:
            head += struct.pack(">BQ", 0x80 | 127, length)
        self.stream.sendall(head + b"\0\0\0\0" + data)

    def read(self, count):
        data = b""
        while len(data) < count:
            more = self.stream.recv(count - len(data))
            if not more:
                raise Closed
            data += more
        return data

    def receive(self):
        opcode, length = self.read(2)
        length &= 127
        if length == 126:
            length = struct.unpack(">H", self.read(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self.read(8))[0]
        data = self.read(length)
        if opcode & 15 == 8:
            raise Closed
        return json.loads(data)

    def ask(self, **request):
        self.send(json.dumps({"id": 7, **request}))
        while True:
            answer = self.receive()
            if answer.get("id") == 7:
                return answer

    def is_closed(self):
        try:
            while True:
                self.receive()
        except (Closed, ConnectionError):
            return True


def same(wanted, got, what):
    if wanted != got:
        sys.exit(f"{what}: expected {wanted!r}, got {got!r}")


def doors(window):
    """Only with the token, under the own name, from the own page."""
    status, headers, _ = window.get(f"/?token={window.token}")
    same(200, status, "with the token")
    cookie = headers["set-cookie"]
    for part in (window.cookie, "HttpOnly", "SameSite=Strict"):
        same(True, part in cookie, f"{part} in {cookie}")
    policy = headers["content-security-policy"]
    same(False, "unsafe" in policy, policy)
    same(True, "default-src 'none'" in policy and "frame-ancestors 'none'" in policy, policy)
    same("nosniff", headers["x-content-type-options"], "type")
    for path in ("/", "/?token=", "/?token=" + "0" * 32, f"/?token={window.token}0", "/main.js",
                 f"/main.js?token={window.token}"):
        same(403, window.get(path)[0], path)
    same(200, window.get("/main.js", Cookie=window.cookie)[0], "main.js with the cookie")
    same(403, window.get("/main.js", Cookie=window.cookie + "0")[0], "main.js with another cookie")
    same(404, window.get("/../etc/passwd", Cookie=window.cookie)[0], "another file")
    same(404, window.get("/download/../window.c", Cookie=window.cookie)[0], "another file")
    same(404, window.get("/download/none.csv", Cookie=window.cookie)[0], "no download")
    for host in ("evil.example", f"evil.example:{window.port}", "127.0.0.1", f"127.0.0.1.nip.io:{window.port}"):
        same(403, window.get(f"/?token={window.token}", Host=host)[0], f"Host {host}")
        same(False, isinstance(window.socket(host=host, origin="http://" + host), Socket), f"a socket for {host}")
    same(200, window.get("/", Host=f"localhost:{window.port}", Cookie=window.cookie)[0], "localhost")
    for origin in ("http://evil.example", f"http://127.0.0.1:{window.port + 1}", f"https://{window.name}", "null", ""):
        same(False, isinstance(window.socket(origin=origin), Socket), f"a socket from {origin}")
    same(False, isinstance(window.socket(cookie=""), Socket), "a socket without the cookie")
    same(False, isinstance(window.socket(cookie="rkm04-1=" + window.token), Socket), "a socket with the cookie of another window")
    same(True, "version" in window.socket().ask(do="hello"), "hello")


def limits(window):
    """Too much of anything ends one page, and no other."""
    good = window.socket()
    same(True, "version" in good.ask(do="hello"), "hello")
    long = window.socket()
    long.send("x" * (256 * 1024 + 1))
    same(True, long.is_closed(), "a message that is too long")
    flood, end = window.socket(), time.monotonic() + LIMIT
    try:
        while time.monotonic() < end:
            flood.send('{"do": "hello"}')
    except ConnectionError:
        pass
    same(True, flood.is_closed(), "a flood")
    others = [window.socket() for _ in range(15)]
    for one in others:
        same(True, "version" in one.ask(do="hello"), "hello")
    one_more = window.socket()
    same(True, not isinstance(one_more, Socket) or one_more.is_closed(), "the 17th page")
    same(True, "version" in good.ask(do="hello"), "hello")
    others.pop().stream.close()
    same(True, "version" in good.ask(do="hello"), "hello")


def nonsense(window, trouble="not a serial device"):
    """Whatever a page sends, the answer names what is wrong."""
    page = window.socket()
    for text in ("", "{", "[]", "7", '"x"', "{}", '{"do": 7}', '{"do": "shutdown"}', '{"do": "open"}',
                 '{"do": "open", "port": ""}',
                 '{"do": "open", "port": "/dev/null", "framing": "x"}', '{"do": "request"}', '{"do": "request", "message": "0"}',
                 '{"do": "request", "message": "zz"}', '{"do": "request", "message": "04", "node": 17}',
                 '{"do": "request", "message": "0231", "poll": true}', '{"do": "send", "text": 1}',
                 '{"do": "send", "text": "", "message_max": 1}', '{"do": "check"}', '{"do": "call"}',
                 '{"do": "call", "method": "shutdown"}', '{"do": "call", "method": "state"}',
                 '{"do": "call", "method": "trace.start", "params": {"file": "../x.csv"}}', "[" * 5000):
        page.send(text)
        while True:
            answer = page.receive()
            if "event" not in answer:
                break
        same(True, isinstance(answer.get("error"), str), f"{text}: {answer}")
    same("lost", page.ask(do="request", message="01")["outcome"], "without a port")
    same("lost", page.ask(do="stop", node=1)["outcome"], "stop without a port")
    answer = page.ask(do="open", port="/dev/null")
    same(True, trouble in answer["trouble"], answer)


def port(window, name):
    """Opens a port, asks, sends a long program, stops."""
    page, other = window.socket(), window.socket()
    same("open", page.ask(do="open", port=name)["outcome"], "open")
    answer = page.ask(do="request", node=1, message="01", timeout_ms=LIMIT * 1000)
    same("answered", answer["outcome"], answer)
    same("01", answer["answer"][:2], answer)
    while other.receive().get("event") != "answer":
        pass
    answer = page.ask(do="send", node=1, motor=1, text="\\ C100 " + "F1 " * 600 + "W16000000", message_max=64,
                      timeout_ms=LIMIT * 1000)
    same(("answered", 0), (answer["outcome"], answer["flag"]), answer)
    same(True, answer["pieces"] > 10 and answer["pieces"] == answer["taken"], answer)
    answer = page.ask(do="stop", node=1)
    same("sent", answer["outcome"], answer)
    same("answered", answer["unit"]["outcome"], answer)
    same("sent", page.ask(do="request", node=0, message="0231" + b"K".hex())["outcome"], "broadcast")
    answer = page.ask(do="request", node=9, message="01", timeout_ms=50)
    same("silent", answer["outcome"], answer)
    same(True, "no answer from unit 9" in answer["trouble"], answer)
    # While a unit is awaited for a minute, stop gives that up.
    page.send('{"id": 1, "do": "request", "node": 9, "message": "01", "timeout_ms": 60000}')
    same("sent", page.ask(do="stop", node=1)["outcome"], "stop in the middle")
    same("closed", page.ask(do="close")["outcome"], "close")


def timeout(window):
    """A port that was opened at the start, and a unit that is not there."""
    answer = window.socket().ask(do="request", node=9, message="01")
    same(True, "no answer from unit 9 within 203 ms" in answer["trouble"], answer)


def tools(window):
    page = window.socket()
    answer = page.ask(do="check", text="F5000 R q", motor=1, language="cs")
    same(["unknown-command"], [one["name"] for one in answer["diagnostics"] if one["severity"] == "error"], answer)
    answer = page.ask(do="check", text="S100 V1000 A2000 F5000 R", motor=1, language="en")
    same([], answer["diagnostics"], answer)
    same(5, len(answer["commands"]), answer)
    same("done", answer["estimate"]["end"], answer)
    same("F5000\nR\n", page.ask(do="format", text="F5000  \n R")["text"], "format")
    same(None, page.ask(do="format", text="x")["text"], "format of what is wrong")


def emulator(window):
    """The states of units come while the page watches; a slow page gets fewer, and the window goes on."""
    page = window.socket()
    page.ask(do="watch", on=True)
    while page.receive().get("event") != "state":
        pass
    page.send('{"id": 1, "do": "call", "method": "di.set", "params": {"di": {"3": 1}}}')
    while True:
        event = page.receive()
        if event.get("event") == "state" and event["state"]["di"] == 4:
            break
    for method, params in [("shutdown", {}), ("subscribe", {"kinds": ["motion"]}), ("subscribe", {"collect": "true"})]:
        answer = page.ask(do="call", method=method, params=params)
        same(True, "unknown method" in answer["error"], answer)


def files(window):
    """A trace that the emulator writes for the window can be downloaded."""
    page = window.socket()

    def call(method, **params):
        page.send(json.dumps({"id": 8, "do": "call", "method": method, "params": params}))
        while True:
            answer = page.receive()
            if answer.get("id") == 8:
                sys.exit(f"{method}: {answer}")
            if answer.get("event") == "called":
                return answer["answer"]["result"]
    call("trace.start", file="short.csv")
    call("trace.stop")
    status, _, body = window.get("/download/short.csv", Cookie=window.cookie)
    same((200, True), (status, len(body) > 0), "the trace")


def awaits(window):
    """Leaves a request that no unit answers."""
    page = window.socket()
    page.ask(do="request", node=1, message="01")
    page.send('{"id": 1, "do": "request", "node": 9, "message": "01", "timeout_ms": 60000}')
    page.ask(do="hello")


def ports(window, *names):
    """These ports are listed, in this order."""
    listed = [one["port"] for one in window.socket().ask(do="ports")["ports"]]
    same(list(names), [name for name in listed if name in names], "ports")


cases = {"awaits": awaits, "doors": doors, "emulator": emulator, "files": files, "limits": limits, "nonsense": nonsense,
         "port": port, "ports": ports, "timeout": timeout, "tools": tools}
cases[sys.argv[1]](Window(sys.argv[2]), *sys.argv[3:])
