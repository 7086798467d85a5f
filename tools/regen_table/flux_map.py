# SPDX-License-Identifier: Apache-2.0
"""A motor's flux map: checks, torque, and the constants that stand for it at a torque.

Peak phase currents behind the iron branch and flux linkages, motor signs, the d axis along the
magnets (without magnets: along the larger flux), so that psi_d(0, 0) is the magnets' and at least
zero, and T = 1.5 p (psi_d i_q - psi_q i_d). The flux is that of one temperature of the magnets.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from regen_table.errors import ConfigurationError
from regen_table.models import Array

LEAST_POINTS = 3  # of an axis
SAME_A = 1e-6  # currents that are one point of an axis
ASYMMETRIC = 0.02  # of the largest flux: more between i_q and -i_q is refused
NOT_RECIPROCAL = 0.1  # of the smallest incremental inductance there
ANGLES = 721  # of the current, among which that of most torque is looked for
CURRENTS = 200


@dataclass(frozen=True)
class FluxMap:
    """Flux linkages over a grid of currents.

    Attributes
    ----------
    i_d_a, i_q_a : array
        Axes, rising; i_q symmetrical about zero.
    psi_d_wb, psi_q_wb : array
        Of the shape (i_d, i_q).
    """

    i_d_a: Array
    i_q_a: Array
    psi_d_wb: Array
    psi_q_wb: Array

    @property
    def largest_current_a(self) -> float:
        """Return the largest current whose every braking and driving angle lies in the map."""
        return float(min(-self.i_d_a[0], self.i_q_a[-1]))

    def flux_wb(self, i_d_a: Array, i_q_a: Array) -> tuple[Array, Array]:
        """Return both flux linkages, bilinear; NaN outside the grid."""
        i_d, i_q = np.broadcast_arrays(np.asarray(i_d_a, np.float64), np.asarray(i_q_a, np.float64))
        j = np.clip(np.searchsorted(self.i_d_a, i_d) - 1, 0, len(self.i_d_a) - 2)
        k = np.clip(np.searchsorted(self.i_q_a, i_q) - 1, 0, len(self.i_q_a) - 2)
        u = (i_d - self.i_d_a[j]) / (self.i_d_a[j + 1] - self.i_d_a[j])
        v = (i_q - self.i_q_a[k]) / (self.i_q_a[k + 1] - self.i_q_a[k])
        inside = (np.abs(u - 0.5) <= 0.5 + SAME_A) & (np.abs(v - 0.5) <= 0.5 + SAME_A)

        def between(psi: Array) -> Array:
            low = (1.0 - v) * psi[j, k] + v * psi[j, k + 1]
            high = (1.0 - v) * psi[j + 1, k] + v * psi[j + 1, k + 1]
            return np.where(inside, (1.0 - u) * low + u * high, np.nan)

        return between(self.psi_d_wb), between(self.psi_q_wb)

    def torque_nm(self, pole_pairs: int, i_d_a: Array, i_q_a: Array) -> Array:
        """Return the torque of currents."""
        psi_d, psi_q = self.flux_wb(i_d_a, i_q_a)
        return np.asarray(1.5 * pole_pairs * (psi_d * i_q_a - psi_q * i_d_a))


def extended_wb(found: FluxMap, i_d_a: Array, i_q_a: Array) -> tuple[Array, Array]:
    """Return both flux linkages, beyond the map along the straight lines of its last cells."""

    def inside(axis: Array, at: Array) -> tuple[Array, Array]:
        within = np.clip(at, axis[0], axis[-1])
        width = np.where(at > within, axis[-1] - axis[-2], axis[1] - axis[0])
        return within, np.divide(at - within, width)

    d, beyond_d = inside(found.i_d_a, i_d_a)
    q, beyond_q = inside(found.i_q_a, i_q_a)
    at = found.flux_wb(d, q)
    inner_d = found.flux_wb(
        np.where(beyond_d > 0, found.i_d_a[-2], np.where(beyond_d < 0, found.i_d_a[1], d)), q
    )
    inner_q = found.flux_wb(
        d, np.where(beyond_q > 0, found.i_q_a[-2], np.where(beyond_q < 0, found.i_q_a[1], q))
    )
    psi_d, psi_q = (
        np.asarray(value + np.abs(beyond_d) * (value - by_d) + np.abs(beyond_q) * (value - by_q))
        for value, by_d, by_q in zip(at, inner_d, inner_q, strict=True)
    )
    return psi_d, psi_q


@dataclass(frozen=True)
class Checks:
    """What a map was found to be.

    Attributes
    ----------
    asymmetry_wb : float
        Largest change that made psi_d even and psi_q odd in i_q.
    mirrored : bool
        Whether the file had i_q >= 0 alone.
    reciprocity_share : float
        Largest difference of the cross inductances of a cell, of the smallest incremental
        inductance there.
    """

    asymmetry_wb: float
    mirrored: bool
    reciprocity_share: float


def refuse_short(found: FluxMap, current_a: float) -> None:
    """Refuse a map that does not have every driving and braking angle of a current."""
    for name, most in (("-i_d", -float(found.i_d_a[0])), ("i_q", float(found.i_q_a[-1]))):
        if most < current_a * (1.0 - SAME_A):
            raise ConfigurationError(
                f"{name} up to {most:g} A, accepted: a map up to the largest phase current,"
                f" {current_a:g} A"
            )


def checked(found: FluxMap) -> tuple[FluxMap, Checks]:
    """Return a map that is symmetrical in i_q, with what was changed, refusing what is no motor's.

    Raises
    ------
    ConfigurationError
        Place, value, what is accepted.
    """
    for name, axis in (("i_d", found.i_d_a), ("i_q", found.i_q_a)):
        if len(axis) < LEAST_POINTS:
            raise ConfigurationError(
                f"{name}: {len(axis)} values, accepted: at least {LEAST_POINTS}"
            )
    if found.i_d_a[0] >= 0.0 or found.i_d_a[-1] < -SAME_A:
        raise ConfigurationError(
            f"i_d from {found.i_d_a[0]:g} to {found.i_d_a[-1]:g} A, accepted: from below zero to"
            " zero or above"
        )
    mirrored = abs(float(found.i_q_a[0])) <= SAME_A
    whole, change = _mirrored(found) if mirrored else _symmetrical(found)
    _refuse_falling(whole)
    _refuse_turned(whole)
    return whole, Checks(change, mirrored, _reciprocity(whole))


def _mirrored(found: FluxMap) -> tuple[FluxMap, float]:
    """Return a map of i_q >= 0 with its other half; psi_q at i_q = 0 becomes zero."""
    change = float(np.max(np.abs(found.psi_q_wb[:, 0])))
    _refuse_asymmetry(found, np.abs(found.psi_q_wb[:, :1]), "psi_q at i_q = 0")
    psi_q = found.psi_q_wb.copy()
    psi_q[:, 0] = 0.0
    whole = FluxMap(
        found.i_d_a,
        np.concatenate([-found.i_q_a[:0:-1], found.i_q_a]),
        np.concatenate([found.psi_d_wb[:, :0:-1], found.psi_d_wb], axis=1),
        np.concatenate([-psi_q[:, :0:-1], psi_q], axis=1),
    )
    return whole, change


def _symmetrical(found: FluxMap) -> tuple[FluxMap, float]:
    """Return the even part of psi_d and the odd one of psi_q over i_q."""
    if np.max(np.abs(found.i_q_a + found.i_q_a[::-1])) > SAME_A * len(found.i_q_a):
        raise ConfigurationError(
            f"i_q from {found.i_q_a[0]:g} to {found.i_q_a[-1]:g} A, accepted: the same values of"
            " either sign, or from zero up"
        )
    psi_d = 0.5 * (found.psi_d_wb + found.psi_d_wb[:, ::-1])
    psi_q = 0.5 * (found.psi_q_wb - found.psi_q_wb[:, ::-1])
    changes = np.abs(psi_d - found.psi_d_wb), np.abs(psi_q - found.psi_q_wb)
    for name, change in zip(("psi_d", "psi_q"), changes, strict=True):
        _refuse_asymmetry(found, change, f"{name} of i_q and -i_q")
    return replace(found, psi_d_wb=psi_d, psi_q_wb=psi_q), float(np.max(changes))


def _refuse_asymmetry(found: FluxMap, change_wb: Array, what: str) -> None:
    most = ASYMMETRIC * float(np.max(np.hypot(found.psi_d_wb, found.psi_q_wb)))
    j, k = np.unravel_index(int(np.argmax(change_wb)), change_wb.shape)
    if change_wb[j, k] > most:
        raise ConfigurationError(
            f"{what}: {change_wb[j, k]:.3g} Wb beside symmetry at i_d = {found.i_d_a[j]:g} A, i_q ="
            f" {found.i_q_a[k]:g} A, accepted: at most {most:.3g} Wb"
        )


def _refuse_falling(found: FluxMap) -> None:
    """Refuse a flux that does not rise with the current of its axis."""
    for name, psi, axis in (("psi_d", found.psi_d_wb, 0), ("psi_q", found.psi_q_wb, 1)):
        falls = np.argwhere(np.diff(psi, axis=axis) <= 0.0)
        for j, k in falls[:1]:
            rise = np.diff(psi, axis=axis)[j, k]
            raise ConfigurationError(
                f"{name} changes by {rise:.3g} Wb after i_d = {found.i_d_a[j]:g} A, i_q ="
                f" {found.i_q_a[k]:g} A, accepted: a flux that rises with i_{name[-1]}"
            )


def _refuse_turned(found: FluxMap) -> None:
    """Refuse a d axis that is not the magnets'."""
    psi_d = float(found.flux_wb(np.array(0.0), np.array(0.0))[0])
    largest = float(np.max(np.abs(found.psi_d_wb)))
    if psi_d < -ASYMMETRIC * largest:
        raise ConfigurationError(
            f"psi_d = {psi_d:.3g} Wb without current, accepted: zero or above (the d axis along the"
            " magnets' flux)"
        )


