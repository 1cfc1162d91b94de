#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A client of the CNC872's control socket that asks what cells have been, in place of an event for each T. Argument: the socket.
The PLC program of the emulator sets BLIP for one T in 100, and counts in COUNT."""

import sys

from control_client import Client

CELLS = ["BLIP", "COUNT", "PO_F"]

client, other = Client(sys.argv[1]), Client(sys.argv[1])
assert client.call("subscribe", cells=CELLS, collect=True) == {
    "t_us": 0, "subscription": 1, "cells": {"BLIP": 0, "COUNT": 0, "PO_F": 0}}
assert client.call("collected", subscription=1) == {"t_us": 0, "cells": {}}
other.call("advance", ticks="1050ms")
assert client.silent(), "no event is sent"
assert client.call("collected", subscription=1)["cells"] == {
    "BLIP": {"value": 0, "changes": 20, "least": 0, "greatest": 1},
    "COUNT": {"value": 1049, "changes": 1049, "least": 1, "greatest": 1049}}
assert client.call("collected", subscription=1)["cells"] == {}, "what has been told is not told again"
other.call("advance", ticks="1s")
other.call("cnc.set", cells={"COUNT": 3})
other.call("advance", ticks="1ms")
assert client.call("collected", subscription=1)["cells"]["COUNT"]["least"] == 4
other.call("cnc.set", cells={"COUNT": 32768})
other.call("advance", ticks="1ms")
assert client.call("collected", subscription=1)["cells"] == {
    "COUNT": {"value": 32769, "changes": 1, "least": 32769, "greatest": 32769}}

# What is refused; a refusal leaves no subscription.
for wrong, said in [({"cells": CELLS, "collect": 1}, "collect: expected true or false"),
                    ({"collect": True}, "collect: expected cells, and no kinds"),
                    ({"cells": CELLS, "kinds": ["motion"], "collect": True}, "collect: expected cells, and no kinds"),
                    ({"cells": ["PO_F", "NONE"], "collect": True}, "NONE")]:
    assert said in client.refused("subscribe", **wrong).message, wrong
assert "has no subscription 2" in client.refused("collected", subscription=2).message
assert "has no subscription 1" in other.refused("collected", subscription=1).message
assert client.call("subscribe", cells=["PO_F"])["subscription"] == 2
assert "2 sends events" in client.refused("collected", subscription=2).message
client.call("unsubscribe", subscription=1)
assert "has no subscription 1" in client.refused("collected", subscription=1).message

# All 256 cells may be collected, of several clients; they are free again with the connection.
many = Client(sys.argv[1])
for _ in range(3):
    many.call("subscribe", cells=["BLIP"] * 64, collect=True)
assert "at most 256" in many.refused("subscribe", cells=["BLIP"] * 64, collect=True).message
many.call("subscribe", cells=["BLIP"] * 63, collect=True)
other.call("advance", ticks="200ms")
for number in range(1, 5):
    assert many.call("collected", subscription=number)["cells"]["BLIP"]["changes"] == 4, number
print("done")
