# SPDX-License-Identifier: Apache-2.0
"""A drive file is read correctly or refused with one helpful line."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from regen_table import derived, loops, schema, shortcomings
from regen_table.errors import ConfigurationError

MOTORS = Path(__file__).resolve().parents[4] / "tools" / "motors"
PAPER = MOTORS / "lu2013.toml"

Change = Callable[[dict[str, Any]], schema.Drive]


def refusal(change: Change, changes: dict[str, Any]) -> str:
    with pytest.raises(ConfigurationError) as caught:
        change(changes)
    lines = str(caught.value).splitlines()
    assert all(line.startswith("changed.toml: ") for line in lines)
    return lines[0].removeprefix("changed.toml: ")


@pytest.mark.parametrize("path", sorted(MOTORS.glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_vehicle_is_accepted_and_named_like_its_file(path: Path) -> None:
    assert schema.load(path).name == path.stem


def test_an_integer_is_accepted_for_a_real_key(change: Change) -> None:
    assert change({"motor.max_torque_nm": 40}).motor.max_torque_nm == 40.0


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            {"motor.polepairs": 23, "motor.pole_pairs": None},
            "motor.polepairs: unknown key, did you mean pole_pairs?",
        ),
        ({"moter": {"name": "x"}}, "moter: unknown section, did you mean motor?"),
        (
            {"pedals.accelerator_channels": 2, "pedals.highest": [0.95, 0.4, 0.95, 0.5]},
            (
                "pedals.released: channel 1 goes from 0.075 to 0.425, accepted: at least 0.1001"
                " apart and between lowest = 0.03 and highest = 0.4"
            ),
        ),
        (
            {"pedals.brake_torque_nm": 30.0, "pedals.free_travel_torque_nm": 30.5},
            "pedals.free_travel_torque_nm: 30.5 N m, accepted: at most brake_torque_nm = 30 N m",
        ),
        ({"x": 3}, "x: unknown key, accepted: motor, inverter"),
        (
            {"motor.pole_pairs": None},
            "motor.pole_pairs: missing, accepted: a whole number from 1 to 60",
        ),
        ({"motor": 3}, "motor: must be a section, found 3"),
        (
            {"motor.pole_pairs": 2.5},
            "motor.pole_pairs: 2.5 is not accepted, accepted: a whole number from 1 to 60",
        ),
        ({"motor.pole_pairs": True}, "motor.pole_pairs: True is not accepted"),
        (
            {"motor.pole_pairs": 61},
            "motor.pole_pairs: 61 is not accepted, accepted: a whole number from 1 to 60",
        ),
        (
            {"motor.phase_resistance_ohm": -0.03},
            (
                "motor.phase_resistance_ohm: -0.03 is not accepted, accepted: a number from 1e-05"
                " to 100 ohm"
            ),
        ),
        (
            {"motor.d_inductance_h": 0.0},
            "motor.d_inductance_h: 0.0 is not accepted, accepted: a number from 1e-07 to 1 H",
        ),
        (
            {"motor.flux_linkage_wb": math.nan},
            "motor.flux_linkage_wb: nan is not accepted, accepted: a number from 1e-06 to 2 Wb",
        ),
        ({"motor.max_power_w": math.inf}, "motor.max_power_w: inf is not accepted"),
        (
            {"motor.type": "bldc"},
            'motor.type: \'bldc\' is not accepted, accepted: "spmsm" or "ipmsm"',
        ),
        (
            {"motor.iron_loss_resistance_ohm": [1.5]},
            "motor.iron_loss_resistance_ohm: [1.5] is not accepted, accepted: a list of 2",
        ),
        (
            {"motor.iron_loss_resistance_ohm": [0.0, 0.0]},
            "motor.iron_loss_resistance_ohm: [0, 0] would short-circuit",
        ),
        (
            {"motor.type": "ipmsm", "motor.q_inductance_h": 1.3e-3},
            (
                "motor.q_inductance_h: 0.0013 H, accepted: 1.9e-05 to 0.001216 H, a quarter of to"
                " 16 times d_inductance_h = 7.6e-05 H"
            ),
        ),
        (
            {"motor.iron_loss_resistance_ohm": [0.0, 2.0]},
            # 2 ohm s times 640 r/min of 23 pole pairs; 2048 times 58.4 V over 75 A.
            (
                "motor.iron_loss_resistance_ohm: [0, 2] make 3083 ohm at max_speed_rpm = 640 r/min,"
                " accepted: 0.8386 to 1595 ohm there"
            ),
        ),
        (
            {"motor.iron_loss_resistance_ohm": [0.1, 0.0]},
            # 31.45 V over half of 75 A.
            (
                "motor.iron_loss_resistance_ohm: [0.1, 0] make 0.1 ohm at max_speed_rpm = 640"
                " r/min, accepted: 0.8386 to 1595 ohm there"
            ),
        ),
        (
            {"motor.friction_torque_nm": 19.0},
            # 1.5 23 20.4 mWb 31.45 V / (1.5 + 9.249) ohm of iron loss.
            (
                "motor.friction_torque_nm: friction of 19 N m and iron loss of 2.059 N m at"
                " max_speed_rpm = 640 r/min, accepted: together at most 20 N m"
            ),
        ),
        (
            {"motor.flux_linkage_wb": 1e-3, "motor.rated_torque_nm": 1.0},
            # 58.4 V / 32.
            (
                "motor.flux_linkage_wb: 0.001 Wb, accepted: at least 0.00118393 Wb: the back-EMF at"
                " max_speed_rpm = 640 r/min is 1.541 V with hot magnets"
            ),
        ),
        (
            {"inverter.pwm_frequency_hz": "20000"},
            "inverter.pwm_frequency_hz: '20000' is not accepted",
        ),
        (
            {"battery.open_circuit_voltage_v": [[0.0, 53.0]]},
            "battery.open_circuit_voltage_v: one point",
        ),
        (
            {"battery.open_circuit_voltage_v": [[0.5, 53.0], [0.2, 54.0]]},
            "battery.open_circuit_voltage_v: accepted: soc rising",
        ),
        (
            {"battery.open_circuit_voltage_v": 90.0},
            "battery.open_circuit_voltage_v: 90 V, accepted: from min_voltage_v = 40 V",
        ),
        (
            {"battery.min_voltage_v": 58.4},
            "battery.min_voltage_v: 58.4 V, accepted: less than max_voltage_v",
        ),
        (
            {"vehicle.can_base": 0x748},
            "vehicle.can_base: 1864 is not accepted, accepted: a whole number from 0 to 1856",
        ),
        ({"vehicle.can_base": 0x110}, "vehicle.can_base: 272, accepted: a multiple of 32"),
        (
            {"table.temperature_range_c": [140.0, -20.0]},
            "table.temperature_range_c: [140, -20], accepted: [lowest, highest]",
        ),
        (
            {"control.handover_end_rpm": 30.0},
            "control.handover_end_rpm: 30 r/min, accepted: less than handover_start_rpm = 25",
        ),
        (
            {"control.field_weakening_current_a": 80.0},
            "control.field_weakening_current_a: 80 A, accepted: at most motor.max_phase",
        ),
        (
            {"battery.charge_foldback_voltage_v": 58.4},
            (
                "battery.charge_foldback_voltage_v: 58.4 V, accepted: more than min_voltage_v = 40"
                " V and less than max_voltage_v = 58.4 V"
            ),
        ),
        (
            {"battery.discharge_foldback_voltage_v": 40.0},
            "battery.discharge_foldback_voltage_v: 40 V, accepted: more than min_voltage_v = 40 V",
        ),
        (
            {"motor.derate_winding_temperature_c": 150.0},
            (
                "motor.derate_winding_temperature_c: 150 degC, accepted: less than"
                " max_winding_temperature_c = 150"
            ),
        ),
        (
            {"inverter.derate_switch_temperature_c": 150.0},
            (
                "inverter.derate_switch_temperature_c: 150 degC, accepted: less than"
                " max_switch_temperature_c = 150"
            ),
        ),
        (
            {
                "inverter.derate_switch_temperature_c": 100.0,
                "inverter.max_switch_temperature_c": None,
            },
            "inverter.max_switch_temperature_c: missing, accepted with derate_switch_temperature_c",
        ),
        (
            {"brake.stop_lamp_off_m_per_s2": 1.4},
            (
                "brake.stop_lamp_off_m_per_s2: 1.4 m/s2, accepted: at most stop_lamp_on_m_per_s2 ="
                " 1.3 m/s2"
            ),
        ),
        (
            {"monitor.overvoltage_v": 58.4},
            (
                "monitor.overvoltage_v: 58.4 V, accepted: more than battery.max_voltage_v = 58.4 V,"
                " at most 61.74 V of inverter.voltage_full_scale_v = 61.8 V"
            ),
        ),
        (
            {"inverter.device_voltage_v": 60.0},
            (
                "inverter.device_voltage_v: 60 V, accepted: at least 60.56 V, where the"
                " over-voltage trip lies"
            ),
        ),
        (
            {"inverter.current_offset_codes": [2048, 1847.9, 2248]},
            (
                "inverter.current_offset_codes: 1847.9, accepted: 1848 to 2248, within"
                " monitor.offset_tolerance_codes of the middle"
            ),
        ),
        (
            {"inverter.bus_capacitance_f": 1.5},
            "inverter.bus_capacitance_f: 1.5 is not accepted, accepted: a number from 0 to 1 F",
        ),
        (
            {"control.coast_delay_s": -0.1},
            "control.coast_delay_s: -0.1 is not accepted, accepted: a number from 0 to 60 s",
        ),
        (
            {"monitor.undervoltage_v": 40.0},
            "monitor.undervoltage_v: 40 V, accepted: less than battery.min_voltage_v = 40 V",
        ),
        (
            {"monitor.tyre_grip_m_per_s2": 1.5, "monitor.coasting_m_per_s2": 1.6},
            "monitor.coasting_m_per_s2: 1.6 m/s2, accepted: at most tyre_grip_m_per_s2 = 1.5 m/s2",
        ),
        (
            {"brake.abs_hold_s": 11.0},
            "brake.abs_hold_s: 11.0 is not accepted, accepted: a number from 0 to 10 s",
        ),
        (
            {"control.torque_growth_voltage_use": [0.96, 0.89]},
            (
                "control.torque_growth_voltage_use: [0.96, 0.89], accepted: [whole rate, none], at"
                " least 0.01 apart"
            ),
        ),
        (
            {"control.torque_growth_voltage_use": [0.8, 0.93]},
            "control.torque_growth_voltage_use: no growth from 0.93 on, accepted: "
            "beyond the square 0.9387",
        ),
        (
            {"rotor.hall_edges_deg": [0.0, 60.0, 120.0, 240.0, 180.0, 300.0]},
            "rotor.hall_edges_deg: accepted: six edges",
        ),
    ],
)
def test_an_error_names_the_key_and_the_accepted_range(
    change: Change, changes: dict[str, Any], expected: str
) -> None:
    assert refusal(change, changes).startswith(expected)


def test_surface_magnets_need_equal_inductances_and_interior_ones_do_not(change: Change) -> None:
    assert refusal(change, {"motor.q_inductance_h": 90e-6}).startswith(
        "motor.q_inductance_h: 9e-05 H, accepted: equal to d_inductance_h"
    )
    assert (
        change({"motor.q_inductance_h": 90e-6, "motor.type": "ipmsm"}).motor.q_inductance_h == 90e-6
    )


def test_a_rated_torque_beyond_the_current_limit_is_refused(change: Change) -> None:
    # 1.5 * 23 * 0.0204 Wb * 75 A = 52.8 N m
    assert "at most 52.79 N m" in refusal(
        change, {"motor.rated_torque_nm": 53.0, "motor.max_torque_nm": 60.0}
    )
    assert (
        change({"motor.rated_torque_nm": 52.7, "motor.max_torque_nm": 60.0}).motor.rated_torque_nm
        == 52.7
    )


def test_the_largest_torque_includes_reluctance_torque(change: Change) -> None:
    drive = change({"motor.q_inductance_h": 300e-6, "motor.type": "ipmsm"})
    angles = [math.radians(0.01 * step) for step in range(0, 18000)]
    flux, saliency = drive.motor.flux_linkage_wb, 300e-6 - 76e-6
    best = max(
        1.5 * 23 * (flux + saliency * 75.0 * math.sin(a)) * 75.0 * math.cos(a) for a in angles
    )
    assert derived.largest_torque_nm(drive, 75.0) == pytest.approx(best, rel=1e-6)


def test_back_emf_above_the_bridge_rating_is_refused_without_field_weakening(
    change: Change,
) -> None:
    # Line to line peak: sqrt(3) * 0.0204 Wb * 23 * 2 pi / 60 * n. The bus limit of 60.56 V is met
    # at 711.7 r/min.
    assert change({"motor.max_speed_rpm": 711.0}).motor.max_speed_rpm == 711.0
    line = refusal(
        change, {"motor.max_speed_rpm": 713.0, "control.field_weakening_current_a": None}
    )
    assert "at most the bus limit of 60.56 V (711.7 r/min)" in line
    # Line to line 64.3 V at 755 r/min come down to the lowest bus voltage, 40 V, with (0.0204 - 40
    # / 3150) / 76 uH.
    expected = (0.0204 - 40.0 / (math.sqrt(3.0) * 23.0 * 2.0 * math.pi / 60.0 * 755.0)) / 76e-6
    drive = {
        "motor.max_speed_rpm": 755.0,
        "control.field_weakening_current_a": 75.0,
        "inverter.voltage_full_scale_v": 62.0,
    }
    assert f"which takes {expected:.4g} A" in refusal(change, drive)


def test_a_drive_that_cannot_return_energy_is_refused(change: Change) -> None:
    # c1 = 3 (k_on + k_off) f / pi + dead-time diodes, 2/3 of it against psi * omega_max = 31.4 V
    assert "no regeneration at any speed" in refusal(
        change, {"inverter.turn_on_loss_j_per_a": 0.0025}
    )
    assert change({"inverter.turn_on_loss_j_per_a": 0.0024}).inverter.turn_on_loss_j_per_a == 0.0024


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b'[motor]\nname = "cut', "not valid TOML: "),
        (b"[motor]\nname = '\xff\xfe'", "not UTF-8 text (byte 16)"),
        (bytes(range(256)) * 64, "not UTF-8 text (byte 128)"),
        (PAPER.read_bytes().partition(b"_torque_nm = ")[0], "not valid TOML: "),
        (PAPER.read_bytes().partition(b"[battery]")[0], "battery.open_circuit_voltage_v: missing"),
        (b"#" * (1 << 20) + b"\n", "larger than 1048576 bytes"),
        (b"", "motor.pole_pairs: missing"),
        (b"x = " + b"[" * 5000, "not valid TOML: "),
    ],
    ids=[
        "ends early",
        "not text",
        "binary",
        "cut in a line",
        "cut between sections",
        "too large",
        "empty",
        "nested",
    ],
)
def test_an_invalid_file_is_refused_with_its_name(
    tmp_path: Path, content: bytes, expected: str
) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(ConfigurationError) as caught:
        schema.load(path)
    assert str(caught.value).startswith(f"{path}: {expected}")
    assert all(line.startswith(f"{path}: ") for line in str(caught.value).splitlines())


def test_an_oversized_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.toml"
    with path.open("wb") as file:
        file.truncate(200 * 1024 * 1024)
    with pytest.raises(ConfigurationError, match="larger than"):
        schema.load(path)


def test_a_missing_file_or_a_directory_is_an_error_that_names_it(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"nowhere\.toml: file not found"):
        schema.load(tmp_path / "nowhere.toml")
    with pytest.raises(ConfigurationError) as caught:
        schema.load(tmp_path)
    assert str(caught.value) == f"{tmp_path}: is a directory, a TOML file is needed"


def test_a_name_that_is_not_a_c_identifier_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "my motor.toml"
    path.write_bytes(PAPER.read_bytes())
    with pytest.raises(ConfigurationError, match="must be a letter followed by"):
        schema.load(path)


def test_a_drive_that_cannot_reach_its_rated_data_gives_a_warning(change: Change) -> None:
    assert [
        line.partition(":")[0]
        for line in shortcomings.warnings(change({"motor.max_speed_rpm": 600.0}))
    ] == []
    assert [
        line.partition(":")[0]
        for line in shortcomings.warnings(change({"motor.max_torque_nm": 53.0}))
    ] == [
        "motor.max_torque_nm",
        "motor.max_speed_rpm",
    ]


def test_absent_keys_of_the_bus_give_a_warning_each(change: Change) -> None:
    named = [
        line.partition(":")[0]
        for line in shortcomings.warnings(
            change(
                {
                    "motor.max_speed_rpm": 600.0,
                    "inverter.device_voltage_v": None,
                    "inverter.bus_capacitance_f": None,
                }
            )
        )
    ]
    assert named == ["inverter.device_voltage_v", "inverter.bus_capacitance_f"]


def test_a_rest_voltage_inside_the_fold_back_gives_a_warning_with_both_voltages(
    change: Change,
) -> None:
    assert (
        shortcomings.warnings(change({"motor.max_speed_rpm": 600.0, "battery.max_voltage_v": 54.1}))
        == []
    )
    (constant,) = shortcomings.warnings(
        change(
            {
                "motor.max_speed_rpm": 600.0,
                "battery.max_voltage_v": 54.0,
            }
        )
    )
    assert constant.startswith("battery.open_circuit_voltage_v: the pack rests at 53 V")
    assert "52.92 V to max_voltage_v = 54 V" in constant
    curve = {
        "motor.max_speed_rpm": 500.0,
        "battery.open_circuit_voltage_v": [[0.0, 48.0], [1.0, 58.0]],
    }
    assert shortcomings.warnings(change(curve | {"battery.initial_soc": 0.9})) == []
    (absent,) = shortcomings.warnings(change(curve | {"battery.initial_soc": None}))
    assert absent.startswith("battery.initial_soc: absent, work begins at 0.7")
    (full,) = shortcomings.warnings(change(curve | {"battery.initial_soc": 0.95}))
    assert full.startswith("battery.initial_soc: the pack rests at 57.5 V")
    assert "57.23 V to max_voltage_v = 58.4 V" in full


@pytest.mark.parametrize(("soc", "rest"), [(0.0, "38 V"), (1.0, "60 V")])
def test_an_initial_charge_outside_the_pack_voltages_is_refused(
    change: Change, soc: float, rest: str
) -> None:
    with pytest.raises(
        ConfigurationError, match=rf"battery\.initial_soc: {soc:g}, where the pack rests at {rest}"
    ):
        change(
            {
                "battery.open_circuit_voltage_v": [[0.0, 38.0], [0.5, 53.0], [1.0, 60.0]],
                "battery.initial_soc": soc,
            }
        )


def test_a_top_speed_beyond_field_weakening_at_min_voltage_gives_a_warning(
    change: Change,
) -> None:
    """Remaining back-EMF against the largest bridge voltage at the minimum bus voltage."""
    line = loops.weakening_warning(change({}))
    assert line is not None
    emf = math.sqrt(3.0) * 0.0204 * 23 * 640.0 * math.pi / 30.0
    left = emf - math.sqrt(3.0) * 76e-6 * 70.0 * 23 * 640.0 * math.pi / 30.0
    made = loops.modulation_limit(change({})) * 40.0
    for number in (
        f"{left:.4g} V of back-EMF",
        f"the {made:.4g} V",
        "min_voltage_v = 40 V",
        "75 A",
    ):
        assert number in line
    needed = float(re.findall(r"([\d.]+) A would", line)[-1])
    assert needed == pytest.approx(0.0204 / 76e-6 * (1.0 - made / emf), rel=1e-3)
    speed = float(re.findall(r"beyond ([\d.]+) r/min", line)[0])
    for factor, warned in ((0.99, False), (1.03, True)):
        warning = loops.weakening_warning(change({"motor.max_speed_rpm": factor * speed}))
        assert (warning is not None) is warned
    enough = {"motor.max_phase_current_a": 100.0, "control.field_weakening_current_a": needed}
    assert loops.weakening_warning(change(enough)) is None
    assert "0 A leave 54.47 V" in str(
        loops.weakening_warning(change({"control.field_weakening_current_a": None}))
    )


def test_switches_without_a_temperature_limit_give_a_warning(change: Change) -> None:
    found = shortcomings.warnings(
        change({"motor.max_speed_rpm": 600.0, "inverter.max_switch_temperature_c": None})
    )
    assert [line.partition(":")[0] for line in found] == ["inverter.max_switch_temperature_c"]


def test_every_shipped_drive_has_all_limits_on_and_no_full_pack_at_the_start() -> None:
    for path in sorted(PAPER.parent.glob("*.toml")):
        named = {line.partition(":")[0] for line in shortcomings.warnings(schema.load(path))}
        assert named <= {"motor.max_speed_rpm"}
