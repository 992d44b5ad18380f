"""Noticing that the filter is lost: running averages of how well the map explains the scans."""

from dataclasses import dataclass, replace

MIN_AGREEMENT = 0.7
"""Of the last two or three scans the map explains this much, or the robot is not where it believes to be: where it is,
the map explains more even among seven other robots, and elsewhere less in four places of five."""

DOUBT_RATIO = 0.9
"""In the long run it explains this share of what is usual. Twins of the right place differ in a door or two."""

FOUND_RATIO = 0.93
"""A place of which the map explains less than this share of what is usual is not one to be found in."""

_MEMORY = 0.5
"""Decay of the average over the last scans."""


@dataclass(frozen=True, slots=True)
class ScanAgreement:
    """How well the map has explained the scans of late, and in the long run.

    Attributes:
        slow: long-term average of the agreement, 0..1: what is usual (amcl: w_slow).
        fast: short-term average (amcl: w_fast).
        recent: of the last scans only, whatever the parameters say.
        count: scans averaged so far.
    """

    slow: float = 0.0
    fast: float = 0.0
    recent: float = 1.0
    count: int = 0

    def after(self, agreement: float, alpha_slow: float, alpha_fast: float) -> "ScanAgreement":
        """The averages with one more scan in them.

        They begin as plain means, over as many scans as the fast one remembers: the first scan, weighed from a vague
        start, must not stay in the slow one for a thousand more.

        Args:
            agreement: how well the map explains the scan from where the filter believes to be, 0..1.
            alpha_slow: decay of the long-term average.
            alpha_fast: decay of the short-term average; with 0 for both only the last scans count.

        Source: Probabilistic Robotics, table 8.3, lines 10 and 11. Differs: amcl averages the mean unnormalised
            weight, which falls with the number of particles and of scans since the last resampling and so says little
            about being lost. Agreement at the reported pose has neither fault. A scan that is explained as badly as
            elsewhere does not become usual.
        """
        recent = self.recent + _MEMORY * (agreement - self.recent)
        if alpha_slow == 0.0 and alpha_fast == 0.0:
            return replace(self, recent=recent, count=self.count + 1)
        plain = 1.0 / (self.count + 1)
        beginning = plain > alpha_fast
        fast = self.fast + (plain if beginning else alpha_fast) * (agreement - self.fast)
        usual = agreement if agreement >= MIN_AGREEMENT else self.slow
        slow = self.slow + (plain if beginning else alpha_slow) * (usual - self.slow)
        return ScanAgreement(slow, fast, recent, self.count + 1)

    def searching(self, agreement: float) -> "ScanAgreement":
        """One more scan, of a robot known to be lost: what it sees says nothing of what is usual."""
        recent = self.recent + _MEMORY * (agreement - self.recent)
        return replace(self, recent=recent, fast=recent)

    @property
    def lost(self) -> bool:
        """Whether the robot cannot be where the filter believes."""
        return self.recent < MIN_AGREEMENT or self.fast < DOUBT_RATIO * self.slow

    @property
    def doubtful(self) -> bool:
        """Whether the last scans are explained worse than usual."""
        return self.recent < max(MIN_AGREEMENT, DOUBT_RATIO * self.slow)

    @property
    def explained(self) -> bool:
        """Whether the map has explained the last scans as well as where the robot really is."""
        return self.recent >= FOUND_RATIO * max(self.slow, DOUBT_RATIO)
