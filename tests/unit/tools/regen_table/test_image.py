# SPDX-License-Identifier: Apache-2.0
"""The image contains the values of the TOML in the header's layout and ranges.

The C file and the binary are the same bytes.
"""

import math
import re
import subprocess
import zlib
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from regen_table import cli, generate, image, layout, loops, schema
from regen_table.errors import CheckFailedError, ConfigurationError

ROOT = Path(__file__).resolve().parents[4]
MOTORS = ROOT / "tools" / "motors"
GENERATED = ROOT / "firmware" / "config" / "generated"
PAPER = MOTORS / "lu2013.toml"
# Of those in public no files are stored.
STORED = sorted([*MOTORS.glob("*.toml"), *MOTORS.glob("bench/*.toml")])

Change = Callable[[dict[str, Any]], schema.Drive]
INCLUDE = ROOT / "firmware" / "config" / "include"


def unpack(raw: bytes) -> Any:  # noqa: ANN401, a cffi pointer
    return layout.load().ffi.from_buffer("config_t *", raw)


def test_every_field_of_the_header_is_parsed() -> None:
    headers = sorted(layout.HEADER.parent.glob("*.h"))
    text = "\n".join(header.read_text(encoding="utf-8") for header in headers)
    lines = re.findall(r"^    [XY]\((\w+),", text, flags=re.MULTILINE)
    found = [name for fields in layout.load().sections.values() for name in fields]
    assert sorted(found) == sorted(lines)


