# SPDX-License-Identifier: MIT
"""A control client that leaves the emulator without a free descriptor, as faults.sh runs it: descriptors_client.py CONTROL LOG.
It clears the faults then, waits until the log says that there is no new pty, and lets everything go."""
import json
import socket
import sys
import time

control, log = sys.argv[1:]
LIMIT = 60  # seconds until a condition counts as never coming true


def connect():
    client = socket.socket(socket.AF_UNIX)
    client.settimeout(LIMIT)
    client.connect(control)
    return client


def ask(client, method):
    client.sendall(json.dumps({"jsonrpc": "2.0", "id": 1, "method": method}).encode() + b"\n")
    answer = b""
    while not answer.endswith(b"\n"):
        part = client.recv(4096)
        if not part:
            return None
        answer += part
    return json.loads(answer)


first, crowd = connect(), []
while len(crowd) < 100:
    crowd.append(connect())
    try:
        if ask(crowd[-1], "fault.list") is None:
            break  # it was let in and closed: there is no descriptor left
    except ConnectionError:
        break
assert len(crowd) < 100, "descriptors without end"
assert "result" in ask(first, "fault.clear")
end = time.monotonic() + LIMIT
while "cannot plug the adapter in again: trying every second" not in open(log, encoding="utf-8").read():
    assert time.monotonic() < end, "nothing is said"
    time.sleep(0.02)
assert "result" in ask(first, "fault.list"), "it answers"
