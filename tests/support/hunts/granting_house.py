"""Session for watching clients that grants their requests."""

from collections.abc import Mapping

from thbridge.watching.sockets.server import SessionPace


class GrantingHouse:
    """Session that grants every request except those whose name begins with N."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, Mapping[str, object]]] = []
        self.paused = False
        self.left_alone = 0

    def ask(self, watcher: str, wish: Mapping[str, object], key: str = "") -> str | None:
        self.asked.append((watcher, wish))
        return "no" if str(wish.get("request", "N")).startswith("N") else None

    def pace(self) -> SessionPace:
        return SessionPace(self.paused, 1.0, 0.25)

    def unwatched(self) -> None:
        self.left_alone += 1
