# SPDX-License-Identifier: MIT
"""The front panel in a terminal of its own, as ctl_panel.sh runs it:

    panel_client.py ROWS COLUMNS PROGRAM ARGUMENT... -- STEP...

Steps: see:TEXT, gone:TEXT until the screen shows it, or no more; keys:TEXT; size:ROWSxCOLUMNS; colours:NAME,... those that are
there; print: the screen; run:COMMAND of the shell beside it; signal:NAME; status:N until the program has ended so (negative: by
that signal) and left the terminal as it was. An exception is a failed test."""
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

import pyte

LIMIT = 60  # seconds until something counts as never coming


class Terminal:
    def __init__(self, rows, columns, command):
        self.screen = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.said = b""
        self.master, self.slave = pty.openpty()  # the slave is held, so that what is said last is not lost
        self.resize(rows, columns)
        self.before = termios.tcgetattr(self.slave)
        self.program = os.fork()
        if self.program == 0:
            os.setsid()
            fcntl.ioctl(self.slave, termios.TIOCSCTTY, 0)
            for descriptor in 0, 1:
                os.dup2(self.slave, descriptor)
            os.execvp(command[0], command)

    def resize(self, rows, columns):
        self.screen.resize(rows, columns)
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def read(self, seconds):
        if select.select([self.master], [], [], seconds)[0]:
            data = os.read(self.master, 65536)
            self.said += data
            self.stream.feed(re.sub(rb"\x1b\[\?1(;[0-9]+)*[hl]|\x1b\(B", b"", data))
            return True
        return False

    def text(self):
        return "\n".join(self.screen.display)

    def colours(self):
        return {cell.fg for row in self.screen.buffer.values() for cell in row.values()} - {"default"}

    def until(self, what, condition):
        end = time.monotonic() + LIMIT
        while not condition():
            assert time.monotonic() < end, f"not within {LIMIT} s: {what}; the screen:\n{self.text()}"
            self.read(0.1)

    def ended(self, status):
        end = time.monotonic() + LIMIT
        while True:
            process, found = os.waitpid(self.program, os.WNOHANG)
            if process:
                break
            assert time.monotonic() < end, f"it does not end; the screen:\n{self.text()}"
            self.read(0.02)
        while self.read(0):
            pass
        found = os.waitstatus_to_exitcode(found)
        assert found == status, f"exit status {found}, expected {status}"
        assert termios.tcgetattr(self.slave) == self.before, "the settings of the terminal are not what they were"
        for taken, given_back in (b"\x1b[?1049h", b"\x1b[?1049l"), (b"\x1b[?25l", b"\x1b[?25h"):  # the screen, the cursor
            assert self.said.rfind(taken) <= self.said.rfind(given_back), f"not given back: {taken}"


def main():
    rows, columns, *words = sys.argv[1:]
    at = words.index("--")
    terminal = Terminal(int(rows), int(columns), words[:at])
    for step in words[at + 1:]:
        what, _, value = step.partition(":")
        if what == "see":
            terminal.until(step, lambda: value in terminal.text())
        elif what == "gone":
            terminal.until(step, lambda: value not in terminal.text())
        elif what == "keys":
            os.write(terminal.master, value.encode().decode("unicode_escape").encode())
        elif what == "size":
            terminal.resize(*map(int, value.split("x")))
        elif what == "print":
            print(terminal.text())
        elif what == "run":
            subprocess.run(value, shell=True, check=True)
        elif what == "signal":
            os.kill(terminal.program, getattr(signal, value))
        elif what == "colours":
            wanted = set(filter(None, value.split(",")))
            terminal.until(step, lambda: terminal.colours() == wanted)
        elif what == "status":
            terminal.ended(int(value))
        else:
            sys.exit(f"unknown step {step}")


main()
