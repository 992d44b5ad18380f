"""Opener of recordings by their paths, and of running sessions by their addresses."""

from dataclasses import dataclass
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.keys.key_file import read_key
from thbridge.watching.sockets.client import WatchClient
from ui.model.watching.address import address_in
from ui.windows.researcher.feeds.feed import Feed
from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed
from ui.windows.researcher.feeds.session import SessionFeed, WatchConnection


@dataclass(frozen=True, slots=True)
class OpenedFeed:
    """Opened feed, with its name and the text that opens the feed again.

    Attributes:
        feed: source of all data shown.
        title: name of the feed for people.
        source: text that opens the feed again: an absolute path, or an address.
        opener: opener of a recording; None for a session.
    """

    feed: Feed
    title: str
    source: str
    opener: BagOpener | None = None


def open_feed(what: str, key: Path | None, wait: float) -> OpenedFeed:
    """Open a recording or a session.

    Args:
        what: path of a recording, or HOST:PORT of a session.
        key: file with the key that the session requires.
        wait: seconds to wait for a recording to open. If a fault is found later, the window shows the fault.

    Raises:
        BadFile: the recording does not exist or cannot be read, or the port or the key is wrong.
    """
    address = address_in(what)
    if address is not None:
        client = WatchClient(address.host, address.port, None if key is None else read_key(key))
        return OpenedFeed(SessionFeed(WatchConnection(client), str(address), key), str(address), str(address))
    if key is not None:
        raise BadFile(Path(what), "this is not an address HOST:PORT, and a recording needs no key", "remove the key")
    opener = BagOpener(Path(what))
    if opener.wait(wait) and opener.fault is not None:
        raise opener.fault
    return OpenedFeed(RecordingFeed(opener), Path(what).name, str(Path(what).absolute()), opener)
