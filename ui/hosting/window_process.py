"""Process of a window, which exchanges messages with its host and is restarted after a crash."""

import asyncio
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Generic

import msgspec

from ui.command_line.terminal import THBRIDGE, note
from ui.model.shared.window_protocol import FromHostT, FromWindowT, WindowProtocol

WINDOW = (*THBRIDGE, "tabui", "--hosted")
"""Command that opens the participant's window."""

MAX_CRASHES = 3
"""After this number of crashes in a row, the window is not opened again."""
ROW_ENDS = 60.0
"""If the window stays open for this number of seconds, the number of crashes in a row restarts at 0."""


class WindowProcess(Generic[FromHostT, FromWindowT]):
    """Window in a separate process.

    Args:
        command: command that opens the window.
        protocol: protocol of the window's messages.
        name: name of the window in messages.
    """

    def __init__(
        self, command: tuple[str, ...], protocol: WindowProtocol[FromHostT, FromWindowT], name: str = "window"
    ) -> None:
        self._command = command
        self._name = name
        self._protocol = protocol
        self._process: Process | None = None
        self._requests: asyncio.Queue[FromWindowT] = asyncio.Queue()
        # Messages that a reopened window receives again.
        self._kept: list[FromHostT] = []
        self.given_up = False
        """True if the window has crashed too often."""
        self.left_open = False
        """True if the window stays open when this program ends. The program then ends by `os._exit`, because asyncio
        would kill the window's process."""

    async def send(self, message: FromHostT) -> None:
        """Send a message to the window."""
        self._kept = list(self._protocol.kept(self._kept, message))
        await self._write(message)

    async def next_request(self) -> FromWindowT:
        """Wait for the next message of the window. The last message is `closed`; after it, the window stays closed."""
        return await self._requests.get()

    def pending_request(self) -> FromWindowT | None:
        """Return a message that has already arrived, if any."""
        return None if self._requests.empty() else self._requests.get_nowait()

    def leave_open(self) -> None:
        """Leave the window open at the end of its context."""
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
                    note(f"The {self._name} has crashed, and is opened again.")
                opened = loop.time()
                if await self._open_once():
                    return
                crashes = 1 if loop.time() - opened > ROW_ENDS else crashes + 1
            self.given_up = True
        finally:
            self._requests.put_nowait(self._protocol.closed)

    async def _open_once(self) -> bool:
        """Open the window and listen until it closes; return True if the user closed it on purpose."""
        # The window runs in a separate process session. So Ctrl-C in the terminal ends only this program, which then
        # closes the window.
        process = await asyncio.create_subprocess_exec(*self._command, stdin=PIPE, stdout=PIPE, start_new_session=True)
        self._process = process
        try:
            for message in self._kept:
                await self._write(message)
            return await self._listen(process)
        finally:
            if process.returncode is None and not self.left_open:
                # The window closes when its standard input closes.
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
                continue  # This line is output of a library, not a message.
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
            pass  # The window has just closed. If it is opened again, the new process receives the message.
