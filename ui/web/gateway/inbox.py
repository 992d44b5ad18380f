"""Messages of a page that loses its connection: the page sends some of them again, and each is processed once.

A tab numbers its messages from 0, and keeps each until the server confirms it. When the tab connects again, it sends
the kept messages again, because some of them may be lost. Answers to heartbeats have no numbers.
"""

from dataclasses import dataclass


@dataclass(slots=True)
class Inbox:
    """Count of the messages of a visitor's live tab.

    Attributes:
        tab: name of the tab.
        processed: number of the first message that was not processed yet.
    """

    tab: str = ""
    processed: int = 0

    def connect(self, tab: str, number: int) -> bool:
        """Note that a tab is live, whose next message has this number; return True if it was also live before."""
        again = bool(tab) and tab == self.tab
        if not again:
            self.tab, self.processed = tab, number
        return again

    def is_new(self, number: int) -> bool:
        """Return True if the message with this number was not processed yet."""
        return number >= self.processed

    def note(self, number: int) -> None:
        """Note that the message with this number is processed."""
        self.processed = number + 1
