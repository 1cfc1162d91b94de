# SPDX-License-Identifier: MIT
"""The host library with asyncio, over pyserial-asyncio."""
from __future__ import annotations

import asyncio

import serial_asyncio

from rkm_host import FLAG, GET_POSITION, GET_PROGRESS, HOST, SET_COMMAND, NoAnswer, UnitError, frame, unframe


class AsyncUnit:
    """One unit on a bus; made by `await AsyncUnit.open(port)`."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, node: int, timeout: float,
                 retries: int) -> None:
        self.reader, self.writer, self.node, self.timeout, self.retries = reader, writer, node, timeout, retries

    @classmethod
    async def open(cls, port: str, node: int = 1, timeout: float = 0.5, retries: int = 2) -> "AsyncUnit":
        """Open the port."""
        reader, writer = await serial_asyncio.open_serial_connection(url=port, baudrate=19200)
        return cls(reader, writer, node, timeout, retries)

    def close(self) -> None:
        """Close the port."""
        self.writer.close()

    async def request(self, number: int, rest: bytes) -> bytes:
        """Send a message; return what follows the number in the answer. Raises NoAnswer."""
        for _ in range(1 + self.retries):
            self.writer.write(frame(self.node, bytes([number]) + rest))
            try:
                return await asyncio.wait_for(self._answer(bytes([HOST, self.node, number]) + rest[:1]), self.timeout)
            except asyncio.TimeoutError:
                pass
        raise NoAnswer(f"unit {self.node} does not answer message {number}")

    async def _answer(self, wanted: bytes) -> bytes:
        while True:
            body = unframe((await self.reader.readuntil(bytes([FLAG]))).rstrip(bytes([FLAG])))
            if body is not None and body.startswith(wanted):
                return body[3:]

    async def set_command(self, motor: int, text: str) -> None:
        """Give a motor commands. Raises UnitError if the unit refuses the text."""
        answer = await self.request(SET_COMMAND, f"{motor}{text}".encode("ascii"))
        if answer[1]:
            raise UnitError(f"motor {motor}: {text!r} is refused with flag {answer[1]} at {chr(answer[2])!r}")

    async def position(self, motor: int) -> int:
        """A motor's position counter."""
        return int((await self.request(GET_POSITION, str(motor).encode()))[2:])

    async def wait(self, motor: int, every: float = 0.2) -> None:
        """Wait until the motor stands."""
        while int((await self.request(GET_PROGRESS, str(motor).encode()))[1:].split(b";")[1]):
            await asyncio.sleep(every)
