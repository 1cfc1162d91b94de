# SPDX-License-Identifier: MIT
"""What the package uses of Linux and its like; _windows.py has the same for Windows."""

from __future__ import annotations

import os
import shlex
import socket
import struct
import subprocess
import sys
from typing import TYPE_CHECKING, Any, Callable, List, NoReturn, Optional, Sequence

if TYPE_CHECKING:
    from ._remote import ControlSocket
    from ._remote_host import RemoteHost

assert sys.platform != "win32"

PROGRAM_SUFFIX = ""
HAS_PTYS = True
SELECTORS: List[Any] = []
"""What event loops wait in, besides those of the module selectors."""


def run_in_place(path: str, arguments: List[str]) -> NoReturn:
    """Run a program in the place of this process."""
    os.execv(path, arguments)


CONNECT_S = 30
"""s of real time for an emulator that does not accept."""

quote = shlex.quote
"""A word as a shell takes it."""


def command_with(name: str, value: str, command: str) -> str:
    """A command for a shell, with a variable of the environment set for it alone. value: without quotes."""
    return f"{name}='{value}' {command}"


def connect_socket(path: str) -> socket.socket:
    """A Unix socket. A path of one has at most 107 bytes: a longer one is reached through its folder."""
    made, folder = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM), -1
    made.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("@ll", CONNECT_S, 0))  # waits while many connect
    try:
        if len(os.fsencode(path)) > 107:
            folder = os.open(os.path.dirname(path), os.O_PATH)
        made.connect(path if folder < 0 else f"/proc/self/fd/{folder}/{os.path.basename(path)}")
    except OSError:
        made.close()
        raise
    finally:
        if folder >= 0:
            os.close(folder)
    return made


def serve_arguments(folder: str, arguments: Sequence[str]) -> List[str]:
    """For `rkm04 serve`: a link in the folder, and what the user has given."""
    return ["--link", link_in(folder) or "", *arguments]


def link_in(folder: str) -> Optional[str]:
    """The link of an emulator that serves in the folder."""
    return os.path.join(folder, "bus")


def end_process(process: "subprocess.Popen[bytes]", shut_down: Callable[[], None]) -> None:
    """Let rkm04 serve end and close its files."""
    process.terminate()


def open_link(control: "ControlSocket", link: str) -> "RemoteHost":
    """A host at a pty."""
    from ._pty_host import PtyHost

    return PtyHost(control, link)
