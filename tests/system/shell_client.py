#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A person at `rkmctl shell`: shell_client.py RKMCTL ARGUMENT...: types what stands on standard input, a line for each line that
comes back with a prompt (behind one that ends with ... none comes), and prints all that was
shown. \\t is Tab, ^C the interrupt, ^D the end; ! COMMAND is done elsewhere."""
import os
import pty
import select
import subprocess
import sys
import time

LIMIT = 60.0
PROMPT = b"> "


found = 0  # where what was waited for last ends: pieces that are read may have more than that


def read_until(terminal, shown, part):
    """Read until `part` has been shown behind what was waited for last."""
    global found
    end = time.monotonic() + LIMIT
    while (at := shown.find(part, found)) < 0:
        if time.monotonic() > end or not select.select([terminal], [], [], LIMIT)[0]:
            sys.exit(f"not within {LIMIT:g} s: {part!r}; shown: {bytes(shown)!r}")
        try:
            piece = os.read(terminal, 4096)
        except OSError:
            return False
        if not piece:
            return False
        shown += piece
    found = at + len(part)
    return True


def wait_for_end(child, terminal, shown):
    """Wait until the shell has ended, reading what it still shows."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        if not select.select([terminal], [], [], 1)[0]:
            continue
        try:
            piece = os.read(terminal, 4096)
        except OSError:
            piece = b""
        if not piece:
            return os.waitpid(child, 0)[1]
        shown += piece
    sys.exit(f"the shell has not ended within {LIMIT:g} s; shown: {bytes(shown)!r}")


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
        elif keys == b"^D":
            os.write(terminal, b"\x04")
        elif line.startswith("! "):
            subprocess.run(line[2:], shell=True, check=True, stdout=subprocess.DEVNULL)
            continue
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
    status = wait_for_end(child, terminal, shown)
    sys.stdout.write(shown.decode(errors="replace"))
    sys.exit(os.waitstatus_to_exitcode(status))


main()
