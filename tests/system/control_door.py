# SPDX-License-Identifier: MIT
"""control_door.py: the control socket over TCP: who is let in, and what those see who are not.

    CONTROL=tcp:0 RKM04=… RKMCTL=… control_door.py CASE"""
import json
import os
import socket
import subprocess
import sys
import time

import control_robust
from control_client import LIMIT, Client, entrance, soon

WRONG = {"code": -32001, "message": "token: wrong: expected that of the control file"}
FIRST = {"code": -32001, "message": "expected the method `authenticate' with the token of the control file first"}
TOO_LONG = {"code": -32001, "message": FIRST["message"] + ", in a line of at most 512 bytes"}
STRANGER = 5  # seconds that a stranger may stay
UNITS = b'{"jsonrpc":"2.0","id":1,"method":"units"}\n'


def stranger(emulator):
    """A connection that has not shown the token."""
    emulator.clients.append(Client(emulator.path, admit=False))
    return emulator.clients[-1]


def in_time(emulator, attempt):
    """Something that a machine can do before a stranger's time is over; one that takes longer has to do it again."""
    files = emulator.files()
    for _ in range(10):
        begin = time.monotonic()
        try:
            return attempt(files)
        except (AssertionError, OSError):
            if time.monotonic() - begin < STRANGER:
                raise
        for client in emulator.clients:
            client.close()
        soon("all of them are gone", lambda: emulator.files() == files)
    raise AssertionError("the machine is too slow")


def greeting(token):
    return json.dumps({"jsonrpc": "2.0", "id": 1, "method": "authenticate", "params": {"token": token}}).encode() + b"\n"


def ended(client):
    """All of it has been read, and the connection is closed."""
    try:
        return client.line() is None
    except ConnectionResetError:
        return True


def test_the_file_is_for_the_user_alone_and_goes_with_the_emulator(emulator):
    assert os.stat(emulator.path).st_mode & 0o7777 == 0o600
    family, address, token = entrance(emulator.path)
    assert family == socket.AF_INET and address[0] == "127.0.0.1" and len(token) == 64, (address, token)
    ready = emulator.client().call("ready")
    assert ready["control"] == emulator.path and ready["control_tcp"] == f"127.0.0.1:{address[1]}", ready
    emulator.process.terminate()
    emulator.process.wait(timeout=LIMIT)
    assert not os.path.exists(emulator.path) and not os.path.exists(emulator.path + ".lock")


def test_the_right_token_lets_in_once_and_requests_may_follow_at_once(emulator):
    client = stranger(emulator)
    client.send(greeting(entrance(emulator.path)[2]) + UNITS * 3)
    assert client.line() == {"jsonrpc": "2.0", "id": 1, "result": {}}
    for _ in range(3):
        assert client.line()["result"]["units"] == ["1"]
    assert client.refused("authenticate", token=entrance(emulator.path)[2]).code == -32601


def test_each_wrong_beginning_gets_one_answer_and_the_end(emulator):
    token = entrance(emulator.path)[2]
    other = token[:-1] + ("0" if token[-1] != "0" else "1")
    for line, error in [(greeting(other), WRONG), (greeting(""), WRONG), (greeting(token + "0"), WRONG),
                        (greeting(token.upper()) if token.upper() != token else greeting(other), WRONG),
                        (greeting(token[:-1] + "\0"), None), (UNITS, FIRST), (greeting(7), FIRST), (greeting(None), FIRST),
                        (greeting(token).replace(b"authenticate", b"shutdown"), FIRST),
                        (greeting(token).replace(b"}}", b', "more": 1}}'), FIRST),
                        (b"[" + greeting(token)[:-1] + b"]\n", None), (b"POST / HTTP/1.1\r\nHost: x\r\n\r\n" + UNITS, None),
                        (b"x" * 600, TOO_LONG), (b"x" * 600 + b"\n", TOO_LONG), (b"{" * 500 + b"\n", None),
                        (b" " * 20 + greeting(other) + greeting(token) + UNITS, WRONG)]:
        client = stranger(emulator)
        client.send(line)
        answer = client.line()
        assert "result" not in answer and (error is None or answer["error"] == error), (line[:90], answer)
        assert ended(client), line[:90]
    assert emulator.client().call("units")["units"] == ["1"]


def test_a_wrong_token_in_a_notification_is_answered_too(emulator):
    client = stranger(emulator)
    client.send(b'{"jsonrpc":"2.0","method":"authenticate","params":{"token":"x"}}\n')
    assert client.line() == {"jsonrpc": "2.0", "id": None, "error": WRONG}
    assert ended(client)


