"""Algebra of small matrices, with sums in a fixed order.

The libraries behind numpy's `@` and `numpy.linalg` choose their kernels for the processor. Kernels differ in the order
of sums, so the last bits of a result differ between machines.

Source: Golub, Van Loan, Matrix Computations, 4th ed. (2013), sections 3.4 (elimination with partial pivoting) and 4.2
(Cholesky's factor of a semidefinite matrix).
"""

import math

import numpy as np

from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit


@njit(cache=True)
def product(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the (n, m) product of an (n, k) and a (k, m) matrix."""
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            for k in range(a.shape[1]):
                out[i, j] += a[i, k] * b[k, j]
    return out


@njit(cache=True)
def solution(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Return the (n, m) solution of linear equations: (n, n) matrix, (n, m) right sides.

    It is nan if the matrix is singular.
    """
    a, x = matrix.copy(), right.copy()
    n = a.shape[0]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        if a[pivot, k] == 0.0:
            x[:] = np.nan
            return x
        if pivot != k:
            for j in range(n):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
            for j in range(x.shape[1]):
                x[k, j], x[pivot, j] = x[pivot, j], x[k, j]
        for i in range(k + 1, n):
            factor = a[i, k] / a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= factor * a[k, j]
            for j in range(x.shape[1]):
                x[i, j] -= factor * x[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(x.shape[1]):
            for i in range(k + 1, n):
                x[k, j] -= a[k, i] * x[i, j]
            x[k, j] /= a[k, k]
    return x


@njit(cache=True)
def damped_solution(matrix: FloatArray, right: FloatArray, damping: float) -> FloatArray:
    """Return the (n, m) step of damped least squares for (n, n) normal equations and (n, m) right sides.

    Args:
        matrix: normal equations.
        right: right sides.
        damping: proportion of the diagonal's mean that is added to the diagonal. A tiny amount is always added, so that
            the solution is 0 in directions without any constraint.

    Source: Nocedal, Wright, Numerical Optimization, 2nd ed. (2006), section 10.3 (Levenberg and Marquardt).
    """
    damped = matrix.copy()
    n = matrix.shape[0]
    trace = 0.0
    for a in range(n):
        trace += matrix[a, a]
    for a in range(n):
        damped[a, a] += damping * trace / n + 1e-9
    return solution(damped, right)


def inverse(matrix: FloatArray) -> FloatArray:
    """Return the (n, n) inverse of a matrix, or nan if it is singular."""
    return solution(np.ascontiguousarray(matrix), np.eye(len(matrix)))


@njit(cache=True)
def root(covariance: FloatArray) -> FloatArray:
    """Return the (n, n) lower triangular factor of a covariance, which may be singular.

    The product of the factor and its transpose is the covariance. If a direction has no variance, e.g. if the heading
    is exactly known, its column is zero.
    """
    n = covariance.shape[0]
    out = np.zeros((n, n))
    for j in range(n):
        left = covariance[j, j]
        for k in range(j):
            left -= out[j, k] * out[j, k]
        # Rounding may leave a tiny positive or negative number instead of 0.
        if left <= 1e-14 * covariance[j, j] or left <= 0.0:
            continue
        out[j, j] = math.sqrt(left)
        for i in range(j + 1, n):
            rest = covariance[i, j]
            for k in range(j):
                rest -= out[i, k] * out[j, k]
            out[i, j] = rest / out[j, j]
    return out


def covariance_of(rows: FloatArray) -> FloatArray:
    """Return the (m, m) covariance of (n, m) rows about their mean. All rows have the same weight."""
    off = rows - rows.mean(axis=0)
    return product(np.ascontiguousarray(off.T), off) / len(rows)
