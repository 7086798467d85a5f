# SPDX-License-Identifier: Apache-2.0
"""A file with the numbers that people have is a drive; what was assumed is reported."""

import dataclasses
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from regen_table import boards, envelope, filling, generate, image, schema
from regen_table import refusals as refusals_module
from regen_table.errors import ConfigurationError

ROOT = Path(__file__).resolve().parents[4]
SHORT = """
motor.pole_pairs = 15
motor.phase_resistance_ohm = 0.18
motor.d_inductance_h = 336e-6
motor.flux_linkage_wb = 0.02297
motor.rated_torque_nm = 6.0
motor.mass_kg = 2.3
inverter.board = "vesc6_mk3"
battery.cells = 10
vehicle.mass_kg = 100.0
vehicle.wheel_radius_m = 0.0825
"""
NEEDED = {
    *("motor.pole_pairs", "motor.phase_resistance_ohm", "motor.d_inductance_h"),
    *("motor.flux_linkage_wb", "vehicle.mass_kg", "vehicle.wheel_radius_m"),
}
DRIVES = sorted((ROOT / "tools" / "motors").rglob("*.toml"))


def short(changes: dict[str, Any] | None = None) -> schema.Drive:
    """Return the short file's drive with other keys; None takes one away."""
    tree = tomllib.loads(SHORT)
    for key, value in (changes or {}).items():
        section, name = key.split(".")
        tree.setdefault(section, {})[name] = value
        if value is None:
            del tree[section][name]
    return schema.parse(tree, "short", "short.toml")


def refusals(changes: dict[str, Any]) -> dict[str, str]:
    """Return the lines of the refusal by their keys."""
    with pytest.raises(ConfigurationError) as caught:
        short(changes)
    lines = [line.removeprefix("short.toml: ") for line in str(caught.value).splitlines()]
    return {line.partition(":")[0]: line for line in lines}


def assumed(drive: schema.Drive) -> dict[str, Any]:
    return {found.key: found.value for found in filling.assumptions(drive)}


def test_ten_keys_make_an_image_and_everything_else_is_reported_as_assumed() -> None:
    drive = short()
    assert len(image.build(drive)) > 0
    required = {key for key, info in filling.declared().items() if info.is_required()}
    given = {f"{section}.{key}" for section, keys in tomllib.loads(SHORT).items() for key in keys}
    assert required - given <= set(assumed(drive))
    assert not given & set(assumed(drive))


def test_six_keys_alone_have_no_rule() -> None:
    required = {key for key, info in filling.declared().items() if info.is_required()}
    assert required - set(filling.rules()) == NEEDED


def test_every_rule_says_how_and_what_it_costs() -> None:
    for key, info in filling.rules().items():
        rule = filling.rule_of(info)
        assert rule is not None
        assert len(rule.how) > 2, key
        assert len(rule.cost) > 2, key


@pytest.mark.parametrize("path", DRIVES, ids=lambda path: path.stem)
def test_nothing_is_assumed_of_a_whole_file(path: Path) -> None:
    assert assumed(schema.load(path)) == {}


def test_a_given_key_counts_and_others_follow_it() -> None:
    """Twice the cells: twice the voltages, four times the no-load power, the same torque."""
    one, two = (
        assumed(short({"inverter.board": None})),
        assumed(short({"inverter.board": None, "battery.cells": 20})),
    )
    for key in ("battery.max_voltage_v", "battery.min_voltage_v", "motor.max_speed_rpm"):
        assert two[key] == pytest.approx(2.0 * one[key])
    assert two["motor.max_torque_nm"] == one["motor.max_torque_nm"]
    drive = short({"motor.max_torque_nm": 9.0})
    assert drive.control.torque_rate_nm_per_s == pytest.approx(9.0 / 0.2)
    assert "motor.max_torque_nm" not in assumed(drive)


def test_a_drive_that_is_written_out_and_read_again_is_assumed_anew() -> None:
    data = short().model_dump(exclude_none=True, exclude_unset=True)
    assert schema.parse(data, "short", "again") == short()
    data["battery"]["cells"] = 12
    assert schema.parse(data, "short", "again").battery.max_voltage_v == pytest.approx(50.4)


def test_the_largest_current_makes_the_largest_torque_within_the_board() -> None:
    """T = 1.5 p psi i_q: 15 N m take 29 A; 200 N m would take 387 A, and the board carries 160."""
    drive = short()
    per_ampere = 1.5 * 15 * 0.02297
    assert drive.motor.max_phase_current_a == pytest.approx(2.5 * 6.0 / per_ampere)
    strong = short({"motor.rated_torque_nm": 60.0})
    assert strong.motor.max_phase_current_a < 160.0
    torque = per_ampere * strong.motor.max_phase_current_a
    assert strong.motor.max_torque_nm == pytest.approx(torque)


