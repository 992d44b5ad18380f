"""Keys for the admission of clients: a single key with all rights, or a key ring with rights for each key."""

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
    """Keys for the admission of clients."""

    @property
    def tls(self) -> ssl.SSLContext | None:
        """TLS context of the server, with its certificate. If None, connections are not encrypted and only from this
        machine.
        """

    def identify(self, secret: str) -> Credentials | str:
        """Return the credentials of a secret, or the reason why it is refused, as a clause."""

    def why_not(self, credentials: Credentials) -> str | None:
        """Return the reason why a client is no longer admitted, or None if it is still admitted."""


class SingleKey:
    """A single key with all rights. See `KeyVerifier`."""

    tls = None

    def __init__(self, secret: str) -> None:
        self._secret = secret.encode()

    def identify(self, secret: str) -> Credentials | str:
        """Return credentials with all rights if the secret is right. Otherwise return a clause for people."""
        # The comparison takes equally long for all wrong keys, so that its time reveals nothing about the right key.
        right = hmac.compare_digest(secret.encode(errors="surrogatepass"), self._secret)
        return LOCAL if right else "the key is wrong"

    def why_not(self, credentials: Credentials) -> str | None:
        """Return None, because a single key cannot be revoked."""
        return None


class RingKeys:
    """Keys of a key ring. See `KeyVerifier`. Changes of the key ring take effect at once.

    If the ring cannot be read, no client is admitted.

    Args:
        ring: the keys.
        tls: context of the server. The keys contain the fingerprint of its certificate.
    """

    def __init__(self, ring: KeyRing, tls: ssl.SSLContext) -> None:
        self._ring = ring
        self.tls: ssl.SSLContext | None = tls
        self._complaints = WarnOnce(_log)

    def identify(self, secret: str) -> Credentials | str:
        """Return the credentials of a secret, or the reason why it is refused, as a clause."""
        try:
            found = self._ring.holder(secret)
        except BadFile as error:
            return self._unreadable(error)
        return Credentials(found.name, found.rights, seats=found.seats) if isinstance(found, KeyEntry) else found

    def why_not(self, credentials: Credentials) -> str | None:
        """Return the reason why a client is no longer admitted, or None if it is still admitted."""
        try:
            return self._ring.why_not(credentials.key)
        except BadFile as error:
            return self._unreadable(error)

    def enter(self, key: str, game: str, *, over: bool = False) -> str | None:
        """Use a participant's key for a game. Return the reason why it cannot be used for this game, or None."""
        try:
            return self._ring.enter(key, game, over=over)
        except BadFile as error:
            return self._unreadable(error)

    def _unreadable(self, error: BadFile) -> str:
        self._complaints.warn(str(error))
        return "the keys cannot be read or written"
