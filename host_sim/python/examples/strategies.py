# SPDX-License-Identifier: Apache-2.0
"""One stop under three braking strategies: where the kinetic energy of the vehicle goes.

    ./tools/dev python host_sim/python/examples/strategies.py

The bench is the vehicle: four controllers, four motors, one battery. A drive's TOML file makes
both, and a setting on top of it changes both; here it is the strategy of the braking arbiter.
"""

import hubsim
import numpy as np
from hubsim.engine import ROOT

DRIVE = ROOT / "tools" / "motors" / "lu2013.toml"
STRATEGIES = ("parallel_ratio", "parallel_free_travel", "series_optimal")
DEMAND_NM = 40.0
SPEED_KMH = 40.0


def stop(strategy: str) -> tuple[float, hubsim.Recording]:
    """Stop the vehicle; return the share (1) of its energy that the cells got, and a recording."""
    config = hubsim.load_configuration(DRIVE, {"brake.strategy": strategy})
    with hubsim.Bench(
        config,
        initial_speed_kmh=SPEED_KMH,
        demand_nm=DEMAND_NM,
        drag=False,
        stop_at_standstill=True,
    ) as bench:
        recording = bench.run()
        kinetic_j = -bench["energy.kinetic_j"]
        return -bench["energy.chemical_j"] / kinetic_j, recording


def main() -> dict[str, float]:
    """Print and return the share stored for each strategy."""
    stored = {}
    for strategy in STRATEGIES:
        stored[strategy], recording = stop(strategy)
        charge_a = -np.min(recording["battery.current_a"])
        strongest_nm = -np.min(recording["wheel0.motor_torque_nm"])
        print(
            f"{strategy:22} {100.0 * stored[strategy]:6.1f} % of the kinetic energy stored, motor "
            f"up to {strongest_nm:5.1f} N m, "
            f"battery charged with up to {charge_a:.1f} {recording.units['battery.current_a']}"
        )
    return stored


if __name__ == "__main__":
    main()