def _reciprocity(found: FluxMap) -> float:
    """Return the largest circulation of the flux around a cell, as difference of inductances.

    d psi_d/d i_q = d psi_q/d i_d where the flux is that of an energy. Refused: more than
    NOT_RECIPROCAL of the smallest incremental inductance of the cell.
    """
    d_step = np.diff(found.i_d_a)[:, np.newaxis]
    q_step = np.diff(found.i_q_a)[np.newaxis, :]
    by_q = np.diff(found.psi_d_wb, axis=1) / q_step
    by_d = np.diff(found.psi_q_wb, axis=0) / d_step
    difference = np.abs(0.5 * (by_q[1:] + by_q[:-1]) - 0.5 * (by_d[:, 1:] + by_d[:, :-1]))
    along_d = np.diff(found.psi_d_wb, axis=0) / d_step
    along_q = np.diff(found.psi_q_wb, axis=1) / q_step
    smallest = np.minimum(
        0.5 * (along_d[:, 1:] + along_d[:, :-1]), 0.5 * (along_q[1:] + along_q[:-1])
    )
    share = difference / smallest
    j, k = np.unravel_index(int(np.argmax(share)), share.shape)
    if share[j, k] > NOT_RECIPROCAL:
        raise ConfigurationError(
            f"cross inductances differ by {difference[j, k]:.3g} H at i_d = {found.i_d_a[j]:g} A,"
            f" i_q = {found.i_q_a[k]:g} A, {share[j, k]:.0%} of the smallest inductance there,"
            f" accepted: at most {NOT_RECIPROCAL:.0%} (d psi_d/d i_q = d psi_q/d i_d)"
        )
    return float(share[j, k])


