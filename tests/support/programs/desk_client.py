"""Program that opens the researcher's page like a browser."""

import asyncio
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

from tests.support.programs.browser_client import applied


@dataclass
class DeskClient:
    """Browser of a researcher.

    Attributes:
        socket: its connection.
        page: tree of the page; empty before.
        refused: sentence about a wrong key; empty before.
    """

    socket: ClientConnection
    page: dict[str, Any] = field(default_factory=dict)
    refused: str = ""

    @classmethod
    async def opened(cls, port: int, key: str) -> "DeskClient":
        """Return a browser that has sent this key."""
        origin = f"http://127.0.0.1:{port}"
        desk = cls(await connect(f"ws://127.0.0.1:{port}/desk/socket", origin=origin))  # type: ignore[arg-type]
        await desk.send({"t": "key", "key": key})
        return desk

    async def send(self, message: dict[str, Any]) -> None:
        """Send a message."""
        await self.socket.send(json.dumps(message))

    async def until(self, happened: Callable[[], object], seconds: float = 60.0) -> None:
        """Read until something has happened."""
        async with asyncio.timeout(seconds):
            while not happened():
                message = json.loads(await self.socket.recv())
                if message["t"] == "refused":
                    self.refused = message["text"]
                else:
                    self.page = applied(self.page, message["p"])

    def rows(self, table: int = 0) -> dict[str, list[str]]:
        """Return the cells of a table's rows, by the first cell."""
        return {row["cells"][0]: row["cells"] for row in self.page["tables"][table]["rows"]} if self.page else {}

    def actions(self, participant: str) -> dict[str, dict[str, Any]]:
        """Return the buttons of a person, by their labels."""
        (row,) = (row for row in self.page["tables"][0]["rows"] if row["key"] == participant)
        return {action["label"]: action for action in row["actions"]}
