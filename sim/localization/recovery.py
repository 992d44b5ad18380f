"""Noticing that the filter is lost: running averages of how well the map explains the scans."""

from dataclasses import dataclass

MARGIN = 1.5
"""The map must explain this many times less than usual before particles are scattered.

Other robots hide a part of the map for a while; without a margin every such moment would scatter particles.
"""

USUAL = 0.75
"""The least that a map explains where the robot really is. A filter that settled in a wrong place from the beginning
has never seen better, and would else take that for normal."""

LEAST = 0.65
"""A robot of which the map has explained less than this is not where it believes to be: where it is, the map explains
more among seven other robots, and elsewhere less in nineteen places of twenty."""

_MEMORY = 0.5
"""Decay of the average that the verdict rests on, whatever the recovery's own decays are: two or three scans."""


@dataclass(frozen=True, slots=True)
class Recovery:
    """How well the map has explained the scans of late, and in the long run.

    Attributes:
        slow: long-term average of the agreement, 0..1 (amcl: w_slow).
        fast: short-term average (amcl: w_fast).
        recent: of the last scans only: the verdict's own.
        count: scans averaged so far.
    """

    slow: float = 0.0
    fast: float = 0.0
    recent: float = 1.0
    count: int = 0

    def after(self, agreement: float, alpha_slow: float, alpha_fast: float) -> "Recovery":
        """The averages with one more scan in them.

        They begin as plain means, over as many scans as the fast one remembers: the first scan, weighed from a vague
        start, must not stay in the slow one for a thousand more.

        Args:
            agreement: how well the map explains the scan from where the filter believes to be, 0..1.
            alpha_slow: decay of the long-term average.
            alpha_fast: decay of the short-term average; 0 for both never scatters particles.

        Source: Probabilistic Robotics, table 8.3, lines 10 and 11. Differs: amcl averages the mean unnormalised
            weight, which falls with the number of particles and of scans since the last resampling and so says little
            about being lost. Agreement at the reported pose has neither fault.
        """
        recent = self.recent + _MEMORY * (agreement - self.recent)
        if alpha_slow == 0.0 and alpha_fast == 0.0:
            return Recovery(self.slow, self.fast, recent, self.count + 1)
        plain = 1.0 / (self.count + 1)
        beginning = plain > alpha_fast
        slow = self.slow + (plain if beginning else alpha_slow) * (agreement - self.slow)
        fast = self.fast + (plain if beginning else alpha_fast) * (agreement - self.fast)
        return Recovery(slow, fast, recent, self.count + 1)

    @property
    def lost(self) -> float:
        """Share of the particles to draw anew from all over the map, 0..1.

        Source: Gutmann and Fox, An experimental comparison of localization methods continued (2002), for the margin;
            table 8.3, line 13 is the case `MARGIN` = 1 without `USUAL`.
        """
        return max(0.0, 1.0 - MARGIN * self.fast / max(self.slow, USUAL)) if self.slow > 0.0 else 0.0

    @property
    def unexplained(self) -> bool:
        """Whether the map has not explained the scans of late: the robot is not where the filter believes."""
        return self.recent < LEAST

    @property
    def explained(self) -> bool:
        """Whether it has, as well as where the robot really is."""
        return self.recent >= USUAL