def test_rated_torque_for_ever_ends_at_the_hottest_winding() -> None:
    """Copper at 120 degC has 1 + 0.00393 * 95 times the resistance; air of 40 degC."""
    drive = short()
    current = 6.0 / (1.5 * 15 * 0.02297)
    loss = 1.5 * 0.18 * (1.0 + 0.00393 * 95.0) * current**2
    thermal = drive.thermal
    resistance = (
        thermal.winding_thermal_resistance_k_per_w + thermal.housing_thermal_resistance_k_per_w
    )
    assert 40.0 + loss * resistance == pytest.approx(120.0)
    assert short({"motor.mass_kg": None}).thermal == schema.Drive.model_fields["thermal"].default


def test_all_that_is_missing_is_named_at_once_with_what_it_could_be_assumed_from() -> None:
    taken = dict.fromkeys((*NEEDED, "motor.rated_torque_nm", "motor.mass_kg"))
    found = refusals(taken)
    assert set(found) == {*NEEDED, "motor.rated_torque_nm"}
    assert "motor.mass_kg" in found["motor.rated_torque_nm"]
    assert set(refusals({"battery.cells": None})) == {
        "battery.open_circuit_voltage_v",
        "battery.max_voltage_v",
        "battery.min_voltage_v",
    }


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("motor.flux_linkage_wb", "0.02"),
        ("motor.flux_linkage_wb", -0.02),
        ("battery.cells", 10.5),
        ("battery.cells", 0),
        ("motor.mass_kg", -1.0),
        ("vehicle.mass_kg", True),
    ],
)
def test_what_follows_from_a_wrong_key_is_no_mistake_of_its_own(key: str, value: object) -> None:
    assert set(refusals({key: value})) == {key}


def test_mistakes_of_every_kind_are_named_in_one_answer() -> None:
    """Missing, misspelt, of another kind, out of range, and a board that nobody knows."""
    changes = {
        **{
            "motor.d_inductance_h": None,
            "motor.flux_linkage_wb": None,
            "motor.flux_linkge_wb": 0.02,
        },
        **{"motor.phase_resistance_ohm": "0.1", "motor.pole_pairs": 0, "battery.cells": 10.5},
        **{"vehicle.mass_kg": -3.0, "inverter.board": "vesc6_mk"},
    }
    assert set(refusals(changes)) == set(changes) - {"motor.flux_linkage_wb"}


def test_a_refusal_says_of_each_key_in_it_that_was_assumed_from_what() -> None:
    torque = refusals({"motor.rated_torque_nm": 90.0})["motor.rated_torque_nm"]
    assert "at most max_torque_nm = 73" in torque
    assert "motor.max_torque_nm was assumed: 2.5 times rated_torque_nm" in torque
    assert "rated_torque_nm was assumed" not in torque
    fast = refusals({"motor.flux_linkage_wb": 1e-4})
    assert "motor.flux_linkage_wb" not in fast
    assert "was assumed: where the line-to-line EMF" in fast["motor.max_speed_rpm"]
    given = refusals({"control.current_bandwidth_hz": 3000.0})
    assert "assumed" not in given["control.current_bandwidth_hz"]


def test_a_bandwidth_that_was_not_given_fits_the_number_formats() -> None:
    """1 000 Hz, a twentieth of 20 kHz, is beyond them; 2 % above what is taken they end."""
    taken = short().control.current_bandwidth_hz
    assert taken < 1000.0
    assert set(refusals({"control.current_bandwidth_hz": 1.03 * taken})) == {
        "control.current_bandwidth_hz"
    }
    assert short({"motor.phase_resistance_ohm": 0.1}).control.current_bandwidth_hz == 1000.0


