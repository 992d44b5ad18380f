"""Bins of particles, clusters of bins, and the summary of a cloud of particles as one pose.

The bins have the size of amcl's: 0.5 m by 0.5 m by 10 degrees. Their number measures the spread of the cloud (KLD
sampling). They also separate hypotheses: bins that touch, even if only at a corner, belong to one cluster.

Source: pf_kdtree.c. Difference from ROS: the bins at -180 and +180 degrees touch, while amcl splits a cloud that faces
west.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit

BIN_SIDE = 0.5
"""Length of a bin's sides, meters."""
SECTORS = 36
"""Number of bins around the circle."""

_EMPTY = -1
_HALF = 1 << 24


class ParticleBins(NamedTuple):
    """The occupied bins of a cloud.

    Attributes:
        of_particle: (n,) bin of each particle. Bins are numbered from 0 in the order of their first particles.
        corners: (k, 3) position of each bin on the lattice: along x, along y, around.
        slots: hash table from packed lattice positions to bins, with -1 in empty slots.
    """

    of_particle: NDArray[np.int64]
    corners: NDArray[np.int64]
    slots: NDArray[np.int64]


class CloudSummary(NamedTuple):
    """Summary of a cloud as one pose.

    Attributes:
        mean: weighted mean of the heaviest cluster, in the map.
        covariance: (3, 3) covariance of the whole cloud about this mean: m^2, m rad, rad^2.
        weight: share of the weight in the heaviest cluster.
        variances: (3,) variances of the heaviest cluster alone, about its mean: m^2, m^2, rad^2.
    """

    mean: Pose2
    covariance: FloatArray
    weight: float
    variances: FloatArray


@njit(cache=True)
def _slot(slots: NDArray[np.int64], corners: NDArray[np.int64], col: int, row: int, sector: int) -> int:
    """Return the slot of the bin with this lattice position. If there is no such bin, return the empty slot for it.

    The method is open addressing with linear probing. The table is at least half empty, so the search ends.
    """
    mask = slots.size - 1
    packed = ((col + _HALF) * (2 * _HALF) + row + _HALF) * SECTORS + sector
    # Multiplicative hashing spreads neighboring bins over the table.
    slot = (packed * 0x9E3779B97F4A7C1 >> 17) & mask
    while True:
        found = slots[slot]
        if found == _EMPTY or (corners[found, 0] == col and corners[found, 1] == row and corners[found, 2] == sector):
            return slot
        slot = (slot + 1) & mask


@njit(cache=True)
def _bin(particles: FloatArray) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    n = particles.shape[0]
    capacity = 16
    # The capacity is a power of two, so that a mask replaces the remainder. The table is at least half empty, so that
    # searches are short.
    while capacity < 2 * n:
        capacity *= 2
    slots = np.full(capacity, _EMPTY, dtype=np.int64)
    corners = np.empty((n, 3), dtype=np.int64)
    of_particle = np.empty(n, dtype=np.int64)
    count = 0
    for i in range(n):
        col = math.floor(particles[i, 0] / BIN_SIDE)
        row = math.floor(particles[i, 1] / BIN_SIDE)
        sector = math.floor(particles[i, 2] * (SECTORS / (2.0 * math.pi))) % SECTORS
        slot = _slot(slots, corners, col, row, sector)
        if slots[slot] == _EMPTY:
            slots[slot] = count
            corners[count, 0], corners[count, 1], corners[count, 2] = col, row, sector
            count += 1
        of_particle[i] = slots[slot]
    return of_particle, corners[:count], slots


def bin_particles(particles: FloatArray) -> ParticleBins:
    """Return the bins of (n, 3) poses."""
    return ParticleBins(*_bin(particles))


