"""Keys of the watch server: one that is good for everything, or those of a ring, each with its rights."""

import hmac
import logging

from thbridge.files.errors import BadFile
from thbridge.files.keys.key_ring import KeyEntry, KeyRing, Right
from thbridge.protocols.watching import WatcherIdentity
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)


class SingleKey:
    """One key, which whoever has it may do everything with; see `WatchKeys`."""

    def __init__(self, secret: str) -> None:
        self._secret = secret.encode()

    def identify(self, secret: str) -> WatcherIdentity | str:
        """Return who has a secret, or why it is good for nothing, as a clause."""
        right = hmac.compare_digest(secret.encode(errors="surrogatepass"), self._secret)
        return WatcherIdentity() if right else "the key is wrong"

    def why_not(self, identity: WatcherIdentity) -> str | None:
        """Return why somebody is not admitted any more; None where they are."""
        return None


class RingKeys:
    """The keys of a ring, as it is at the moment; see `WatchKeys`. A ring that cannot be read admits nobody."""

    def __init__(self, ring: KeyRing) -> None:
        self._ring = ring
        self._complaints = WarnOnce(_log)

    def identify(self, secret: str) -> WatcherIdentity | str:
        """Return who has a secret, or why it is good for nothing, as a clause."""
        try:
            found = self._ring.holder(secret)
        except BadFile as error:
            return self._unreadable(error)
        if isinstance(found, KeyEntry):
            return WatcherIdentity(found.name, may_intervene=Right.INTERVENE in found.rights)
        return found

    def why_not(self, identity: WatcherIdentity) -> str | None:
        """Return why somebody is not admitted any more; None where they are."""
        try:
            return self._ring.why_not(identity.name)
        except BadFile as error:
            return self._unreadable(error)

    def _unreadable(self, error: BadFile) -> str:
        self._complaints.warn(str(error))
        return "the keys cannot be read"
