#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A client of the CNC872's control socket that advances time and does not read at once: no event of a cell is lost, and the
emulator does not gather them all. Arguments: the socket, the process id of the emulator."""

import json
import select
import socket
import sys

CELL, CELLS, TURNS = "DWRD.FILETIME_INFO.LOW_FILETIME", 64, 4000
MEMORY = 100 << 20  # bytes more than before: the events are 150 MB


def memory(process):
    """Bytes in memory."""
    with open(f"/proc/{process}/statm") as file:
        return int(file.read().split()[1]) * 4096


path, process = sys.argv[1:]
client = socket.socket(socket.AF_UNIX)
client.settimeout(60)
client.connect(path)
stream = client.makefile("rw")


def send(number, method, **params):
    """Send a request."""
    stream.write(json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}) + "\n")
    stream.flush()


before = memory(process)
send(1, "subscribe", cells=[CELL] * CELLS)
print(sorted(json.loads(stream.readline())["result"]["cells"]))
send(2, "advance", ticks=TURNS * 1000 + 1)
other = socket.socket(socket.AF_UNIX)
other.settimeout(60)
other.connect(path)
other.sendall(b'{"jsonrpc": "2.0", "id": 1, "method": "units"}\n')
select.select([other], [], [], 60)  # answered while the first client does not read
print("units" in other.recv(65536).decode())
counts, last = {}, None
while last is None or "id" not in last:
    last = json.loads(stream.readline())
    if last.get("method") == "event":
        counts[last["params"]["t_us"]] = counts.get(last["params"]["t_us"], 0) + 1
print(last["result"], set(counts.values()), len(counts), memory(process) - before < MEMORY)
