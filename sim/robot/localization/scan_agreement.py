"""Agreement of scans with the map: running averages by which a filter notices that it is lost."""

from dataclasses import dataclass, replace

MIN_AGREEMENT = 0.7
"""Least share of the last two or three scans that the map explains where the robot is, even among seven other robots;
at four of five wrong places it explains less."""

DOUBT_RATIO = 0.9
"""Least share of what is usual that the map explains in the long run. Places that look alike differ in a door or two,
and so fall below it."""

FOUND_RATIO = 0.93
"""Least share of what is usual that the map must explain at a place for a lost robot to be found there."""

MOST_OF_ONE_SCAN = 0.25
"""A scan counts no more than this against the place, however badly it is explained: it may be the scan's fault."""
MISFIT_OF_A_LOST_ROBOT = 1.0
"""Sum of what scans lacked to the least agreement, at which the robot cannot be where the filter believes: four scans
that fit nothing, ten of which the map explains three fifths. Those that fit take from it what they have more.

Source: Page, Continuous inspection schemes (1954).
"""

DRIFT_AGREEMENT = 0.4
"""Least share of a scan that the map explains from a place some decimeters off the right one."""

_MEMORY = 0.5
"""Decay of the average over the last scans."""


@dataclass(frozen=True, slots=True)
class ScanAgreement:
    """Averages of the share of scans that the map explains: of late, and in the long run.

    Attributes:
        slow: long-term average of the agreement, 0..1: what is usual (amcl: w_slow).
        fast: short-term average (amcl: w_fast).
        recent: average over the last scans only, whatever the parameters say.
        count: scans averaged so far.
        misfit: see `MISFIT_OF_A_LOST_ROBOT`.
        last: of the last scan alone.
    """

    slow: float = 0.0
    fast: float = 0.0
    recent: float = 1.0
    count: int = 0
    misfit: float = 0.0
    last: float = 1.0

    def after(self, agreement: float, alpha_slow: float, alpha_fast: float) -> "ScanAgreement":
        """Return the averages with one more scan in them.

        They begin as plain means, over as many scans as the fast one remembers: the first scan, weighed from a vague
        start, must not stay in the slow one for a thousand more.

        Args:
            agreement: share of the scan that the map explains from where the filter believes to be, 0..1.
            alpha_slow: decay of the long-term average.
            alpha_fast: decay of the short-term average; with 0 for both only the last scans count.

        Source: Probabilistic Robotics, table 8.3, lines 10 and 11. Differs: amcl averages the mean unnormalised
            weight, which falls with the number of particles and of scans since the last resampling and so says little
            about being lost. Agreement at the reported pose has neither fault. A scan that is explained as badly as
            elsewhere does not become usual.
        """
        recent = self.recent + _MEMORY * (agreement - self.recent)
        lacking = max(-MOST_OF_ONE_SCAN, min(MIN_AGREEMENT - agreement, MOST_OF_ONE_SCAN))
        misfit = max(0.0, min(self.misfit + lacking, MISFIT_OF_A_LOST_ROBOT))
        if alpha_slow == 0.0 and alpha_fast == 0.0:
            return replace(self, recent=recent, count=self.count + 1, misfit=misfit, last=agreement)
        plain = 1.0 / (self.count + 1)
        beginning = plain > alpha_fast
        fast = self.fast + (plain if beginning else alpha_fast) * (agreement - self.fast)
        usual = agreement if agreement >= MIN_AGREEMENT else self.slow
        slow = self.slow + (plain if beginning else alpha_slow) * (usual - self.slow)
        return ScanAgreement(slow, fast, recent, self.count + 1, misfit, agreement)

    def searching(self, agreement: float) -> "ScanAgreement":
        """Return the averages with one more scan of a place that is looked for, of which nothing is usual yet."""
        recent = self.recent + _MEMORY * (agreement - self.recent)
        return replace(self, recent=recent, fast=recent, last=agreement)

    @property
    def lost(self) -> bool:
        """True when the robot cannot be where the filter believes."""
        return self.misfit >= MISFIT_OF_A_LOST_ROBOT

    @property
    def suspicious(self) -> bool:
        """True when there is reason to look whether the robot is elsewhere: more than one bad scan, or worse ones."""
        return self.recent < MIN_AGREEMENT or self.misfit > MOST_OF_ONE_SCAN or self.fast < DOUBT_RATIO * self.slow

    @property
    def doubtful(self) -> bool:
        """True when the last scans are explained worse than usual."""
        return self.recent < max(MIN_AGREEMENT, DOUBT_RATIO * self.slow)

    @property
    def drifting(self) -> bool:
        """True when scans are explained worse than usual, and yet so well that the place can hardly be far off.

        A scan of which the map explains next to nothing is no guide: it shows something unmapped, or another place.
        """
        return self.doubtful and self.last >= DRIFT_AGREEMENT

    @property
    def explained(self) -> bool:
        """True when the map has explained the last scans as well as it does at the robot's true place."""
        return self.is_usual(self.recent)

    def is_usual(self, agreement: float) -> bool:
        """Return True for an agreement as good as at the robot's true place."""
        return agreement >= FOUND_RATIO * max(self.slow, DOUBT_RATIO)
