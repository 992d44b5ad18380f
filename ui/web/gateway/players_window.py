"""Window of a person whose games run in workers of the pool."""

from ui.web.pool.pool import HostedGame


class PlayersWindow:
    """Window of a person, connected to their game; the base of browsers and of the window on the server's machine.

    Attributes:
        watch_port: TCP port for `thbridge watch`; 0 if the person's game cannot be watched.
        watch_host: machine of this port; empty for this machine.
    """

    def __init__(self) -> None:
        self.watch_port, self.watch_host = 0, ""
        self._watched = False
        self._game: HostedGame | None = None

    @property
    def is_connected(self) -> bool:
        """True while the window can show something."""
        return True

    @property
    def plays(self) -> bool:
        """True while the person has a game."""
        return self._game is not None

    def play(self, game: HostedGame | None) -> None:
        """Connect the window to this game. If None, disconnect it."""
        self._game, self.watch_port = game, 0
        if game is not None and self._watched:
            game.watch()

    def watch_game(self) -> None:
        """Let researchers' windows connect to the person's game, and to the person's next games."""
        self._watched = True
        if self._game is not None:
            self._game.watch()

    def show(self, text: str) -> None:
        """Pass on a message of the game; a window that joins games itself gets none."""

    def note_seen_over(self) -> None:
        """Report to the study that the window shows the end of the game, unless the window reports it itself."""

    def note_went_on(self) -> None:
        """Report to the study that the person continues after the game, unless the window reports it itself."""
