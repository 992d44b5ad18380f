"""Agreement of scans with the map: running averages by which a filter detects that the robot is lost."""

from dataclasses import dataclass, replace

MIN_AGREEMENT = 0.7
"""At the true pose, the map explains at least this share of the last two or three scans, even with seven other robots
nearby. At four of five wrong places, the map explains a smaller share."""

DOUBT_RATIO = 0.9
"""Minimum ratio of the agreement in the long run to the usual agreement. Places that look alike usually differ by one
or two doorways, so at a wrong place the ratio is lower."""

FOUND_RATIO = 0.93
"""Minimum ratio of the agreement at a pose to the usual agreement, for a lost robot to count as found there."""

MOST_OF_ONE_SCAN = 0.25
"""Maximum effect of a single scan against the pose, because the scan itself may be misleading."""
MISFIT_OF_A_LOST_ROBOT = 1.0
"""Limit of a sum. If the sum reaches the limit, the pose cannot be right. Each scan adds the difference between the
minimum agreement and its own agreement. Four scans that do not fit at all reach the limit, or ten scans with three
fifths explained by the map. Scans above the minimum reduce the sum.

Source: Page, Continuous inspection schemes (1954).
"""

DRIFT_AGREEMENT = 0.4
"""Minimum share of a scan that the map explains from a pose some decimeters off the right pose."""

_MEMORY = 0.5
"""Decay rate of the average over the last few scans."""


@dataclass(frozen=True, slots=True)
class ScanAgreement:
    """Averages of the share of scans that the map explains, over short and long times.

    Attributes:
        slow: long-term average of the agreement, 0 to 1: the usual value (amcl: w_slow).
        fast: short-term average (amcl: w_fast).
        recent: average over only the last few scans, independent of the parameters.
        count: number of scans in the averages.
        misfit: see `MISFIT_OF_A_LOST_ROBOT`.
        last: agreement of the last scan.
    """

    slow: float = 0.0
    fast: float = 0.0
    recent: float = 1.0
    count: int = 0
    misfit: float = 0.0
    last: float = 1.0

    def after(self, agreement: float, alpha_slow: float, alpha_fast: float) -> "ScanAgreement":
        """Return the averages after another scan.

        The averages start as plain means over the number of scans that the fast average covers. Otherwise the first
        scan, which is compared at an uncertain pose, would affect the slow average for a thousand scans.

        Args:
            agreement: share of the scan that the map explains from the estimated pose, 0 to 1.
            alpha_slow: decay rate of the long-term average.
            alpha_fast: decay rate of the short-term average. If both are 0, only the last scans count.

        Source: Probabilistic Robotics, table 8.3, lines 10 and 11. Differences from ROS: amcl averages the mean
            unnormalized weight. This weight decreases with the number of particles and with the number of scans since
            the last resampling, so it hardly shows that a robot is lost. Agreement at the reported pose does not have
            this problem. A scan that is explained as badly as at a wrong pose does not change the usual value.
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
        """Return the averages after another scan during a search. The usual agreement is not known yet."""
        recent = self.recent + _MEMORY * (agreement - self.recent)
        return replace(self, recent=recent, fast=recent, last=agreement)

    @property
    def lost(self) -> bool:
        """True if the robot cannot be at the estimated pose."""
        return self.misfit >= MISFIT_OF_A_LOST_ROBOT

    @property
    def suspicious(self) -> bool:
        """True if there is a reason to search elsewhere: several bad scans, or an agreement worse than usual."""
        return self.recent < MIN_AGREEMENT or self.misfit > MOST_OF_ONE_SCAN or self.fast < DOUBT_RATIO * self.slow

    @property
    def doubtful(self) -> bool:
        """True if the last scans are explained worse than usual."""
        return self.recent < max(MIN_AGREEMENT, DOUBT_RATIO * self.slow)

    @property
    def drifting(self) -> bool:
        """True if scans are explained worse than usual, but so well that the error of the pose is small.

        If the map explains almost nothing of a scan, the scan is not useful: it shows unmapped things or another place.
        """
        return self.doubtful and self.last >= DRIFT_AGREEMENT

    @property
    def explained(self) -> bool:
        """True if the map explains the last scans as well as it would at the robot's true pose."""
        return self.is_usual(self.recent)

    def is_usual(self, agreement: float) -> bool:
        """Return True if an agreement is as good as it would be at the robot's true pose."""
        return agreement >= FOUND_RATIO * max(self.slow, DOUBT_RATIO)
