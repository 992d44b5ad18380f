"""Process of a window: started, exchanging messages, and opened again should it crash."""

import asyncio
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Generic

import msgspec

from ui.command_line.terminal import THBRIDGE, note
from ui.model.shared.window_protocol import FromHostT, FromWindowT, WindowProtocol

WINDOW = (*THBRIDGE, "tabui", "--hosted")
"""The command that opens the participant's window."""

MAX_CRASHES = 3
"""After so many crashes in a row the window stays closed."""
ROW_ENDS = 60.0
"""Seconds after which a window that has stayed open so long begins a new row of crashes."""


class WindowProcess(Generic[FromHostT, FromWindowT]):
    """A window in a process of its own.

    Args:
        command: opens the window.
        protocol: its messages.
        name: of it in sentences.
    """

    def __init__(
        self, command: tuple[str, ...], protocol: WindowProtocol[FromHostT, FromWindowT], name: str = "window"
    ) -> None:
        self._command = command
        self._name = name
        self._protocol = protocol
        self._process: Process | None = None
        self._requests: asyncio.Queue[FromWindowT] = asyncio.Queue()
        # Messages to repeat to a window that is opened again.
        self._kept: list[FromHostT] = []
        self.given_up = False
        """True when it has crashed too often."""
        self.left_open = False
        """True when it shall stay after this program. That has to end by `os._exit`: asyncio kills what it started."""

    async def send(self, message: FromHostT) -> None:
        """Send a message to the window."""
        self._kept = list(self._protocol.kept(self._kept, message))
        await self._write(message)

    async def next_request(self) -> FromWindowT:
        """Wait for the next message of the window; its last one, `closed`, when the window is closed for good."""
        return await self._requests.get()

    def pending_request(self) -> FromWindowT | None:
        """Return the message that has come already, if any."""
        return None if self._requests.empty() else self._requests.get_nowait()

    def leave_open(self) -> None:
        """Leave it as it is at the end of the context in which it is kept open."""
        self.left_open = True

    @asynccontextmanager
    async def opened(self) -> AsyncIterator[None]:
        """Keep the window open inside this context."""
        keeping = asyncio.create_task(self._keep_open())
        try:
            yield
        finally:
            keeping.cancel()
            await asyncio.gather(keeping, return_exceptions=True)

    async def _keep_open(self) -> None:
        crashes, loop = 0, asyncio.get_running_loop()
        try:
            while crashes < MAX_CRASHES:
                if crashes:
                    note(f"The {self._name} has crashed; it is opened again.")
                opened = loop.time()
                if await self._open_once():
                    return
                crashes = 1 if loop.time() - opened > ROW_ENDS else crashes + 1
            self.given_up = True
        finally:
            self._requests.put_nowait(self._protocol.closed)

    async def _open_once(self) -> bool:
        """Open the window and listen until it closes; return True if it closed on purpose."""
        # In a session of its own: Ctrl-C in the terminal ends this program, which then closes the window.
        process = await asyncio.create_subprocess_exec(*self._command, stdin=PIPE, stdout=PIPE, start_new_session=True)
        self._process = process
        try:
            for message in self._kept:
                await self._write(message)
            return await self._listen(process)
        finally:
            if process.returncode is None and not self.left_open:
                # Closing its standard input asks it to close.
                if process.stdin is not None:
                    process.stdin.close()
                try:
                    await asyncio.wait_for(process.wait(), 2.0)
                except TimeoutError:
                    process.kill()

    async def _listen(self, process: Process) -> bool:
        if process.stdout is None:
            return False
        async for text in process.stdout:
            try:
                message = self._protocol.decode_from_window(text)
            except msgspec.DecodeError:
                continue  # Something that a library printed.
            if message == self._protocol.closed:
                return True
            self._requests.put_nowait(message)
        return await process.wait() == 0

    async def _write(self, message: FromHostT) -> None:
        process = self._process
        if process is None or process.stdin is None or process.stdin.is_closing():
            return
        try:
            process.stdin.write(self._protocol.encode(message))
            await process.stdin.drain()
        except ConnectionError:
            pass  # It has just gone; the window opened in its place gets the message again.
