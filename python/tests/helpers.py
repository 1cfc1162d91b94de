# SPDX-License-Identifier: MIT
"""Frames that the tests send and expect."""

VERSION = bytes.fromhex("7E010001998D7E")
VERSION_ANSWER = bytes.fromhex("7E0001011030312E30322C30362E30332E323030398AFA7E")
BYTE_US = 521
"""The time of a byte, rounded up."""
