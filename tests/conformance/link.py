# SPDX-License-Identifier: MIT
"""link.py: a serial line to a unit: the port, the two framings, requests and answers as bytes."""
import select
import socket
import time

ANSWER_MAX = 9300  # longer than the answer to Get Command of a full memory


class Unreachable(Exception):
    """The line cannot be opened, or is gone."""


class Port:
    """Time is ours, and goes on by itself."""
    now = staticmethod(time.monotonic)

    def wait(self, seconds):
        """Until there is something to read, or for so many seconds. Is there?"""
        return bool(select.select([self], [], [], seconds)[0])


class SerialPort(Port):
    """A device or a pty, 19200 8N1."""

    def __init__(self, path):
        try:
            import serial
        except ImportError:
            raise Unreachable("python3-serial is not there for this python3: apt-get install python3-serial, or run "
                              "/usr/bin/python3 tools/conformance if it is installed; tcp:HOST:PORT does without") from None
        self.error = serial.SerialException
        try:
            self.port = serial.Serial(path, 19200, timeout=0, exclusive=True)
        except (serial.SerialException, ValueError) as error:
            raise Unreachable(f"cannot open {path}: {error}") from None

    def fileno(self):
        return self.port.fileno()

    def write(self, data):
        try:
            self.port.write(data)
            self.port.flush()
        except (self.error, OSError) as error:
            raise Unreachable(f"the line is gone: {error}") from None

    def read(self):
        try:
            return self.port.read(4096)
        except (self.error, OSError) as error:
            raise Unreachable(f"the line is gone: {error}") from None


class TcpPort(Port):
    """tcp:HOST:PORT, bytes as they are (rkm04 serve --tcp, ser2net raw)."""

    def __init__(self, address):
        host, _, port = address.rpartition(":")
        try:
            self.socket = socket.create_connection((host.strip("[]"), int(port)), timeout=10)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        except (OSError, ValueError, OverflowError) as error:
            raise Unreachable(f"cannot connect to {address}: {error}") from None

    def fileno(self):
        return self.socket.fileno()

    def write(self, data):
        try:
            self.socket.sendall(data)
        except OSError as error:
            raise Unreachable(f"the line is gone: {error}") from None

    def read(self):
        try:
            data = self.socket.recv(4096)
        except OSError as error:
            raise Unreachable(f"the line is gone: {error}") from None
        if not data:
            raise Unreachable("the line was closed at the other end")
        return data


def open_port(name):
    return TcpPort(name[4:]) if name.startswith("tcp:") else SerialPort(name)


def fcs16(data):
    """FCS-16 of RFC 1662."""
    fcs = 0xFFFF
    for byte in data:
        fcs ^= byte
        for _ in range(8):
            fcs = fcs >> 1 ^ 0x8408 if fcs & 1 else fcs >> 1
    return fcs ^ 0xFFFF


class Hdlc:
    """SPEC L1."""
    name = "hdlc"

    @staticmethod
    def frame(node, message):
        body = bytes([node, 0]) + message
        body += fcs16(body).to_bytes(2, "little")
        return b"\x7e" + body.replace(b"\x7d", b"\x7d\x5d").replace(b"\x7e", b"\x7d\x5e") + b"\x7e"

    @staticmethod
    def take(heard, node):
        """The message of the first whole frame in what was received; None: there is none yet. ValueError: it is wrong."""
        begin = heard.find(b"\x7e")
        while begin >= 0:
            end = heard.find(b"\x7e", begin + 1)
            if end < 0:
                return None
            if end > begin + 1:
                break
            begin = end
        else:
            return None
        if begin > 0:
            raise ValueError("bytes before the frame")
        body, escaped = bytearray(), False
        for byte in heard[begin + 1:end]:
            if byte == 0x7D:
                escaped = True
            else:
                body.append(byte ^ 0x20 if escaped else byte)
                escaped = False
        if len(body) < 5 or fcs16(body[:-2]).to_bytes(2, "little") != body[-2:]:
            raise ValueError("the check value of the frame is wrong")
        if body[0] != 0 or body[1] != node:
            raise ValueError(f"from node {body[1]} to node {body[0]}, expected from {node} to 0")
        return bytes(body[2:-2])


class Plain:
    """SPEC L2."""
    name = "plain"

    @staticmethod
    def frame(node, message):
        return bytes([node]) + len(message).to_bytes(2, "big") + message

    @staticmethod
    def take(heard, node):
        if len(heard) < 3 or len(heard) < 3 + int.from_bytes(heard[1:3], "big"):
            return None
        if heard[0] != node:
            raise ValueError(f"from node {heard[0]}, expected from {node}")
        return bytes(heard[3:3 + int.from_bytes(heard[1:3], "big")])


FRAMINGS = {"hdlc": Hdlc, "plain": Plain}


class Line:
    """Requests and answers. transcript: what passed, as lines of hexadecimal bytes."""

    def __init__(self, port, framing, node, timeout):
        self.port, self.framing, self.node, self.timeout = port, framing, node, timeout
        self.transcript = []

    def note(self, who, data):
        if len(self.transcript) < 400 and data:
            self.transcript.append(f"{who} {data[:200].hex(' ')}{' ...' if len(data) > 200 else ''}")

    def drain(self):
        """Forget what has come in."""
        while self.port.wait(0) and self.port.read():
            pass

    def say(self, data):
        self.drain()
        self.note("-->", data)
        self.port.write(data)

    def hear(self, whole, timeout):
        """Bytes until whole(bytes) is true or none has come for `timeout` seconds."""
        heard = b""
        while not whole(heard) and len(heard) < ANSWER_MAX * 2:
            if not self.port.wait(timeout):
                break
            heard += self.port.read()
        self.note("<--", heard)
        return heard

    def ask(self, message, node=None):
        """The answer to a message; None: silence. ValueError: something else than a proper frame came."""
        frame = self.framing.frame(self.node if node is None else node, message)
        self.say(frame)
        # a request of n bytes is on the line for n * 10 / 19200 s, which a driver may hide from us
        heard = self.hear(self.whole, self.timeout + len(frame) * 10 / 19200)
        if not heard:
            return None
        answer = self.framing.take(heard, self.node)
        if answer is None:
            raise ValueError(f"no whole frame: {heard[:40].hex(' ')}")
        return answer

    def whole(self, heard):
        try:
            return self.framing.take(heard, self.node) is not None
        except ValueError:
            return True

    def silent(self, seconds):
        """What comes within so many seconds, b"" if nothing does."""
        end = self.port.now() + seconds
        heard = b""
        while (left := end - self.port.now()) > 0 and self.port.wait(left):
            heard += self.port.read()
        self.note("<--", heard)
        return heard
