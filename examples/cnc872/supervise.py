#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Supervise the mill over the control socket, a round trip a cycle: feed down to 50 % while X is between 15 and 25 mm.

    rkm04 serve --device cnc872 --config mill.xml --plc mill.plc --nc part.nc --clock stepped --control ./mill.control
    python3 supervise.py ./mill.control

On Windows, and with --control tcp:PORT, ./mill.control is a file with address and token (--control-file ./mill.control)."""
import json
import os
import socket
import stat
import sys

MM = 65536000  # u


class Cnc:
    def __init__(self, path):
        token = None
        if stat.S_ISSOCK(os.stat(path).st_mode):
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.connect(path)
        else:
            with open(path, encoding="ascii") as file:
                address, token = file.read().split()  # "tcp:127.0.0.1:40123 5596f4..."
            host, port = address.removeprefix("tcp:").rsplit(":", 1)
            self.socket = socket.create_connection((host.strip("[]"), int(port)))
        self.lines = self.socket.makefile("rw")
        self.number = 0
        if token:
            self.call("authenticate", token=token)

    def call(self, method, **params):
        self.number += 1
        self.lines.write(json.dumps({"jsonrpc": "2.0", "id": self.number, "method": method, "params": params}) + "\n")
        self.lines.flush()
        answer = json.loads(self.lines.readline())
        if "error" in answer:
            sys.exit(f"{method}: {answer['error']['message']}")
        return answer["result"]


def main():
    cnc = Cnc(sys.argv[1])
    cnc.call("cnc.panel", start=True)
    want = ["SF_STOP", "POSITION_POS5_EX[0]", "VYSOVERS"]
    feed, changes, cycle = 1000, [], cnc.call("cnc.exchange", slots=1, get=want)
    while not cycle["cells"]["SF_STOP"]:
        x = cycle["cells"]["POSITION_POS5_EX[0]"] / MM
        wanted = 500 if 15 < x < 25 else 1000  # per mille
        if wanted != feed:
            feed = wanted
            changes.append(f"T {cycle['t']}: X {x:.3f} mm, feed {feed // 10} %")
        cycle = cnc.call("cnc.exchange", set={"FEED_OVR_MULTIPLIER": feed}, slots=1, get=want)
    print(*changes, sep="\n")
    print(f"end after {cycle['t']} ms, X {cycle['cells']['POSITION_POS5_EX[0]'] / MM:.3f} mm")


if __name__ == "__main__":
    main()
