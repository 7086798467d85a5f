# SPDX-License-Identifier: Apache-2.0
"""Hundreds of stops from many speeds with many demands and masses, each with two strategies.

For each of them energy is conserved, the vehicle stops without a fault, and series_optimal stores
more than the fixed split.
"""

import csv
import math
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

DEMANDS, SPEEDS, MASSES_KG = 24, 6, (560, 760)
VARIED = (
    f"demand_nm=range(5,120,{DEMANDS})",
    f"initial_speed_kmh=range(10,60,{SPEEDS})",
    f"plant.vehicle.mass_kg={','.join(map(str, MASSES_KG))}",
    "brake.strategy=series_optimal,parallel_ratio",
)
# Relative to the energy exchanged (host_sim/README.md).
LARGEST_RESIDUAL = 1e-5
LIMIT_S = 3000


def test_every_vehicle_stops_and_stores_most_with_series_optimal(tmp_path: Path) -> None:
    table = tmp_path / "stops.csv"
    options = [word for varied in VARIED for word in ("--vary", varied)]
    done = subprocess.run(
        [sys.executable, "-m", "hubsim", "sweep", "stop", *options, "--output", str(table)],
        cwd=tmp_path, capture_output=True, text=True, timeout=LIMIT_S, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    with table.open(encoding="utf-8", newline="") as text:
        rows = list(csv.DictReader(text))
    cases: dict[tuple[str, str, str], dict[str, float]] = defaultdict(dict)
    for row in rows:
        assert row["error"] == "", row
        assert row["stopped"] == "true", row
        assert row["faults"] == "0", row
        assert math.fabs(float(row["residual_relative"])) < LARGEST_RESIDUAL, row
        assert float(row["battery_returned_j"]) < float(row["kinetic_energy_j"]), row
        case = (row["demand_nm"], row["initial_speed_kmh"], row["plant.vehicle.mass_kg"])
        cases[case][row["strategy"]] = float(row["battery_returned_j"])
    assert len(cases) == DEMANDS * SPEEDS * len(MASSES_KG)
    for case, stored_j in cases.items():
        assert stored_j["series_optimal"] > stored_j["parallel_ratio"], case
