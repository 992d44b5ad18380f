"""Resampling: tempered weights, systematic draws in proportion to them, and the cloud's size by KLD sampling.

Resampling replaces a weighted cloud with a cloud of equal weights, where each particle is copied in proportion to its
weight. Three measures make this robust. First, weights are tempered, so that one scan cannot leave only a single
particle. Second, the draw is systematic: the number of copies differs from the ideal number by less than 1. Third, the
number of particles depends on the spread of the cloud, so that a well localized robot needs little time.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

_HALVINGS = 8
"""Number of bisections for the tempering exponent, which is then accurate to 1/256."""


@njit(cache=True)
def _effective(logs: FloatArray, exponent: float) -> float:
    """Return the effective number (sum w)^2 / sum w^2 of particles with weights w = exp(exponent * logs), logs <= 0."""
    total, squares = 0.0, 0.0
    for log in logs:
        weight = elementary.exp(exponent * log)
        total += weight
        squares += weight * weight
    return total * total / squares


@njit(cache=True)
def tempered(logs: FloatArray, share: float) -> FloatArray:
    """Return the likelihoods, raised to a power at which the effective number of particles is large enough.

    The particles have equal weights before the scan.

    Beams end on the same walls and share the map's errors. If their likelihoods are multiplied as if they were
    independent, one scan often leaves only one particle of a hundred. Such a filter is more certain than it should be,
    and forgets other possible poses.

    Args:
        logs: (n,) log likelihoods, n > 0.
        share: minimum effective number, as a share of n.

    Returns:
        (n,) likelihoods with a maximum of 1. The power is the greatest number up to 1 that gives
            the effective number `share` times n.

    Source: Probabilistic Robotics, section 6.3.4, on exponents below 1; Liu (1996) for the effective number.
        Difference from the sources: the exponent is not fixed, but as low as the cloud requires.
    """
    logs = logs - logs.max()
    # The maximum logarithm becomes 0. So no exponential overflows, and at least one is not 0.
    exponent = 1.0
    if _effective(logs, 1.0) < share * logs.size:
        # With exponent 0 the effective number is n, and it falls as the exponent grows. So bisection finds the greatest
        # exponent. Invariant: with exponent `low`, the share is effective.
        low = 0.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + exponent)
            if _effective(logs, middle) < share * logs.size:
                exponent = middle
            else:
                low = middle
        exponent = low
    likelihoods = np.empty_like(logs)
    for i in range(logs.size):
        likelihoods[i] = elementary.exp(exponent * logs[i])
    return likelihoods


@njit(cache=True)
def sample_limit(bins: int, error: float, quantile: float, least: int, most: int) -> int:
    """Return the number of particles that a cloud needs if it occupies this number of bins.

    With this number of particles, the Kullback-Leibler distance between the cloud and the true distribution is below
    `error`, with the probability that corresponds to the normal quantile `quantile`.

    Args:
        bins: number of occupied bins, k.
        error: maximum distance, epsilon.
        quantile: upper 1 - delta quantile of the standard normal, z.
        least: lower bound of the result.
        most: upper bound of the result, and the result if `error` is 0.

    Source: Fox, Adapting the sample size in particle filters through KLD-sampling (2003), with the Wilson-Hilferty
        approximation of the chi-square quantile. Bounds from pf.c. Difference from the sources: a single bin needs
        `least` particles. amcl uses `most`, although the narrowest cloud needs the fewest particles.
    """
    if bins <= 1:
        return least
    if error <= 0.0:
        return most
    share = 2.0 / (9.0 * (bins - 1))
    needed = math.ceil((bins - 1) / (2.0 * error) * (1.0 - share + math.sqrt(share) * quantile) ** 3)
    return max(least, min(int(needed), most))


@njit(cache=True)
def systematic(weights: FloatArray, count: int, offset: float) -> NDArray[np.int64]:
    """Draw `count` of n particles in proportion to their weights, with one random number.

    Args:
        weights: (n,) not negative, not all 0. Their sum is arbitrary.
        count: number of particles to draw.
        offset: uniform in [0, 1).

    Returns:
        (count,) indices, ascending. The number of times that particle i occurs is `count * weights[i] / sum`, rounded
        down or up.

    Source: Probabilistic Robotics, table 4.4 (low variance sampler).
    """
    # Imagine the weights as segments on a line, and above them a comb with `count` teeth. The teeth are `step` apart,
    # and the comb is shifted by the offset. Each tooth draws the particle below it.
    step = weights.sum() / count
    out = np.empty(count, dtype=np.int64)
    last = weights.size - 1
    # Because of rounding, the running sum may end before the last tooth. Then this tooth draws the last particle with a
    # positive weight.
    while last > 0 and weights[last] == 0.0:
        last -= 1
    index = 0
    reached = weights[0]
    for i in range(count):
        tooth = (i + offset) * step
        while reached <= tooth and index < last:
            index += 1
            reached += weights[index]
        out[i] = index
    return out


@njit(cache=True)
def adaptive(
    weights: FloatArray,
    of_particle: NDArray[np.int64],
    offset: float,
    error: float,
    quantile: float,
    least: int,
    most: int,
) -> NDArray[np.int64]:
    """Draw particles systematically. The spread of the drawn cloud determines their number.

    A systematic draw needs its size beforehand, but KLD sampling gives the size only afterwards. So the draw is
    repeated with growing size, until it has the number of particles that their bins require, or `most` particles.

    Args:
        weights: (n,) see `systematic`.
        of_particle: (n,) bin of each particle, from 0.
        offset: uniform in [0, 1).
        error: see `sample_limit`.
        quantile: see `sample_limit`.
        least: minimum size of the draw.
        most: maximum size of the draw.

    Returns:
        (m,) indices, ascending, least <= m <= most.

    Difference from ROS: amcl draws particles one by one until there are enough, so it cannot use a draw with low
    variance.
    """
    count = least
    while True:
        drawn = systematic(weights, count, offset)
        seen = np.zeros(of_particle.max() + 1, dtype=np.bool_)
        bins = 0
        for index in drawn:
            if not seen[of_particle[index]]:
                seen[of_particle[index]] = True
                bins += 1
        needed = sample_limit(bins, error, quantile, least, most)
        if needed <= count:
            return drawn
        count = needed