@dataclass(frozen=True)
class Constants:
    """Flux and inductances that make a torque exact at its least current.

    Attributes
    ----------
    i_d_a, i_q_a, torque_nm : float
        The point, motor torque positive.
    flux_linkage_wb, d_inductance_h, q_inductance_h : float
        Chords: psi_d at i_d = 0 and this i_q; from there on to i_d; psi_q from zero.
    """

    i_d_a: float
    i_q_a: float
    torque_nm: float
    flux_linkage_wb: float
    d_inductance_h: float
    q_inductance_h: float

    def torque_at(self, pole_pairs: int, i_d_a: Array, i_q_a: Array) -> Array:
        """Return what a controller with these constants takes the torque of currents to be."""
        active = self.flux_linkage_wb + (self.d_inductance_h - self.q_inductance_h) * i_d_a
        return np.asarray(1.5 * pole_pairs * active * i_q_a)


def least_current(found: FluxMap, pole_pairs: int, current_a: Array) -> tuple[Array, Array, Array]:
    """Return i_d, i_q and torque of most torque for current magnitudes, driving."""
    angle = np.linspace(0.5 * np.pi, np.pi, ANGLES)[1:-1]
    i_d = current_a[:, np.newaxis] * np.cos(angle)
    i_q = current_a[:, np.newaxis] * np.sin(angle)
    if found.i_d_a[-1] > SAME_A:  # a motor with L_d > L_q drives with i_d > 0
        i_d, i_q = (
            np.concatenate([-i_d[:, ::-1], i_d], axis=1),
            np.concatenate([i_q[:, ::-1], i_q], axis=1),
        )
    i_d, i_q = (
        np.concatenate([part, edge[:, np.newaxis]], axis=1)
        for part, edge in ((i_d, 0.0 * current_a), (i_q, current_a))
    )
    torque = found.torque_nm(pole_pairs, i_d, i_q)
    best = np.nanargmax(np.where(np.isnan(torque), -np.inf, torque), axis=1)
    rows = np.arange(len(current_a))
    return i_d[rows, best], i_q[rows, best], torque[rows, best]