@njit(cache=True)
def _cluster(corners: NDArray[np.int64], slots: NDArray[np.int64]) -> NDArray[np.int64]:
    count = corners.shape[0]
    # Flood fill from bin to bin through the 26 neighbors on the lattice. Sectors wrap around the circle.
    labels = np.full(count, _EMPTY, dtype=np.int64)
    waiting = np.empty(count, dtype=np.int64)
    clusters = 0
    for seed in range(count):
        if labels[seed] != _EMPTY:
            continue
        labels[seed] = clusters
        waiting[0] = seed
        size = 1
        while size > 0:
            size -= 1
            here = waiting[size]
            for offset in range(27):
                slot = _slot(
                    slots,
                    corners,
                    corners[here, 0] + offset // 9 - 1,
                    corners[here, 1] + offset // 3 % 3 - 1,
                    (corners[here, 2] + offset % 3 - 1) % SECTORS,
                )
                neighbour = slots[slot]
                if neighbour != _EMPTY and labels[neighbour] == _EMPTY:
                    labels[neighbour] = clusters
                    waiting[size] = neighbour
                    size += 1
        clusters += 1
    return labels


def cluster_bins(bins: ParticleBins) -> NDArray[np.int64]:
    """Return the (k,) cluster of each bin, numbered from 0: connected components of touching bins."""
    return _cluster(bins.corners, bins.slots)


@njit(cache=True)
def _summarise(
    particles: FloatArray, weights: FloatArray, of_particle: NDArray[np.int64], labels: NDArray[np.int64]
) -> tuple[float, float, float, FloatArray, float, FloatArray]:
    mass = np.zeros(labels.max() + 1)
    total = 0.0
    for i in range(weights.size):
        mass[labels[of_particle[i]]] += weights[i]
        total += weights[i]
    heaviest = np.argmax(mass)
    x, y, c, s = 0.0, 0.0, 0.0, 0.0
    # The mean heading is the direction of the sum of unit vectors, because angles cannot be averaged across -pi.
    for i in range(weights.size):
        if labels[of_particle[i]] == heaviest:
            x += weights[i] * particles[i, 0]
            y += weights[i] * particles[i, 1]
            cosine, sine = elementary.cos_sin(particles[i, 2])
            c += weights[i] * cosine
            s += weights[i] * sine
    x /= mass[heaviest]
    y /= mass[heaviest]
    theta = wrap_angle(elementary.atan2(s, c))
    covariance = np.zeros((3, 3))
    variances = np.zeros(3)
    for i in range(weights.size):
        dx, dy = particles[i, 0] - x, particles[i, 1] - y
        dtheta = wrap_angle(particles[i, 2] - theta)
        weight = weights[i] / total
        covariance[0, 0] += weight * dx * dx
        covariance[0, 1] += weight * dx * dy
        covariance[0, 2] += weight * dx * dtheta
        covariance[1, 1] += weight * dy * dy
        covariance[1, 2] += weight * dy * dtheta
        covariance[2, 2] += weight * dtheta * dtheta
        if labels[of_particle[i]] == heaviest:
            variances[0] += weight * dx * dx
            variances[1] += weight * dy * dy
            variances[2] += weight * dtheta * dtheta
    covariance[1, 0] = covariance[0, 1]
    covariance[2, 0] = covariance[0, 2]
    covariance[2, 1] = covariance[1, 2]
    share = mass[heaviest] / total
    return x, y, theta, covariance, share, variances / share


def summarise(particles: FloatArray, weights: FloatArray, bins: ParticleBins) -> CloudSummary:
    """Return the mean of the heaviest cluster, and the spread of the whole cloud about it.

    Args:
        particles: (n, 3) poses in the map, n > 0.
        weights: (n,) not all 0.
        bins: the bins of these particles.

    Source: pf_cluster_stats. Differences from ROS: the covariance is about the reported pose (in amcl, about the mean
        of all clusters). It includes the correlations of heading and position, which are 0 in amcl.
    """
    x, y, theta, covariance, weight, variances = _summarise(particles, weights, bins.of_particle, cluster_bins(bins))
    return CloudSummary(Pose2(x, y, theta), covariance, weight, variances)
