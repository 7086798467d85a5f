# SPDX-License-Identifier: Apache-2.0
"""Linear least squares: none below zero, and deviations from the residuals themselves."""

from itertools import combinations

import numpy as np

from regen_table.models import Array


def non_negative(design: Array, wanted: Array) -> Array:
    """Return x >= 0 of least |design x - wanted|, by trying every set of positive elements.

    The best such set is the solution: on it the least squares are unconstrained, and each other
    feasible set leaves more. For at most six columns.
    """
    count = design.shape[1]
    norm = np.linalg.norm(design, axis=0)
    scaled = design / np.where(norm > 0.0, norm, 1.0)
    free = np.linalg.lstsq(scaled, wanted, rcond=None)[0]
    if np.all(free >= 0.0):
        return free / np.where(norm > 0.0, norm, 1.0)
    best, least = np.zeros(count), float(wanted @ wanted)
    for size in range(1, count + 1):
        for chosen in combinations(np.flatnonzero(norm > 0.0), size):
            part = scaled[:, chosen]
            found = np.linalg.lstsq(part, wanted, rcond=None)[0]
            if np.all(found >= 0.0):
                squares = float(np.sum(np.square(wanted - part @ found)))
                if squares < least:
                    best, least = np.zeros(count), squares
                    best[list(chosen)] = found
    return best / np.where(norm > 0.0, norm, 1.0)


def sandwich(design: Array, left: Array) -> Array:
    """Return the covariance of least squares whose errors have unknown, unequal deviations.

    HC3 of MacKinnon and White, Journal of Econometrics 29, 1985.
    """
    norm = np.linalg.norm(design, axis=0)
    scaled = design / norm
    inverse = np.linalg.pinv(scaled.T @ scaled)
    leverage = np.einsum("ij,jk,ik->i", scaled, inverse, scaled)
    errors = left / np.maximum(1.0 - leverage, 1e-6)
    middle = scaled.T @ (scaled * np.square(errors)[:, np.newaxis])
    return np.asarray(inverse @ middle @ inverse / np.outer(norm, norm))
