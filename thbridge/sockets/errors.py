"""Errors of sockets, as values."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CannotListen:
    """Failure to open a server; its text is one line for people."""

    host: str
    port: int
    reason: str

    def __str__(self) -> str:
        return (
            f"cannot listen on {self.host}:{self.port}: {self.reason}. "
            "Stop the program that uses the port, or choose another host or port."
        )
