# SPDX-License-Identifier: Apache-2.0
"""Write drives and what ``regen_table`` answers about them as a C++ header: ``optimum_values.py
OUT.hpp [SHARED]``.

Several builds of the same tree share the folder SHARED: the first computes, the others copy, as
long as the contents of all sources and the versions of Python and NumPy are the same.

The drives' numbers come straight from the TOML files and the random drives of the Python tests, the
answers from ``solve`` and ``evaluate``. Torques and speeds of either sign; NaN where an answer is
null.
"""

import fcntl
import hashlib
import math
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import plausible
from regen_table import points, schema

ROOT = Path(__file__).resolve().parents[2]
Row = dict[str, float | bool | str | None]
TYPES = {bool: "bool ", int: "int ", float: "double ", str: "const char *", type(None): "double "}


def drive_row(drive: schema.Drive) -> Row:
    """Return every number of a drive that losses, limits and manoeuvres depend on, SI units."""
    motor, inverter, battery, vehicle = drive.motor, drive.inverter, drive.battery, drive.vehicle
    a0, a1 = motor.iron_loss_resistance_ohm or (math.inf, 0.0)
    voltage = battery.open_circuit_voltage_v
    return {
        "name": drive.name,
        "pole_pairs": motor.pole_pairs,
        "resistance_ohm": motor.phase_resistance_ohm,
        "reference_temperature_C": motor.reference_temperature_c,
        "resistance_per_K": motor.resistance_temperature_coefficient_per_k,
        "d_inductance_H": motor.d_inductance_h,
        "q_inductance_H": motor.q_inductance_h,
        "flux_Wb": motor.flux_linkage_wb,
        "flux_per_K": motor.flux_temperature_coefficient_per_k or 0.0,
        "iron_ohm": a0,
        "iron_ohm_s": a1,
        "friction_Nm": motor.friction_torque_nm,
        "viscous_Nm_s": motor.viscous_friction_nm_s,
        "max_torque_Nm": motor.max_torque_nm,
        "max_power_W": motor.max_power_w,
        "max_current_A": motor.max_phase_current_a,
        "max_speed_rad_s": motor.max_speed_rpm * math.pi / 30.0,
        "switch_ohm": inverter.switch_resistance_ohm,
        "diode_V": inverter.diode_forward_voltage_v,
        "diode_ohm": inverter.diode_resistance_ohm,
        "dead_time_s": inverter.dead_time_s,
        "pwm_Hz": inverter.pwm_frequency_hz,
        "turn_on_J_per_A": inverter.turn_on_loss_j_per_a,
        "turn_off_J_per_A": inverter.turn_off_loss_j_per_a,
        "open_circuit_V": voltage if isinstance(voltage, float) else math.nan,
        "pack_ohm": battery.series_resistance_ohm + battery.polarisation_resistance_ohm,
        "driven_wheels": vehicle.driven_wheels,
        "mass_kg": vehicle.mass_kg,
        "wheel_radius_m": vehicle.wheel_radius_m,
        "frontal_area_m2": vehicle.frontal_area_m2,
        "drag_coefficient": vehicle.drag_coefficient,
        "rolling_resistance": vehicle.rolling_resistance,
        "handover_end_rad_s": drive.control.handover_end_rpm * math.pi / 30.0,
        "coldest_C": drive.table.temperature_range_c[0],
        "hottest_C": drive.table.temperature_range_c[1],
    }