@pytest.mark.parametrize("width", [1e-3, 3e-3, 0.015, 0.03, 0.3])
def test_a_bandwidth_that_was_not_given_fits_however_narrow_the_range_is(
    width: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Above the range one quantity leaves its number format, below it another."""
    fastest = 432.1

    @dataclasses.dataclass(frozen=True)
    class Proof:
        quantity: str
        holds: bool

    def proofs(drive: schema.Drive) -> list[Proof]:
        bandwidth_hz = drive.control.current_bandwidth_hz
        return [
            Proof("gain", bandwidth_hz <= fastest),
            Proof("pole", bandwidth_hz >= (1.0 - width) * fastest),
        ]

    drive = short()
    faster = refusals_module.with_value(drive, "control.current_bandwidth_hz", 1000.0)
    monkeypatch.setattr(envelope, "proofs", proofs)
    taken = refusals_module.with_fitting_bandwidth(faster).control.current_bandwidth_hz
    assert (1.0 - width) * fastest <= taken <= fastest
    if width > 0.02:
        assert taken == pytest.approx(0.98 * fastest, rel=1e-3)


def test_a_board_is_known_and_only_its_own_scales_are_accepted() -> None:
    named = refusals({"inverter.board": "vesc6_mk"})
    assert named["inverter.board"].endswith("did you mean vesc6_mk6?")
    assert set(refusals({"inverter.current_full_scale_a": 180.0})) == {
        "inverter.current_full_scale_a"
    }
    short({"inverter.current_full_scale_a": 170.0})
    assert "stands" in refusals({"battery.cells": 15})["battery.max_voltage_v"]


@pytest.mark.parametrize("dead_time_s", [None, 1e-6])
def test_low_side_shunts_get_their_window_and_shunts_in_the_phases_none(
    dead_time_s: float | None,
) -> None:
    """Of a VESC 4: 0.3 us to settle, 15 cycles of 21 MHz to sample, and half the dead time."""
    given = {} if dead_time_s is None else {"inverter.dead_time_s": dead_time_s}
    low_side, in_phases = short({"inverter.board": "vesc4_10", **given}), short(given)
    window_s = 0.3e-6 + 15 / 21e6 + low_side.inverter.dead_time_s / 2.0
    assert low_side.inverter.min_pulse_s is not None
    assert window_s < low_side.inverter.min_pulse_s < window_s + 50e-9
    assert in_phases.inverter.min_pulse_s is None


@pytest.mark.parametrize("max_speed_rpm", [200.0, 40.0])
def test_a_vehicle_at_walking_speed_gets_a_table(max_speed_rpm: float) -> None:
    """6 and 1.2 km/h: in the cycles, scaled to it, no braking from where the motor does."""
    drive = short({"motor.max_speed_rpm": max_speed_rpm})
    report = generate.make_report(drive)
    assert max(loss.stored for loss in report.d_current_losses) < 2e-4


def test_a_dead_time_is_accepted_up_to_the_shortest_pulse_that_the_firmware_takes(
    validated: Callable[[bytes], str],
) -> None:
    """Two dead times on either side of the top, at most a tenth of 50 us."""
    longest = short({"inverter.dead_time_s": 2.5e-6})
    assert validated(image.build(longest)) == ""
    too_long = {"inverter.dead_time_s": 2.51e-6}
    assert "at most 2.5e-06 s" in refusals(too_long)["inverter.dead_time_s"]
    given = refusals({**too_long, "inverter.min_pulse_s": 5.1e-6})
    assert "at most 5e-06 s" in given["inverter.min_pulse_s"]


def test_a_window_in_which_low_side_shunts_are_not_sampled_is_refused() -> None:
    found = refusals({"inverter.board": "vesc4_10", "inverter.min_pulse_s": 1e-6})
    assert "vesc4_10 settle" in found["inverter.min_pulse_s"]
    short({"inverter.min_pulse_s": 1e-6})


def test_the_boards_that_fit_a_drive_are_named_with_what_the_others_would_cost() -> None:
    """Of the public drives: 84 V and 320 A; 403 V and 370 A. Over-currents trip 5 % above."""
    folder = Path(__file__).parents[4] / "tools" / "motors" / "public"
    named = {
        name: boards.fitting(schema.load(folder / f"{name}.toml"), 1.05, schema.refused_with)
        for name in ("qs273", "elaphe700", "mxus3k")
    }
    assert named["qs273"].startswith("boards that fit: mks84_200_hp, gate_board;")
    assert "vesc75_300 bears 72 of 84 V" in named["qs273"]
    assert named["elaphe700"].startswith("boards that fit: gate_board;")
    assert "vesc6_mk3" in named["mxus3k"].partition(";")[0]
    assert "b_g431b_esc1 bears 25 of 58.8 V" in named["mxus3k"]


def test_each_public_drive_has_a_board() -> None:
    folder = Path(__file__).parents[4] / "tools" / "motors" / "public"
    files = sorted(folder.glob("*.toml"))
    assert len(files) == 6
    for file in files:
        found = boards.fitting(schema.load(file), 1.05, schema.refused_with)
        assert "none" not in found.partition(";")[0]


@pytest.mark.parametrize("path", DRIVES, ids=lambda path: path.stem)
def test_a_board_is_said_to_fit_if_and_only_if_the_drive_is_accepted_with_it(path: Path) -> None:
    """With the board's own facts in place of the file's; the description's ranges are nobody's."""
    drive = schema.load(path)
    found = boards.fitting(drive, 1.05, schema.refused_with)
    fits = found.partition(";")[0].removeprefix("boards that fit: ").split(", ")
    of_bridge = ("current_full_scale_a", "voltage_full_scale_v", "pwm_timer_clock_hz")
    for board in boards.known().values():
        if board.name == boards.DESCRIPTION:
            continue
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
        for key in (*of_bridge, "dead_time_s", "min_pulse_s", "switch_resistance_ohm"):
            tree["inverter"].pop(key, None)
        tree["inverter"] |= {"board": board.name, "diode_resistance_ohm": 0.001}
        try:
            image.build(schema.parse(tree, path.stem, path.name))
        except ConfigurationError:
            assert board.name not in fits
        else:
            within = drive.motor.max_phase_current_a <= board.current_most_a / 1.05
            assert (board.name in fits) == within


def test_a_board_whose_ranges_are_too_large_is_named_with_the_keys_that_it_takes() -> None:
    """Of a small wheel, whose inductance times 516 A in 50 us is far beyond 91 V."""
    found = boards.fitting(schema.load("hoverboard"), 1.05, schema.refused_with)
    assert found.startswith("boards that fit: vesc4_10, vesc6_mk3, vesc6_mk6, gate_board;")
    assert "vesc75_300 takes other control.current_bandwidth_hz" in found
