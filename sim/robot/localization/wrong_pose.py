"""Probability that a localizer's pose is wrong: a logistic model with features of the filter's own state.

`scripts/fit_wrong_pose.py` fits the coefficients (`wrong_pose_coefficients`) to simulated runs. It checks them on other
runs: among all updates that report the probability p, the share of wrong poses is about p.
"""

import math
from collections.abc import Sequence
from operator import mul
from typing import NamedTuple

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.robot.localization.hypothesis import Hypothesis

WRONG_DISTANCE = 1.0
"""A pose is wrong if its distance from the true position is above this, meters."""
WRONG_TURN = 0.5
"""A pose is wrong if its angle to the true heading is above this, radians."""

_LEAST_EXPLAINED = 0.9
"""Share of a scan that the map usually explains at a right pose. Only a smaller share is evidence against a pose."""
_MANY_UPDATES = 100
"""If there are more updates than this, only this number of updates counts."""
_SETTLED = 5
"""If there are more settled scans than this, only this number of scans counts."""
_USUAL_DEVIATIONS = (0.1, 0.05)
"""Usual standard deviations of a pose, meters and radians."""
_WIDEST = 4.0
"""Maximum logarithm of the ratio of a deviation to the usual deviation."""


class ParticleEvidence(NamedTuple):
    """Features of a particle filter that distinguish right from wrong poses, or the features' coefficients.

    Attributes:
        always: 1.
        lost: 1 if the filter reports that the robot is lost.
        anywhere: 1 while the pose is searched on the whole map.
        unproven: 1 if the pose was found by a search not long ago.
        unproven_updates: logarithm of the number of updates since an unproven pose was found, from 0.
        updates: logarithm of the number of updates of any pose.
        unexplained: share of the last scan that the map does not explain.
        lately_unexplained: share that the map usually explains at a right pose, minus the share of the last scans that
            it explains, but at least 0.
        below_usual: share by which the short-term average of the agreement is below the long-term average.
        misfit: see `ScanAgreement`.
        lead: see `ParticleBelief`.
        rival: 1 while there is a rival.
        unsettled: 1 if no scan was settled, falling to 0 as more scans in a row are settled.
        outside: share of the weight outside the heaviest cluster.
        deviation: logarithm of the ratio of the position's standard deviation to the usual deviation.
        turn_deviation: the same for the heading.
    """

    always: float
    lost: float
    anywhere: float
    unproven: float
    unproven_updates: float
    updates: float
    unexplained: float
    lately_unexplained: float
    below_usual: float
    misfit: float
    lead: float
    rival: float
    unsettled: float
    outside: float
    deviation: float
    turn_deviation: float

    @classmethod
    def of(
        cls, place: Hypothesis, lead: float, *, lost: bool, anywhere: bool, proven: bool, rival: bool
    ) -> "ParticleEvidence":
        """Collect the evidence after an update. See `ParticleBelief` for the arguments."""
        agreement, covariance = place.agreement, place.covariance
        updates = elementary.log(1.0 + min(place.updates, _MANY_UPDATES))
        return cls(
            always=1.0,
            lost=float(lost),
            anywhere=float(anywhere),
            unproven=float(not proven),
            unproven_updates=0.0 if proven else updates,
            updates=updates,
            unexplained=1.0 - agreement.last,
            lately_unexplained=max(0.0, _LEAST_EXPLAINED - agreement.recent),
            below_usual=max(0.0, 1.0 - agreement.fast / agreement.slow) if agreement.slow > 0.0 else 0.0,
            misfit=agreement.misfit,
            lead=lead,
            rival=float(rival),
            unsettled=1.0 - min(place.settled, _SETTLED) / _SETTLED,
            outside=1.0 - place.share,
            deviation=log_deviation(max(covariance[0, 0], covariance[1, 1]), _USUAL_DEVIATIONS[0]),
            turn_deviation=log_deviation(covariance[2, 2], _USUAL_DEVIATIONS[1]),
        )


class GaussianEvidence(NamedTuple):
    """Features of a Kalman filter that distinguish right from wrong poses, or the features' coefficients.

    Attributes:
        always: 1.
        forgotten: 1 while the filter has no pose.
        lost: 1 if the filter reports that the robot is lost.
        refused: rejected scans since the last accepted scan, as a share of the number that makes the robot lost.
        poor: consecutive scans that fit badly, as a share of the number in `refused`.
        unmatched: share of the points of the last scan that are not on walls.
        matches: logarithm of the number of matches since the pose was set or found, from 0.
        deviation: see `ParticleEvidence`.
        turn_deviation: see `ParticleEvidence`.
        drive_noise: logarithm of the factor by which the noise of distances exceeds the parameters.
        turn_noise: the same for turns.
    """

    always: float
    forgotten: float
    lost: float
    refused: float
    poor: float
    unmatched: float
    matches: float
    deviation: float
    turn_deviation: float
    drive_noise: float
    turn_noise: float

    @classmethod
    def of(
        cls,
        covariance: FloatArray,
        noise_scales: tuple[float, float],
        *,
        forgotten: bool,
        lost: bool,
        refused: float,
        poor: float,
        unmatched: float,
        matches: int,
    ) -> "GaussianEvidence":
        """Collect the evidence after a scan. `covariance` is the (3, 3) covariance of the pose."""
        return cls(
            always=1.0,
            forgotten=float(forgotten),
            lost=float(lost),
            refused=min(refused, 1.0),
            poor=min(poor, 1.0),
            unmatched=unmatched,
            matches=elementary.log(1.0 + min(matches, _MANY_UPDATES)),
            deviation=log_deviation(max(covariance[0, 0], covariance[1, 1]), _USUAL_DEVIATIONS[0]),
            turn_deviation=log_deviation(covariance[2, 2], _USUAL_DEVIATIONS[1]),
            drive_noise=elementary.log(noise_scales[0]),
            turn_noise=elementary.log(noise_scales[1]),
        )


def log_deviation(variance: float, usual: float) -> float:
    """Return the logarithm of the ratio of a standard deviation to the usual deviation, bounded on both sides."""
    if variance <= 0.0:
        return -_WIDEST
    return max(-_WIDEST, min(0.5 * elementary.log(variance / (usual * usual)), _WIDEST))


def probability(coefficients: Sequence[float], evidence: Sequence[float]) -> float:
    """Return the probability, 0 to 1, of a logistic model with one coefficient for each piece of evidence."""
    return 1.0 / (1.0 + elementary.exp(-math.fsum(map(mul, coefficients, evidence))))
