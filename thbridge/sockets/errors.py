"""Errors of sockets, as values."""

from dataclasses import dataclass

from thbridge.files.errors import reason_of


@dataclass(frozen=True, slots=True)
class CannotListen:
    """Failure to open a server. `str` returns one line for people."""

    host: str
    port: int
    reason: str

    @classmethod
    def because(cls, error: OSError | UnicodeError, host: str, port: int) -> "CannotListen":
        """Return the failure for an error of a socket."""
        return cls(host, port, reason_of(error) if isinstance(error, OSError) else "this is not the name of a host")

    def __str__(self) -> str:
        return (
            f"cannot listen on {self.host}:{self.port}: {self.reason}. "
            "Stop the program that uses the port, or choose another host or port."
        )
