"""What a front end shows and offers, read from its own surface, in the same form for all front ends."""

from dataclasses import dataclass, field
from typing import TypeAlias

from ui.model.playing.screen import Act

Deed: TypeAlias = tuple[str | int | None, ...]
"""Something that a person can do in a game, by its name, robot (index) or room (number), and further values."""


@dataclass(frozen=True, slots=True)
class Offer:
    """Button, as a person reads it, or hears it from a screen reader.

    Attributes:
        label: text on the button.
        key: name of its key; empty if there is none.
        hint: cost or gain, or the reason why the act is impossible.
        possible: True if the act is possible.
        pending: True if the act was requested and has not happened yet.
        spoken: name for screen readers.
    """

    label: str
    key: str
    hint: str
    possible: bool
    pending: bool
    spoken: str


@dataclass(slots=True)
class Shown:
    """Everything that a front end shows.

    Attributes:
        offers: buttons, by their act.
        names: possible names of the treasure shown, and True for the selected one.
        words: texts of each part, by the name of the part; parts without text are left out.
    """

    offers: dict[Act, Offer] = field(default_factory=dict)
    names: tuple[tuple[str, bool], ...] = ()
    words: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def put(self, part: str, *texts: str) -> None:
        """Add the texts of a part that are not empty."""
        said = tuple(text for text in texts if text)
        if said:
            self.words[part] = said

    def possible(self) -> list[Act]:
        """Return the acts that are possible now, in the order of the front end."""
        return [act for act, offer in self.offers.items() if offer.possible and not offer.pending]

    def differences(self, other: "Shown") -> dict[str, tuple[object, object]]:
        """Return what differs from another front end: both versions, by the act or the part.

        A text with several lines has versions of decreasing length. A front end shows the longest one that fits.
        """
        found: dict[str, tuple[object, object]] = {}
        for act in {**self.offers, **other.offers}:
            mine, theirs = self.offers.get(act), other.offers.get(act)
            if mine != theirs:
                found[repr(act)] = mine, theirs
        if self.names != other.names:
            found["names"] = self.names, other.names
        for part in {**self.words, **other.words}:
            shown, versions = self.words.get(part, ()), other.words.get(part, ())
            pairs = zip(shown, versions, strict=False)
            if len(shown) != len(versions) or any(text not in (each, *each.split("\n")) for text, each in pairs):
                found[part] = shown, versions
        return found
