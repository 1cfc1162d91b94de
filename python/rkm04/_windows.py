# SPDX-License-Identifier: MIT
"""What the package uses of Windows; _posix.py has the same for other systems."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from typing import TYPE_CHECKING, Any, Callable, List, NoReturn, Optional, Sequence

from ._errors import Error

if TYPE_CHECKING:
    from ._remote import ControlSocket
    from ._remote_host import RemoteHost

PROGRAM_SUFFIX = ".exe"
HAS_PTYS = False
SELECTORS: List[Any] = []
"""What event loops wait in, besides those of the module selectors."""

if sys.platform == "win32":
    from asyncio.windows_events import IocpProactor

    SELECTORS.append(IocpProactor)


def run_in_place(path: str, arguments: List[str]) -> NoReturn:
    """Run a program, and end with its exit status: here a process has no other in its place, and who has started this one would
    not wait for it. Ctrl-C is the program's: its end is awaited."""
    process = subprocess.Popen([path, *arguments[1:]])
    while True:
        try:
            sys.exit(process.wait())
        except KeyboardInterrupt:
            pass


def quote(text: str) -> str:
    """A word as a command prompt takes it."""
    return subprocess.list2cmdline([text])


def command_with(name: str, value: str, command: str) -> str:
    """A command for a prompt, with a variable of the environment set for it alone. value: without quotes."""
    return f'cmd /c "set {name}={value}&& {command}"'


def connect_socket(path: str) -> socket.socket:
    """Python has no Unix sockets here. Raises OSError."""
    raise OSError(0, "no control file")


def serve_arguments(folder: str, arguments: Sequence[str]) -> List[str]:
    """For `rkm04 serve`: a control file in the folder, and what the user has given, but for --allow-folder: nothing is confined
    here."""
    own = [] if _has(arguments, "--control") else ["--control", "tcp:0", "--control-file", os.path.join(folder, "control")]
    given = list(arguments)
    while "--allow-folder" in given:
        at = given.index("--allow-folder")
        del given[at:at + 2]
    return own + [option for option in given if not option.startswith("--allow-folder=")]


def _has(arguments: Sequence[str], name: str) -> bool:
    return any(option == name or option.startswith(name + "=") for option in arguments)


def link_in(folder: str) -> Optional[str]:
    """There are no ptys here."""
    return None


def end_process(process: "subprocess.Popen[bytes]", shut_down: Callable[[], None]) -> None:
    """Let rkm04 serve end and close its files: a process that is terminated here has no time for that."""
    if process.poll() is None:
        try:
            shut_down()
        except (Error, OSError):
            process.terminate()


def open_link(control: "ControlSocket", link: str) -> "RemoteHost":
    """Raises Error."""
    raise Error(f"expected a link socket://HOST:PORT, as there are no ptys on Windows, found {link}")
