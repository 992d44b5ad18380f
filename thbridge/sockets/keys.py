"""Keys by which clients are admitted: one that is good for everything, or those of a ring, each with its rights."""

import hmac
import logging
import ssl
from typing import Protocol

from thbridge.credentials import LOCAL, Credentials
from thbridge.files.errors import BadFile
from thbridge.files.keys.key_ring import KeyEntry, KeyRing
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)


class KeyVerifier(Protocol):
    """Keys by which clients are admitted."""

    @property
    def tls(self) -> ssl.SSLContext | None:
        """Context of the server, with its certificate; None: all is plain, and for this machine alone."""

    def identify(self, secret: str) -> Credentials | str:
        """Return the credentials of whoever has a secret, or why it is good for nothing, as a clause."""

    def why_not(self, credentials: Credentials) -> str | None:
        """Return why somebody is not admitted any more; None where they are."""


class SingleKey:
    """One key, which whoever has it may do everything with; see `KeyVerifier`."""

    tls = None

    def __init__(self, secret: str) -> None:
        self._secret = secret.encode()

    def identify(self, secret: str) -> Credentials | str:
        """Return everything, or that the key is wrong."""
        right = hmac.compare_digest(secret.encode(errors="surrogatepass"), self._secret)
        return LOCAL if right else "the key is wrong"

    def why_not(self, credentials: Credentials) -> str | None:
        """Return None: it cannot be revoked."""
        return None


class RingKeys:
    """The keys of a ring, as it is at the moment; see `KeyVerifier`. A ring that cannot be read admits nobody.

    Args:
        ring: the keys.
        tls: context of the server, with the certificate that the keys are for.
    """

    def __init__(self, ring: KeyRing, tls: ssl.SSLContext) -> None:
        self._ring = ring
        self.tls: ssl.SSLContext | None = tls
        self._complaints = WarnOnce(_log)

    def identify(self, secret: str) -> Credentials | str:
        """Return the credentials of whoever has a secret, or why it is good for nothing, as a clause."""
        try:
            found = self._ring.holder(secret)
        except BadFile as error:
            return self._unreadable(error)
        return Credentials(found.name, found.rights) if isinstance(found, KeyEntry) else found

    def why_not(self, credentials: Credentials) -> str | None:
        """Return why somebody is not admitted any more; None where they are."""
        try:
            return self._ring.why_not(credentials.key)
        except BadFile as error:
            return self._unreadable(error)

    def enter(self, key: str, game: str, *, over: bool = False) -> str | None:
        """Use a participant's key for a game; return why it is not good for that one, None where it is."""
        try:
            return self._ring.enter(key, game, over=over)
        except BadFile as error:
            return self._unreadable(error)

    def _unreadable(self, error: BadFile) -> str:
        self._complaints.warn(str(error))
        return "the keys cannot be read or written"
