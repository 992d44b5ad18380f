"""Errors of sockets, as values."""

import errno
from dataclasses import dataclass

from thbridge.files.errors import reason_of
from thbridge.sockets.addresses import Address

_NOT_OURS = "this machine does not have this address"
_OTHER_PORT = "Stop the program that uses the port, or choose another host or port"


@dataclass(frozen=True, slots=True)
class CannotListen:
    """Failure to open a server. `str` returns one line for people."""

    host: str
    port: int
    reason: str

    @classmethod
    def because(cls, error: OSError | UnicodeError, host: str, port: int) -> "CannotListen":
        """Return the failure for an error of a socket."""
        if not isinstance(error, OSError):
            reason = "this is not the name of a host"
        elif error.errno == errno.EADDRNOTAVAIL:
            reason = _NOT_OURS
        else:
            reason = reason_of(error)
        return cls(host, port, reason)

    def __str__(self) -> str:
        remedy = "Write an address of this machine" if self.reason == _NOT_OURS else _OTHER_PORT
        return f"cannot listen on {self.host}:{self.port}: {self.reason}. {remedy}."


@dataclass(frozen=True, slots=True)
class CannotReach:
    """Failure to connect to a program. `str` returns one line for people.

    Attributes:
        what: the program, for example "zenoh router".
        address: its expected address.
        reason: for example "Connection refused".
        remedy: what people can do.
    """

    what: str
    address: Address
    reason: str
    remedy: str

    @classmethod
    def because(cls, error: OSError, what: str, address: Address, remedy: str) -> "CannotReach":
        """Return the failure for an error of a socket."""
        reason = "no answer" if isinstance(error, TimeoutError) else reason_of(error)
        return cls(what, address, reason, remedy)

    def __str__(self) -> str:
        return f"no {self.what} at {self.address}: {self.reason}. {self.remedy}."
