"""Resampling: tempered weights, systematic draws in proportion to them, and the cloud's size by KLD sampling.

Resampling replaces a weighted cloud by one of equal weights, in which a particle has as many heirs as its weight asks
for. Three things make that robust. Weights are tempered first, so that one scan cannot leave a single particle alive.
The draw is systematic: its number of heirs differs from the ideal one by less than 1. And the number drawn follows the
spread of the cloud, so that a robot that knows where it is costs little.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

_HALVINGS = 8
"""Steps in which the tempering exponent is found, to 1/256."""


@njit(cache=True)
def _effective(logs: FloatArray, exponent: float) -> float:
    """Return the effective number, (sum w)^2 / sum w^2, of particles of weights w = exp(exponent * logs); no log is above 0."""
    total, squares = 0.0, 0.0
    for log in logs:
        weight = elementary.exp(exponent * log)
        total += weight
        squares += weight * weight
    return total * total / squares


@njit(cache=True)
def tempered(logs: FloatArray, share: float) -> FloatArray:
    """Return the likelihoods, to a power so low that they leave a share of equal particles effective.

    Beams end on the same walls and share the map's errors: multiplied as though they were independent, those of one
    scan often leave one particle of a hundred. Such a filter is surer than it is right, and forgets the other places
    where it might be.

    Args:
        logs: (n,) log likelihoods, n > 0.
        share: least effective number, as a share of n.

    Returns:
        (n,) likelihoods, the greatest 1, to the greatest power up to 1 that does.

    Source: Probabilistic Robotics, section 6.3.4, on exponents below 1; Liu (1996) for the effective number. Differs:
        the exponent is as low as the cloud needs, not fixed.
    """
    logs = logs - logs.max()
    exponent = 1.0
    if _effective(logs, 1.0) < share * logs.size:
        # The effective number falls as the exponent grows, from all of them at 0: bisect. `low` always keeps the share.
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
    """Number of particles that a cloud over this number of bins needs.

    With this many the Kullback-Leibler distance between the cloud and the true distribution stays below `error`, with
    the probability whose normal quantile is `quantile`.

    Args:
        bins: occupied bins, k.
        error: the greatest distance allowed, epsilon.
        quantile: upper 1 - delta quantile of the standard normal, z.
        least: the answer is never below.
        most: nor above; the answer where `error` is 0.

    Source: Fox, Adapting the sample size in particle filters through KLD-sampling (2003), with the Wilson-Hilferty
        approximation of the chi-square quantile; bounds from pf.c. Differs: one bin needs `least` particles; amcl
        takes `most`, though the tightest cloud needs fewest.
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
    """Draw `count` of n particles in proportion to their weights, by one random number.

    Args:
        weights: (n,) not negative, not all 0; of any sum.
        count: number to draw.
        offset: uniform in [0, 1).

    Returns:
        (count,) indices, ascending: particle i comes floor or ceil of `count * weights[i] / sum` times.

    Source: Probabilistic Robotics, table 4.4 (low variance sampler).
    """
    # A comb of `count` teeth, `step` apart and shifted by the offset, is laid over the weights put end to end: each
    # tooth draws the particle that it falls on.
    step = weights.sum() / count
    out = np.empty(count, dtype=np.int64)
    last = weights.size - 1
    # Rounding may leave the running sum short of the last tooth: that one belongs to the last particle with a weight.
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
    """Draw as many particles as the drawn cloud itself needs.

    A systematic draw must know its size beforehand, but KLD sampling knows it only afterwards. So the draw is repeated,
    larger each time, until it holds as many particles as the bins that it fills ask for, or `most`.

    Args:
        weights: (n,) as for `systematic`.
        of_particle: (n,) the bin of each particle, from 0.
        offset: uniform in [0, 1).
        error: see `sample_limit`.
        quantile: see `sample_limit`.
        least: smallest draw.
        most: largest draw.

    Returns:
        (m,) indices, ascending, least <= m <= most.

    Differs: amcl draws one by one until there are enough, which cannot be had together with low variance.
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