def answers(drives: list[schema.Drive]) -> tuple[list[Row], list[Row]]:
    """Return what ``solve`` and ``evaluate`` say, once with i_d = 0 and once with both currents
    free, of every drive.
    """
    rng = np.random.default_rng(20131)
    solved: list[Row] = []
    evaluated: list[Row] = []
    for index, drive in enumerate(drives):
        for free in (False, True):
            how = points.setting(drive, free)
            speed = float(
                drive.motor.max_speed_rpm * rng.uniform(0.03, 1.0) * rng.choice([-1.0, 1.0])
            )
            warm = float(rng.uniform(-20.0, 150.0))
            asked: Row = {"drive": index, "free_d_current": free}
            solved.append(asked | points.solve(drive, speed, warm, how))
            strongest = min(
                drive.motor.max_torque_nm, drive.motor.max_power_w / abs(speed * math.pi / 30.0)
            )
            record = points.evaluate(
                drive, speed, float(rng.uniform(-1.0, 1.0)) * strongest, warm, how
            )
            record["inside_limits"] = not {"phase_current", "phase_voltage"} & set(
                record.pop("limits_exceeded")
            )
            evaluated.append(asked | record)
    return solved, evaluated


def table(kind: str, name: str, rows: list[Row]) -> Iterable[str]:
    """Yield a structure and an array of it."""
    yield f"struct {kind} {{"
    yield from (f"    {TYPES[type(value)]}{key};" for key, value in rows[0].items())
    yield "};"
    yield f"inline const {kind} {name}[] = {{"
    yield from (f"    {{{', '.join(map(literal, row.values()))}}}," for row in rows)
    yield "};"


def literal(value: float | bool | str | None) -> str:
    """Return a value as C++ writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if value is None or math.isnan(value):
        return "NAN"
    return "INFINITY" if math.isinf(value) else repr(value)


def text() -> str:
    """Compute everything; return the header."""
    shipped = [schema.load(path) for path in sorted((ROOT / "tools" / "motors").glob("*.toml"))]
    random = plausible.drives()
    solved, evaluated = answers(random)
    lines = [
        "// Drives, and what regen_table says about them.",
        "#pragma once",
        "#include <cmath>",
        "",
        "namespace values {",
        "",
    ]
    rows = [drive_row(drive) for drive in [*shipped, *random]]
    lines += [
        *table("Drive", "DRIVES", rows),
        f"constexpr int SHIPPED = {len(shipped)}; // the random ones follow",
        "",
    ]
    lines += [
        *table("Solved", "SOLVED", solved),
        "",
        *table("Evaluated", "EVALUATED", evaluated),
        "",
        "} // namespace values",
        "",
    ]
    return "\n".join(lines)


def state_of_sources() -> str:
    """Return a hash of all that the header depends on."""
    here = Path(__file__).resolve().parent
    found = [here / "optimum_values.py", here / "plausible.py"]
    for folder, pattern in (
        ("tools/regen_table", "*.py"),
        ("tools/motors", "*.toml"),
        ("firmware/config/include", "**/*.h"),
    ):
        found += sorted((ROOT / folder).glob(pattern))
    state = hashlib.sha256(f"{sys.version} {np.__version__}".encode())
    for path in found:
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        state.update(f"{path.relative_to(ROOT)} {content}\n".encode())
    return state.hexdigest()


def shared_text(folder: Path) -> str:
    """Return the header that another build computed from the same sources, or compute it there.

    A build that comes while another computes waits for it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    header, stamp = folder / "optimum_values.hpp", folder / "optimum_values.sha256"
    with (folder / "optimum_values.lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        state = state_of_sources()
        if header.is_file() and stamp.is_file() and stamp.read_text(encoding="utf-8") == state:
            return header.read_text(encoding="utf-8")
        stamp.unlink(missing_ok=True)
        computed = text()
        header.write_text(computed, encoding="utf-8")
        if state_of_sources() == state:  # no source was edited meanwhile
            stamp.write_text(state, encoding="utf-8")
        return computed


def main() -> int:
    """Write the header; half of one is never seen."""
    out = Path(sys.argv[1])
    content = shared_text(Path(sys.argv[2])) if len(sys.argv) > 2 else text()
    new = out.with_suffix(".new")
    new.write_text(content, encoding="utf-8")
    new.replace(out)
    return 0


sys.exit(main())
