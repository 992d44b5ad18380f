"""Process of the participant's window: started, exchanging messages, and opened again should it crash."""

import asyncio
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec

from ui.model.lobby import FromHost, FromWindow, Offer, Thanks, WindowClosed, decode_from_window, encode
from ui.terminal import note

WINDOW = (sys.executable, "-c", "from ui.cli import main; main()", "tabui", "--hosted")
"""The command that opens the window."""

MAX_CRASHES = 3
"""After so many crashes the window stays closed."""


class WindowProcess:
    """The window of one participant.

    Args:
        command: opens the window.
    """

    def __init__(self, command: tuple[str, ...] = WINDOW) -> None:
        self._command = command
        self._process: Process | None = None
        self._requests: asyncio.Queue[FromWindow] = asyncio.Queue()
        # Messages to repeat to a window that is opened again.
        self._sent: list[FromHost] = []
        self.given_up = False
        """True when it has crashed too often."""

    async def send(self, message: FromHost) -> None:
        """Send a message to the window."""
        self._sent = [message] if isinstance(message, Offer | Thanks) else [*self._sent, message]
        await self._write(message)

    async def next_request(self) -> FromWindow:
        """Wait for the participant's next request; `WindowClosed` when the window is closed for good."""
        return await self._requests.get()

    def pending_request(self) -> FromWindow | None:
        """Return the request that has come already, if any."""
        return None if self._requests.empty() else self._requests.get_nowait()

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
        try:
            for crashes in range(1, MAX_CRASHES + 1):
                if await self._open_once():
                    return
                if crashes < MAX_CRASHES:
                    note("The window has crashed; it is opened again.")
            self.given_up = True
        finally:
            self._requests.put_nowait(WindowClosed())

    async def _open_once(self) -> bool:
        """Open the window and listen until it closes; return True if it closed on purpose."""
        # In a session of its own: Ctrl-C in the terminal ends this program, which then closes the window.
        process = await asyncio.create_subprocess_exec(*self._command, stdin=PIPE, stdout=PIPE, start_new_session=True)
        self._process = process
        try:
            for message in self._sent:
                await self._write(message)
            return await self._listen(process)
        finally:
            if process.returncode is None:
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
                message = decode_from_window(text)
            except msgspec.DecodeError:
                continue  # Something that a library printed.
            if isinstance(message, WindowClosed):
                return True
            self._requests.put_nowait(message)
        return await process.wait() == 0

    async def _write(self, message: FromHost) -> None:
        process = self._process
        if process is None or process.stdin is None or process.stdin.is_closing():
            return
        try:
            process.stdin.write(encode(message))
            await process.stdin.drain()
        except ConnectionError:
            pass  # It has just gone; the window opened in its place gets the message again.
