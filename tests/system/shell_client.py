#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A person at `rkmctl shell`: shell_client.py RKMCTL ARGUMENT...: types what stands on standard input, a line for each line that
comes back with a prompt (behind one that ends with ... none comes), and prints all that was
shown. \\t is Tab, ^C the interrupt, ^D the end."""
import os
import pty
import select
import sys
import time

LIMIT = 20.0
PROMPT = b"> "


def read_until(terminal, shown, part):
    """Read until `part` has been shown behind what was there before."""
    begin, end = len(shown), time.monotonic() + LIMIT
    while part not in shown[begin:]:
        if time.monotonic() > end or not select.select([terminal], [], [], LIMIT)[0]:
            sys.exit(f"not within {LIMIT:g} s: {part!r}; shown: {bytes(shown)!r}")
        try:
            piece = os.read(terminal, 4096)
        except OSError:
            return False
        if not piece:
            return False
        shown += piece
    return True


def main():
    child, terminal = pty.fork()
    if child == 0:
        os.environ["TERM"] = "dumb"
        os.execv(sys.argv[1], sys.argv[1:])
    shown = bytearray()
    read_until(terminal, shown, PROMPT)
    for line in sys.stdin.read().splitlines():
        stays = line.endswith("...")  # the command does not end by itself
        keys = line.removesuffix("...").replace("\\t", "\t").encode()
        if line == "^C":
            os.write(terminal, b"\x03")
        elif line == "^D":
            os.write(terminal, b"\x04")
        elif line.startswith("wait for "):
            read_until(terminal, shown, line[9:].encode())
            continue
        else:
            os.write(terminal, keys + b"\n")
        if line in ("^D", "quit"):
            break
        for _ in range(2 if "\\t" in line else 1):  # a completed line is drawn anew, with its prompt
            if not stays:
                read_until(terminal, shown, PROMPT)
    _, status = os.waitpid(child, 0)
    sys.stdout.write(shown.decode(errors="replace"))
    sys.exit(os.waitstatus_to_exitcode(status))


main()