@dataclass(frozen=True)
class TorqueError:
    """The torque of constants beside the map's, at the map's least current for it."""

    current_a: float
    torque_nm: float
    error_share: float


def torque_errors(found: FluxMap, chosen: Constants, pole_pairs: int) -> list[TorqueError]:
    """Return what constants make of currents of a tenth to all of the map's largest."""
    current = np.linspace(0.1, 1.0, 10) * found.largest_current_a
    i_d, i_q, torque = least_current(found, pole_pairs, current)
    errors = chosen.torque_at(pole_pairs, i_d, i_q) / torque - 1.0
    return [
        TorqueError(*(float(value) for value in row))
        for row in zip(current, torque, errors, strict=True)
    ]


def constants(found: FluxMap, pole_pairs: int, torque_nm: float | None = None) -> Constants:
    """Return the constants of a torque; None: of half the map's largest.

    Raises
    ------
    ConfigurationError
        The torque is larger than any in the map.
    """
    current = np.linspace(0.0, found.largest_current_a, CURRENTS + 1)[1:]
    i_d, i_q, torque = least_current(found, pole_pairs, current)
    wanted = 0.5 * float(torque[-1]) if torque_nm is None else torque_nm
    if not 0.0 < wanted <= torque[-1]:
        raise ConfigurationError(
            f"{wanted:g} N m, accepted: above zero, up to {torque[-1]:.4g} N m, which the map's"
            f" {current[-1]:g} A make"
        )
    chosen = np.interp(wanted, np.concatenate([[0.0], torque]), np.concatenate([[0.0], current]))
    i_d, i_q, torque = least_current(found, pole_pairs, np.array([chosen]))
    one_d, one_q = float(i_d[0]), float(i_q[0])
    psi_d, psi_q = (float(psi) for psi in found.flux_wb(i_d[0], i_q[0]))
    magnets = float(found.flux_wb(np.array(0.0), i_q[0])[0])
    if abs(one_d) > SAME_A:
        d_inductance = (psi_d - magnets) / one_d
    else:
        step = np.array(found.i_d_a[0])
        d_inductance = (float(found.flux_wb(step, i_q[0])[0]) - magnets) / float(step)
    return Constants(one_d, one_q, float(torque[0]), magnets, d_inductance, psi_q / one_q)


def toml(chosen: Constants) -> str:
    """Return the keys of [motor]."""
    return (
        f"[motor]  # torque exact at {chosen.torque_nm:.4g} N m, i_d = {chosen.i_d_a:.4g} A,"
        f" i_q = {chosen.i_q_a:.4g} A\n"
        f"flux_linkage_wb = {chosen.flux_linkage_wb:.5g}\n"
        f"d_inductance_h = {chosen.d_inductance_h:.5g}\n"
        f"q_inductance_h = {chosen.q_inductance_h:.5g}\n"
    )


def text(found: FluxMap, checks: Checks, chosen: Constants, errors: Sequence[TorqueError]) -> str:
    """Return what was found, for people."""
    largest = float(np.max(np.hypot(found.psi_d_wb, found.psi_q_wb)))
    symmetry = "mirrored from i_q >= 0" if checks.mirrored else "made symmetrical in i_q"
    return "\n".join(
        [
            f"{len(found.i_d_a)} x {len(found.i_q_a)} points, i_d from {found.i_d_a[0]:g} to"
            f" {found.i_d_a[-1]:g} A, i_q up to {found.i_q_a[-1]:g} A, flux up to {largest:.4g} Wb",
            f"{symmetry}: changed by at most {checks.asymmetry_wb:.2g} Wb; cross inductances differ"
            f" by at most {checks.reciprocity_share:.1%} of the smallest inductance",
            f"constants of {chosen.torque_nm:.4g} N m (i_d {chosen.i_d_a:.4g} A, i_q"
            f" {chosen.i_q_a:.4g} A): flux_linkage_wb {chosen.flux_linkage_wb:.4g}, d_inductance_h"
            f" {chosen.d_inductance_h:.4g}, q_inductance_h {chosen.q_inductance_h:.4g}",
            *(
                f"at {error.current_a:.4g} A, {error.torque_nm:.4g} N m: constants say"
                f" {error.error_share:+.1%}"
                for error in errors
            ),
        ]
    )