def test_the_answer_comes_although_the_client_sends_on(emulator):
    client = stranger(emulator)
    client.send(b"GET / HTTP/1.1\r\n" + b"x" * 50000)
    assert client.line()["error"]["code"] == -32700
    assert ended(client)


def test_a_flood_after_the_refusal_is_cut(emulator):
    client = stranger(emulator)
    client.socket.settimeout(LIMIT)
    sent = 0
    try:
        while sent < 1 << 24:
            sent += client.socket.send(b"x\n" * 65536)
    except (BrokenPipeError, ConnectionResetError):
        pass
    assert sent < 1 << 24, sent
    assert emulator.client().call("units")["units"] == ["1"]


def test_strangers_are_few_and_the_oldest_makes_room(emulator):
    def crowd(files):
        emulator.client()
        strangers = [stranger(emulator) for _ in range(20)]
        for client in strangers[:12]:
            assert ended(client)
        soon("the rest are there", lambda: emulator.files() == files + 1 + 8)
        strangers[-1].send(greeting(entrance(emulator.path)[2]) + UNITS)
        assert strangers[-1].line()["result"] == {}
        assert strangers[-1].line()["result"]["units"] == ["1"]
        for client in strangers[12:-1]:
            assert client.silent()

    in_time(emulator, crowd)


def test_who_holds_connections_open_keeps_nobody_out(emulator):
    idle = [stranger(emulator) for _ in range(8)]
    for _ in range(20):
        assert emulator.client().call("units")["units"] == ["1"]
    for client in idle[-1:]:
        client.close()


def test_a_stranger_has_little_time(emulator):
    client, half = stranger(emulator), stranger(emulator)
    half.send(greeting("x")[:20])
    assert ended(client) and ended(half)  # within LIMIT
    assert emulator.client().call("units")["units"] == ["1"]


def test_strangers_do_not_count_as_clients(emulator):
    def crowd(_files):
        clients = [emulator.client() for _ in range(64)]
        strange = [stranger(emulator) for _ in range(8)]
        assert clients[0].call("units")["units"] == ["1"]
        strange[0].send(greeting(entrance(emulator.path)[2]))
        assert strange[0].line()["error"] == {"code": -32000, "message": "too many clients: expected at most 64 at a time"}
        assert ended(strange[0])

    in_time(emulator, crowd)


def test_who_has_ended_its_sending_gets_its_answers_but_nothing_later(emulator):
    client, other = stranger(emulator), emulator.client()
    client.send(greeting(entrance(emulator.path)[2]) + UNITS * 2000 +
                b'{"jsonrpc":"2.0","id":2,"method":"wait","params":{"until":{"di":{"1":1}}}}\n' + UNITS)
    client.socket.shutdown(socket.SHUT_WR)
    assert client.line()["result"] == {}
    for _ in range(2001):
        assert client.line()["result"]["units"] == ["1"]
    assert ended(client)
    other.call("di.set", mask=1)


def test_what_a_client_waits_for_ends_with_it(emulator):
    other = emulator.client()
    files = emulator.files()
    emulator.program(1, "G+") # when its client goes, the emulator closes a file for a moment
    for request in [b'{"jsonrpc":"2.0","id":2,"method":"wait","params":{"until":{"di":{"1":1}}}}\n',
                    b'{"jsonrpc":"2.0","id":2,"method":"subscribe"}\n',
                    b'{"jsonrpc":"2.0","id":2,"method":"advance","params":{"ticks":"1000000s"}}\n' + UNITS]:
        client = Client(emulator.path)
        client.send(request)
        client.close()
    soon("all of them are gone", lambda: emulator.files() == files)
    assert other.call("advance", ticks=1)["t_us"] < 10 ** 12


def test_only_addresses_of_this_machine_alone_are_taken(emulator):
    del emulator
    program = os.environ["RKM04"]
    for address in ["0.0.0.0:0", "192.0.2.1:0", "[::]:0", "example.com:0", "[::ffff:127.0.0.1]:0", "", "localhost", "127.0.0.1",
                    "127.0.0.1:65536", "localhost.example.com:0", "[fe80::1]:0", "127.0.0.1:0:0"]:
        done = subprocess.run([program, "serve", "--control", "tcp:" + address], capture_output=True, timeout=LIMIT, check=False)
        assert done.returncode == 2 and b"expected tcp: and PORT" in done.stderr, (address, done)
    done = subprocess.run([program, "serve", "--control", "tcp:127.0.0.example.com:0"], capture_output=True, timeout=LIMIT,
                          check=False)
    assert done.returncode == 1 and b"cannot listen" in done.stderr, done


def main():
    sys.exit(not all([control_robust.run(name, globals()[name]) for name in sys.argv[1:]]))


main()
