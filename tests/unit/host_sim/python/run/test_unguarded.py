# SPDX-License-Identifier: Apache-2.0
"""The kept share of recordings that were made by hand, and what ``hubsim sim`` says of it."""

from concurrent.futures import Future

import numpy as np
import pytest
from hubsim import scenario
from hubsim.cli import kept
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run import unguarded
from regen_table import unguarded as ideal
from regen_table.schema import Drive
from rich.progress import Progress

KMH40 = 40.0 / 3.6 / 0.25


def signals(time_s: Rows) -> dict[str, Rows]:
    """Return a second of braking with 20 N m at 40 km/h, half a second after the beginning."""
    ones = np.ones(len(time_s))
    brake = np.where((time_s >= 0.5) & (time_s < 1.5), 20.0, 0.0)
    values = (time_s, brake, KMH40 * ones, 25.0 * ones, 54.0 * ones, -0.1 * ones, 0.9 * ones)
    return dict(zip(unguarded.SIGNALS, values, strict=True))


def test_share_is_of_the_ideal_of_the_braking_alone(drive: Drive) -> None:
    one = np.ones(1)
    at = ideal.Instants(one, 20.0 * one, KMH40 * one, 25.0 * one, 54.0 * one, -0.1 * one, 0.9 * one)
    second_j = ideal.returned_j(drive, at)
    assert second_j > 2000.0
    for interval_s in (0.01, 0.025, 0.05):
        rows = signals(np.arange(0.0, 2.0, interval_s))
        assert unguarded.kept_share(drive, rows, second_j, 4) == pytest.approx(1.0, rel=1e-6)
        assert unguarded.kept_share(drive, rows, 0.5 * second_j, 4) == pytest.approx(0.5, rel=1e-6)
        # One wheel of four has a quarter of it.
        alone = unguarded.kept_share(drive, rows, 0.25 * second_j, 1)
        assert alone == pytest.approx(1.0, rel=1e-6)


def test_without_braking_there_is_no_share(drive: Drive) -> None:
    rows = signals(np.arange(0.0, 0.4, 0.01))
    assert np.isnan(unguarded.kept_share(drive, rows, 0.0, 4))


def test_the_longer_cycle_runs_meanwhile_and_ends_when_the_comparison_fails(
    drive: Drive, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sixty seconds of udds, one wheel of four."""
    load = scenario.load
    monkeypatch.setattr(
        scenario,
        "load",
        lambda name, keys, vehicle: load(name, keys | {"max_duration_s": 60.0}, vehicle),
    )
    waiting: dict[str, Future[float]]
    with kept.meanwhile([drive], "ece15", {}, Progress(disable=True)) as waiting:
        share = waiting["udds"].result()
    assert 0.98 < share < 1.01
    assert "99.50 % on ece15, 98.00 % on udds" in kept.line({"ece15": 0.995, "udds": 0.98})
    with kept.meanwhile([drive], "stop", {}, Progress(disable=True)) as waiting:
        assert waiting == {}
    with (
        pytest.raises(RuntimeError),
        kept.meanwhile([drive], "ece15", {}, Progress(disable=True)) as waiting,
    ):
        raise RuntimeError
    with pytest.raises(HubsimError, match="udds: stopped at"):
        waiting["udds"].result()