def test_the_layout_equals_that_of_the_compiler(tmp_path: Path) -> None:
    header = layout.load()
    checks = [f'_Static_assert(sizeof(config_t) == {header.size_bytes}, "");']
    for section, fields in header.sections.items():
        for name in fields:
            offset = header.ffi.offsetof("config_t", section, name)
            checks.append(
                f"_Static_assert(offsetof(config_t, {section}.{name}) == {offset},"
                f' "{section}.{name}");'
            )
    source = tmp_path / "layout.c"
    source.write_text(
        '#include <stddef.h>\n#include "config/config.h"\n' + "\n".join(checks) + "\n"
    )
    done = subprocess.run(
        ["cc", "-std=c11", "-fsyntax-only", "-I", str(INCLUDE), str(source)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_the_crc_of_the_image_is_that_checked_by_the_firmware(paper: schema.Drive) -> None:
    raw = image.build(paper)
    packed = unpack(raw)
    assert raw[:4] == b"HFOC"
    assert packed.size_bytes == len(raw)
    assert packed.crc32 == zlib.crc32(raw[: layout.load().ffi.offsetof("config_t", "crc32")])
    assert layout.load().ffi.string(packed.name) == b"lu2013"


def test_the_papers_data_are_converted_to_the_firmwares_units(paper: schema.Drive) -> None:
    packed = unpack(image.build(paper))
    assert packed.motor.pole_pairs == 23
    assert packed.motor.phase_resistance_uOhm == 31000
    assert packed.motor.q_inductance_nH == 76000
    assert packed.motor.flux_linkage_nWb == 20400000
    assert packed.motor.iron_loss_resistance_slope_nOhm_s == 6000000
    assert packed.battery.max_charge_current_mA == 50000  # a quarter of the pack's 200 A
    assert packed.brake.parallel_electric_share_q15 == 6554  # 1 : 4
    assert packed.brake.blend_out_start_mrad_s == 2618  # 25 r/min
    assert packed.drive.min_pulse_ns == 500


def test_the_per_unit_gains_equal_the_textbook_formulas(paper: schema.Drive) -> None:
    # Z = 165 A / 61.8 V, omega_c = 2 pi 1000, omega_base = 2 pi 20000 / 16, T = 50 us: 1 + 2
    # omega_c T = 1.6283185.
    loop = unpack(image.build(paper)).current_loop
    # a = exp(-6283.1853 * 50 us) = 0.7304, a (1 - a) = 0.19691; winding and switch have 34.3 mOhm,
    # exp(-R T / L) = 0.97769
    assert loop.integral_q_pu_q24 / 2**24 == pytest.approx(
        0.19691452 * 0.0343 * 165 / 61.8, rel=1e-5
    )
    assert loop.proportional_d_pu_q16 / 65536 == pytest.approx(
        0.19691452 * 0.0343 / 0.02231294 * 165 / 61.8, rel=1e-5
    )
    assert loop.inductance_d_pu_q16 / 65536 == pytest.approx(
        7853.9816 * 76e-6 * 165 / 61.8, rel=1e-5
    )
    assert loop.flux_pu_q16 / 65536 == pytest.approx(7853.9816 * 0.0204 / 61.8, rel=1e-5)


def test_dead_time_zone_is_the_current_that_decays_within_the_dead_time(change: Change) -> None:
    def zone_a(changes: dict[str, Any]) -> float:
        return (
            float(unpack(image.build(change(changes))).current_loop.dead_time_zone_pu_q15)
            / 32768.0
            * 165.0
        )

    # 1 us of 49.2 V, the middle of 40.0 to 58.4 V, and of twice 0.8 V on 76 uH; then on 70 uH, the
    # smaller one
    assert zone_a({}) == pytest.approx(0.668, abs=0.003)
    assert zone_a({"inverter.diode_forward_voltage_v": 0.0}) == pytest.approx(0.647, abs=0.003)
    assert zone_a({"motor.d_inductance_h": 70e-6, "motor.type": "ipmsm"}) == pytest.approx(
        0.726, abs=0.003
    )
    assert zone_a({"inverter.dead_time_s": 0.0}) == pytest.approx(128.0 / 32768.0 * 165.0)
    assert zone_a({"control.dead_time_zone_a": 2.0}) == pytest.approx(2.0, abs=0.003)


@pytest.mark.parametrize("path", sorted(MOTORS.glob("*.toml")), ids=lambda path: path.stem)
def test_modulation_limit_includes_the_dead_time_correction(path: Path) -> None:
    # dead_time_init() from the image's integers: t_d f (1 + 2 V_f / ((v_min + v_max) / 2)) of the
    # period, to the nearest count.
    drive = schema.load(path)
    packed = unpack(image.build(drive))
    share = Fraction(packed.drive.dead_time_ns * packed.drive.pwm_frequency_Hz, 10**9)
    drops = Fraction(
        4 * packed.drive.diode_drop_mV,
        packed.battery.min_voltage_mV + packed.battery.max_voltage_mV,
    )
    assert drops > 0
    assert math.floor(
        share * (1 + drops) * loops.pwm_period_counts(drive) + Fraction(1, 2)
    ) == loops.dead_time_counts(drive)


@pytest.mark.parametrize("path", sorted(MOTORS.glob("*.toml")), ids=lambda path: path.stem)
def test_the_modulation_limit_keeps_the_minimum_pulse_and_two_sampled_legs(path: Path) -> None:
    # Min/max injection by its definition at every angle, with the dead-time trim of unfavourable
    # sign in every leg.
    drive = schema.load(path)
    packed = unpack(image.build(drive))
    period = drive.inverter.pwm_timer_clock_hz / drive.inverter.pwm_frequency_hz / 2
    pulse = packed.drive.min_pulse_ns * 1e-9 * drive.inverter.pwm_timer_clock_hz
    modulation = packed.current_loop.modulation_limit_pu_q15 / 32768
    middle_v = (drive.battery.min_voltage_v + drive.battery.max_voltage_v) / 2.0
    lost_v = middle_v + 2.0 * drive.inverter.diode_forward_voltage_v
    trim = drive.inverter.dead_time_s * drive.inverter.pwm_frequency_hz * lost_v / middle_v * period
    angle = np.linspace(0.0, 2.0 * np.pi, 3601)
    phases = (
        modulation / np.sqrt(3.0) * np.cos(angle - np.array([[0.0], [2.0], [4.0]]) * np.pi / 3.0)
    )  # of v_dc
    centred = phases - (phases.max(axis=0) + phases.min(axis=0)) / 2.0
    compare = np.sort(period * (0.5 + centred) + trim, axis=0)
    assert compare[2].max() <= period - pulse
    # The leg with the longest high side is calculated from the other two: the second one must
    # permit its sample.
    window = (drive.inverter.dead_time_s + 0.5e-6) * drive.inverter.pwm_timer_clock_hz
    assert compare[1].max() <= period - window
    tight = [
        compare[2].max() >= period - pulse - 4,
        compare[1].max() >= period - window - 4,
        modulation > 0.979,
    ]
    assert any(tight)  # and is not smaller than necessary


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        (
            {"motor.max_phase_current_a": 155.0},
            "motor.max_phase_current_a: 155 A, accepted: at most 141.7 A",
        ),
        (
            {"monitor.overcurrent_a": 149.0},
            "monitor.overcurrent_a: 149 A, accepted: at most 148.8 A",
        ),
        (
            {"monitor.overcurrent_a": 77.0},
            "monitor.overcurrent_a: 77 A, accepted: at least 78.75 A, 5 % above",
        ),
        (
            {"control.current_bandwidth_hz": 2000.0},
            "control.current_bandwidth_hz: 2000 Hz, accepted: at most 1591 Hz",
        ),
        (
            {"inverter.voltage_full_scale_v": 59.0},
            "inverter.voltage_full_scale_v: 59 V, accepted: more than 59.59 V",
        ),
        # A tenth of the period of 20 kHz, as validate.c has it.
        ({"inverter.min_pulse_s": 1e-5}, "inverter.min_pulse_s: 1e-05 s, accepted: at most 5e-06"),
        (
            {"control.dead_time_zone_a": 0.1},
            "control.dead_time_zone_a: 0.1 A, accepted: at least 0.6446 A",  # 165 A / 256
        ),
        (
            {"inverter.pwm_timer_clock_hz": 1_000_000},
            # Half a million over 16 384 and over 256.
            "inverter.pwm_frequency_hz: 20000 Hz, accepted: 31 to 1953 Hz from a timer of 1e+06",
        ),
        (
            {"vehicle.driven_wheels": 16, "battery.max_discharge_current_a": 1.0},
            "battery.max_discharge_current_a: 1 A for 16 driven wheels, accepted: at least 1.6 A",
        ),
    ],
)
def test_values_outside_the_number_formats_are_refused_with_their_name(
    change: Change, changes: dict[str, Any], expected: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        image.build(change(changes))
    assert str(caught.value).removeprefix("changed.toml: ").startswith(expected)


# Optional keys of the paper's vehicle: what the field holds without the key, a value, what it holds
# then.
OPTIONAL_KEYS = [
    ("motor.speed_fade_share", "motor.speed_fade_share_q15", 1024, 0.25, 8192),
    (
        "motor.derate_winding_temperature_c",
        "motor.derate_winding_temperature_cC",
        13000,
        120.0,
        12000,
    ),
    (
        "inverter.derate_switch_temperature_c",
        "drive.derate_switch_temperature_cC",
        13000,
        90.5,
        9050,
    ),
    ("control.coast_delay_s", "modes.coast_delay_ms", 100, 0.0, 0),
    ("control.offset_wait_s", "modes.offset_wait_ms", 100, 0.5, 500),
    ("monitor.battery_message_time_s", "monitor.battery_message_time_ms", 300, 0.15, 150),
    ("inverter.current_offset_codes", "drive.offset_a_q4", 32768, [2050.5, 2040, 2060], 32808),
    ("inverter.current_offset_codes", "drive.offset_b_q4", 32768, [2050.5, 2040, 2060], 32640),
    ("inverter.current_offset_codes", "drive.offset_c_q4", 32768, [2050.5, 2040, 2060], 32960),
    ("inverter.device_voltage_v", "drive.device_voltage_mV", 75000, 80.0, 80000),
    ("inverter.device_voltage_v", "drive.device_voltage_mV", 75000, None, 60564),
    ("inverter.bus_capacitance_f", "drive.bus_capacitance_nF", 2460000, 4.7e-4, 470000),
    ("inverter.bus_capacitance_f", "drive.bus_capacitance_nF", 2460000, None, 0),
    ("battery.charge_foldback_voltage_v", "battery.foldback_voltage_mV", 57232, 56.0, 56000),
    (
        "battery.discharge_foldback_voltage_v",
        "battery.discharge_foldback_voltage_mV",
        41168,
        45.0,
        45000,
    ),
    # as far above 40 V as charge's fold-back begins below 58.4 V
    (
        "battery.charge_foldback_voltage_v",
        "battery.discharge_foldback_voltage_mV",
        41168,
        56.0,
        42400,
    ),
    ("brake.hydraulic_timeout_s", "brake.hydraulic_timeout_ms", 70, 0.0, 0),
    ("brake.hydraulic_report_delay_s", "brake.hydraulic_report_delay_ms", 10, 0.04, 40),
    ("brake.hydraulic_gain_band", "brake.hydraulic_gain_band_q15", 6554, 0.5, 16384),
    ("brake.hydraulic_tolerance_nm", "brake.hydraulic_tolerance_mNm", 3750, 7.5, 7500),
    ("brake.bridging_time_s", "brake.bridging_time_ms", 178, 0.0, 0),
    ("brake.loss_braking", "brake.loss_braking", 1, False, 0),
    ("brake.shortfall_band_nm", "brake.shortfall_band_mNm", 2000, 3.5, 3500),
    ("brake.motor_arrival_s", "brake.motor_arrival_ms", 100, 0.25, 250),
    ("brake.abs_hold_s", "brake.abs_hold_ms", 300, 0.1, 100),
    ("brake.stop_lamp_on_m_per_s2", "brake.stop_lamp_on_mm_s2", 1300, 1.5, 1500),
    ("brake.stop_lamp_off_m_per_s2", "brake.stop_lamp_off_mm_s2", 700, 0.5, 500),
    ("brake.stop_lamp_filter_s", "brake.stop_lamp_filter_log2", 6, 0.1, 7),
    (
        "control.torque_growth_voltage_use",
        "brake.torque_growth_end_q15",
        31457,
        [0.85, 0.95],
        31130,
    ),
    (
        "control.torque_growth_voltage_use",
        "brake.torque_growth_slope_q9",
        25600,
        [0.85, 0.95],
        5120,
    ),
    ("control.modulation_target", "current_loop.modulation_target_pu_q15", 31748, 0.9, 29491),
    ("control.modulation_target", "current_loop.modulation_reserve_pu_q15", 248, 0.9, 230),
    ("control.modulation_reserve", "current_loop.modulation_reserve_pu_q15", 248, 0.02, 655),
    ("control.limp_drive_share", "modes.limp_drive_share_q15", 9830, 0.5, 16384),
    ("control.selftest_timeout_s", "modes.selftest_timeout_ms", 1000, 2.0, 2000),
    ("monitor.overcurrent_a", "monitor.overcurrent_pu_q15", 19363, 82.5, 16384),
    ("monitor.overcurrent_periods", "monitor.overcurrent_periods", 2, 5, 5),
    ("monitor.overvoltage_v", "battery.overvoltage_trip_mV", 60564, 59.0, 59000),
    ("monitor.undervoltage_v", "battery.undervoltage_trip_mV", 36000, 38.5, 38500),
    ("monitor.current_sum_a", "monitor.current_sum_pu_q15", 1638, 16.5, 3277),
    ("monitor.offset_tolerance_codes", "monitor.offset_tolerance_codes", 200, 100, 100),
    ("monitor.torque_tolerance_nm", "monitor.torque_tolerance_mNm", 4000, 2.5, 2500),
    ("monitor.torque_fault_time_s", "monitor.torque_fault_time_ms", 50, 0.1, 100),
    ("monitor.sensor_fault_time_s", "monitor.sensor_fault_time_ms", 20, 0.1, 100),
    ("monitor.voltage_fault_time_s", "monitor.voltage_fault_time_ms", 5, 0.1, 100),
    ("monitor.rotor_fault_time_s", "monitor.rotor_fault_time_ms", 250, 0.1, 100),
    ("monitor.angle_fault_time_s", "monitor.angle_fault_time_ms", 20, 0.1, 100),
    ("monitor.rotor_warning_time_s", "monitor.rotor_warning_time_ms", 10000, 0.1, 100),
    ("monitor.diode_fault_time_s", "monitor.diode_fault_time_ms", 20, 0.1, 100),
    ("monitor.overtemperature_margin_k", "monitor.overtemperature_margin_cC", 1000, 5.0, 500),
    ("monitor.lowest_temperature_c", "monitor.lowest_temperature_cC", -6000, -45.0, -4500),
    ("monitor.highest_temperature_c", "monitor.highest_temperature_cC", 29000, 200.0, 20000),
    ("monitor.tyre_grip_m_per_s2", "monitor.tyre_grip_mm_s2", 11768, 9.0, 9000),
    ("monitor.coasting_m_per_s2", "monitor.coasting_mm_s2", 98, 0.2, 200),
    ("monitor.standstill_rpm", "monitor.standstill_mrad_s", 300, 3.0, 314),
    ("monitor.short_release_share", "monitor.short_release_permille", 900, 0.8, 800),
]


@pytest.mark.parametrize(("key", "field", "default", "value", "expected"), OPTIONAL_KEYS)
def test_an_optional_key_replaces_its_default(
    change: Change, key: str, field: str, default: int, value: object, expected: int
) -> None:
    section, name = field.split(".")
    assert getattr(getattr(unpack(image.build(change({}))), section), name) == default
    assert getattr(getattr(unpack(image.build(change({key: value}))), section), name) == expected


def test_the_loss_of_the_bridge_is_that_of_the_paper(change: Change) -> None:
    """delta = 2 t_d f_s = 0.04: 6/pi 0.8 V delta + 3/pi 20 kHz 10 uJ/A; 3.3 and 5 milliohm."""
    drive = unpack(image.build(change({}))).drive
    assert drive.loss_per_ampere_uW_A == 252101
    assert drive.loss_resistance_uOhm == 3368


def test_the_configured_resistance_is_that_of_the_pack_times_the_wheels(change: Change) -> None:
    """12 milliohm, four wheels that all take the same: 48 mV for an ampere of one motor."""
    assert unpack(image.build(change({}))).battery.resistance_uOhm == 48000
    one = change({"vehicle.driven_wheels": 1, "battery.series_resistance_ohm": 0.02})
    assert unpack(image.build(one)).battery.resistance_uOhm == 20000


def test_a_motor_with_a_share_of_its_own_has_that_of_the_pack_s_limits(change: Change) -> None:
    """An eighth of 200 A and 250 A; the others take seven times its current: 12 milliohm, 8 A."""
    battery = unpack(image.build(change({"vehicle.pack_share": 0.125}))).battery
    assert (battery.driven_wheels, battery.pack_share_q15) == (4, 4096)
    assert battery.max_charge_current_mA == 25000
    assert battery.max_discharge_current_mA == 31250
    assert battery.resistance_uOhm == 96000
    third = unpack(image.build(change({"vehicle.pack_share": 1 / 3}))).battery
    assert third.pack_share_q15 == 10922  # rounded down: three make no more than the pack
    assert unpack(image.build(change({}))).battery.pack_share_q15 == 0


def test_one_file_makes_the_configurations_of_four_wheels() -> None:
    """They differ in name and wheel alone."""
    found = []
    for k, wheel in enumerate(("front_left", "front_right", "rear_left", "rear_right")):
        drive = schema.load("lu2013", [f"vehicle.wheel_position={wheel}"])
        assert drive.name == f"lu2013_{wheel}"
        built = image.fields(drive)
        assert built["vehicle"].pop("wheel_position") == k
        found.append(built)
    assert found == [found[0]] * 4


@pytest.mark.parametrize("setting", ["wheel_position=rear_left", "vehicle.=1", "vehicle.mass_kg"])
def test_a_setting_names_section_and_key(setting: str) -> None:
    with pytest.raises(ConfigurationError, match=r"accepted: section\.key=value"):
        schema.load("lu2013", [setting])


@pytest.mark.parametrize("path", STORED, ids=lambda path: path.stem)
def test_the_stored_files_equal_those_generated_from_their_toml(path: Path) -> None:
    generate.check(schema.load(path), GENERATED)


@pytest.mark.parametrize("path", STORED, ids=lambda path: path.stem)
def test_the_compiled_c_file_has_the_bytes_of_the_binary(tmp_path: Path, path: Path) -> None:
    compiled, section = tmp_path / "config.o", tmp_path / "config.bin"
    place = '-DCONFIG_SECTION=__attribute__((section(".hubfoc_config")))'
    flags = [
        "-std=c11",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wconversion",
        "-Wundef",
        place,
        "-I",
        str(INCLUDE),
    ]
    subprocess.run(
        ["cc", *flags, "-c", str(GENERATED / f"{path.stem}.c"), "-o", str(compiled)], check=True
    )
    subprocess.run(
        ["objcopy", "-O", "binary", "-j", ".hubfoc_config", str(compiled), str(section)], check=True
    )
    assert section.read_bytes() == (GENERATED / f"{path.stem}.bin").read_bytes()


def test_the_firmwares_validator_accepts_every_shipped_image(
    validated: Callable[[bytes], str],
) -> None:
    for path in sorted(GENERATED.glob("*.bin")):
        raw = path.read_bytes()
        assert validated(raw) == "", path.name
        broken = bytearray(raw)
        broken[100] ^= 1
        assert validated(bytes(broken)) != ""


def test_a_stale_or_missing_file_is_reported_with_its_name(
    tmp_path: Path, paper: schema.Drive
) -> None:
    with pytest.raises(CheckFailedError, match=r"lu2013\.c: missing"):
        generate.check(paper, tmp_path)
    generate.write(paper, tmp_path)
    generate.check(paper, tmp_path)
    (tmp_path / "lu2013.bin").write_bytes(b"old")
    with pytest.raises(CheckFailedError, match=r"lu2013\.bin: differs"):
        generate.check(paper, tmp_path)


def test_a_failure_between_two_files_keeps_both_old_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = {"a.c": b"old c", "a.bin": b"old bin"}
    generate.write_all(old, tmp_path)
    replace = Path.replace

    def fail_on_the_second(self: Path, target: Path) -> Path:
        if target.name == "a.bin":
            raise OSError(28, "No space left on device", str(target))
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", fail_on_the_second)
    with pytest.raises(
        ConfigurationError, match=r"a\.bin: cannot be written: No space left on device"
    ):
        generate.write_all({"a.c": b"new c", "a.bin": b"new bin"}, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == old


def test_a_refused_configuration_writes_no_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "broken.toml"
    broken.write_text(
        PAPER.read_text(encoding="utf-8").replace(
            "voltage_full_scale_v = 61.8", "voltage_full_scale_v = 59.0"
        ),
        encoding="utf-8",
    )
    assert cli.main(["generate", str(broken), "-o", str(tmp_path / "out")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        f"{broken}: inverter.voltage_full_scale_v: 59 V, accepted: more than 59.59 V, "
        "so that the board can see battery.max_voltage_v being exceeded"
    ]
    assert not (tmp_path / "out").exists()


def test_a_report_that_cannot_be_written_leaves_no_configuration_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [
        "generate",
        str(PAPER),
        "-o",
        str(tmp_path / "out"),
        "--report",
        "/proc/report.json",
    ]
    assert cli.main(arguments) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    # the file refuses root, the directory any other user
    assert lines[0].startswith("/proc/report.json: ")
    assert "cannot be written" in lines[0]
    assert list((tmp_path / "out").iterdir()) == []
