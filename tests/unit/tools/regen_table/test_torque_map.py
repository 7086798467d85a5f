# SPDX-License-Identifier: Apache-2.0
"""The stored optimum as the firmware reads it.

Bit-identical look-up, loss of energy, stability margins and number formats.
"""

import dataclasses
import itertools
import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cffi
import numpy as np
import pytest
from regen_table import (
    audit,
    braking,
    cli,
    current_audit,
    current_map,
    derived,
    envelope,
    generate,
    image,
    layout,
    loops,
    margins,
    models,
    optimum,
    refusals,
    schema,
    torque_map,
)
from regen_table.errors import ConfigurationError

ROOT = Path(__file__).resolve().parents[4]
MOTORS = sorted((ROOT / "tools" / "motors").glob("*.toml"))
Change = Callable[[dict[str, Any]], schema.Drive]


@pytest.mark.parametrize("path", MOTORS, ids=lambda path: path.stem)
def test_look_up_of_generator_and_firmware_is_bit_identical(
    firmware_library: str, path: Path
) -> None:
    ffi = cffi.FFI()
    ffi.cdef(
        "int32_t loss_maps_torque_mNm(const void *config, int32_t speed_mrad_s, int32_t"
        " winding_temperature_cC);"
    )
    firmware: Any = ffi.dlopen(firmware_library)
    drive = schema.load(path)
    raw = ffi.from_buffer(image.build(drive))
    table = current_map.regen_map(drive, current_audit.choose(drive))
    rng = np.random.default_rng(5)
    top = round(1.2 * drive.motor.max_speed_rpm * math.pi / 30.0 * 1000.0)
    speeds = np.concatenate(
        [rng.integers(-top, top, 2000), rng.integers(-5000, 5000, 500), [0, 1, -1, top]]
    )
    temperatures = rng.integers(-6000, 20000, speeds.size)
    expected = [
        firmware.loss_maps_torque_mNm(raw, int(s), int(t))
        for s, t in zip(speeds, temperatures, strict=True)
    ]
    assert audit.read(table, speeds.astype(float), temperatures.astype(float)).tolist() == expected


@pytest.mark.parametrize("path", MOTORS, ids=lambda path: path.stem)
def test_stored_table_loses_negligible_energy(path: Path) -> None:
    drive = schema.load(path)
    currents = current_audit.choose(drive)
    table, made = current_map.regen_map(drive, currents), current_map.production(currents)
    losses = audit.grid_losses(drive, table, made)
    assert {loss.manoeuvre for loss in losses} >= {
        "hard stop",
        "stop at rated torque",
        "ece15",
        "udds",
    }
    assert all(-1e-9 <= loss.relative <= 2e-4 for loss in losses)
    # Electric braking has faded out at handover_end_rpm; from there on all regenerated power is
    # included.
    assert audit.worst_power_loss(drive, table, made) <= 1e-3


@pytest.mark.parametrize(
    "path", [p for p in MOTORS if schema.load(p).motor.type == "spmsm"], ids=lambda path: path.stem
)
def test_surface_magnets_have_the_unclamped_optimum_up_to_the_top_speed(path: Path) -> None:
    # Looked up as in the firmware and compared with the closed form with i_d = 0, without table and
    # limits.
    drive = schema.load(path)
    table = current_map.regen_map(drive, current_audit.choose(drive))
    winding = np.linspace(table.temperatures_c[0], table.temperatures_c[-1], 65)[:, np.newaxis]
    speed = np.linspace(drive.control.handover_end_rpm, drive.motor.max_speed_rpm, 2001) * (
        math.pi / 30.0
    )
    motor, inverter = models.machine(drive, winding), models.bridge(drive)
    best = optimum.closed_form(motor, inverter, speed * motor.pole_pairs)
    exact = models.evaluate(
        motor, inverter, speed * motor.pole_pairs, 0.0, best.current_q_a
    ).dc_power_w
    stored = audit.read(table, speed * 1000.0, winding * 100.0) / 1000.0
    power = braking.state_of_torque(motor, inverter, speed, -stored).dc_power_w
    assert np.all(best.possible)
    assert np.max((power - exact) / -exact) <= 1e-3


def test_without_i_d_the_table_is_the_closed_form_at_its_points(paper: schema.Drive) -> None:
    table = torque_map.regen_map(paper)
    for row, warm in enumerate(table.temperatures_c):
        best = optimum.closed_form(
            models.machine(paper, float(warm)), models.bridge(paper), table.speeds_rad_s * 23
        )
        beside = np.abs(-1000.0 * best.torque_optimal_nm - table.torque_mNm[row])
        assert np.all(beside[1:] <= 0.5 * 2.0**table.lsb_log2)
    assert np.all(table.torque_mNm[:, 0] < 0)  # the line goes on below zero at standstill


@pytest.mark.parametrize(("section", "coarsest_log2"), [("regen_map", 10), ("current_map", 6)])
def test_entries_count_in_the_finest_power_of_two_in_which_the_largest_fits(
    section: str, coarsest_log2: int
) -> None:
    rng = np.random.default_rng(11)
    for decade in range(8):
        exact = 10.0**decade * rng.uniform(-1.0, 1.0, 50)
        stored, lsb_log2 = torque_map.resolved(section, exact)
        assert 0 <= lsb_log2 <= coarsest_log2
        assert np.all(stored % 2**lsb_log2 == 0)
        end = 32767.0 * 2.0**lsb_log2
        assert np.all(np.abs(stored - np.clip(exact, -end, end)) <= 0.5 * 2.0**lsb_log2)
        largest = np.max(np.abs(exact))
        assert lsb_log2 == coarsest_log2 or largest < 32767.5 * 2.0**lsb_log2
        assert lsb_log2 == 0 or largest >= 32767.5 * 2.0 ** (lsb_log2 - 1)


def test_a_grid_is_refused_according_to_its_energy_loss(paper: schema.Drive) -> None:
    losses = generate.make_report(paper).grid_losses
    audit.refuse_lossy_grid(losses)
    lossy = dataclasses.replace(losses[0], relative=3e-4)
    with pytest.raises(
        ConfigurationError,
        match=r"the grid loses 0\.030% of the energy of the .* accepted: at most 0\.02%",
    ):
        audit.refuse_lossy_grid([*losses, lossy])


def test_a_too_coarse_grid_is_refused_with_the_smallest_sufficient_one() -> None:
    bike = tomllib.loads((ROOT / "tools" / "motors" / "ebike36v.toml").read_text(encoding="utf-8"))

    def drive(speeds: int | str, temperatures: int | str) -> schema.Drive:
        grid = {"speed_points": speeds, "temperature_points": temperatures}
        return schema.parse(bike | {"table": bike["table"] | grid}, "bike", "bike.toml")

    with pytest.raises(
        ConfigurationError,
        match=(
            r"^table\.speed_points, .* loses 0\.\d+% of the energy of the \w+ at \d+ degC,"
            r" accepted: at most 0\.02%; "
            r"the smallest grid that suffices is speed_points = \d+, temperature_points = \d+$"
        ),
    ) as refused:
        generate.make_report(drive(9, 2))
    speeds, temperatures = (int(n) for n in re.findall(r"points = (\d+)", str(refused.value)))
    generate.make_report(drive(speeds, temperatures))
    for fewer in {
        (s, t) for s in range(2, 66) for t in range(2, 18) if s * t < speeds * temperatures
    }:
        with pytest.raises(ConfigurationError, match=r"the grid loses"):
            generate.make_report(drive(*fewer))
    chosen = current_audit.braking_table(drive("auto", "auto"))
    assert chosen.torque_mNm.shape == (temperatures, speeds)
    assert current_audit.braking_table(drive(9, "auto")).torque_mNm.shape[1] == 9
    assert image.build(drive("auto", "auto"))[:-4] != image.build(drive(12, 5))[:-4]


def test_a_grid_beyond_array_size_or_resolution_is_refused_with_its_keys(
    change: Change,
) -> None:
    for changes, expected in (
        (
            {"table.speed_points": 65, "table.temperature_points": 17},
            "65 x 17, accepted: at most 800",
        ),
        (
            {"table.temperature_range_c": [-50.0, 290.0], "table.temperature_points": 2},
            r"^table.temperature_points: 2, accepted: at least 3 up to the end of table",
        ),
    ):
        with pytest.raises(ConfigurationError, match=expected):
            image.build(change(changes))
    image.build(change({"table.temperature_range_c": [-50.0, 290.0]}))


def test_a_fast_motor_with_little_speed_dependence_of_i_d_is_accepted() -> None:
    """Two speeds would suffice for its i_d, but a step of the axis is at most 2^20 mrad/s."""
    tree = tomllib.loads((ROOT / "tools" / "motors" / "ipm400v.toml").read_text(encoding="utf-8"))
    tree["motor"] |= {
        "type": "spmsm",
        "q_inductance_h": tree["motor"]["d_inductance_h"],
        "max_speed_rpm": 11000.0,
        "rated_torque_nm": 40.0,
        "max_torque_nm": 50.0,
    }
    del tree["motor"]["iron_loss_resistance_ohm"]
    tree["table"] |= {"speed_points": "auto", "temperature_points": "auto"}
    drive = schema.parse(tree, "fast", "fast.toml")
    generate.make_report(drive)
    image.build(drive)
    table = current_audit.choose(drive)
    assert table.speed_step_log2 == 20
    assert table.speeds_rad_s[-1] >= 11000.0 * math.pi / 30.0


def test_an_ideal_loop_has_the_margins_of_an_integrator_with_delay_and_a_half() -> None:
    # With the pole cancelled the loop is K / (z (z - 1)). Its phase is -(90 deg + 1.5 omega T)
    # exactly; at omega T = 60 deg that is -180 deg, and |z - 1| = 1 there: the gain margin is 1 /
    # K. |z - 1| = 2 sin(omega T / 2) = K is the crossover.
    for k in (0.05, 0.2, 0.4):
        found = margins.frequency_response(
            margins.Loop(1e-9, 1e-4, k * 10.0, 0.0, 1e-5)
        )  # L / T = 10 ohm, negligible R
        angle = 2.0 * math.asin(k / 2.0)
        assert found["crossover_hz"] == pytest.approx(angle / (2.0 * math.pi * 1e-5), rel=1e-3)
        assert found["phase_margin_deg"] == pytest.approx(
            90.0 - math.degrees(1.5 * angle), abs=0.05
        )
        assert found["gain_margin"] == pytest.approx(1.0 / k, rel=1e-3)


@pytest.mark.parametrize("pole", np.linspace(0.05, 0.5, 10))
def test_step_response_equals_the_design_at_every_sample(change: Change, pole: float) -> None:
    frequency = 20e3
    bandwidth = pole * frequency / (2.0 * math.pi)
    drive = change({"control.current_bandwidth_hz": bandwidth})
    resistance = drive.motor.phase_resistance_ohm + drive.inverter.switch_resistance_ohm
    shape = margins.reference_shape(bandwidth, 1.0 / frequency)
    for inductance in (20e-6, 76e-6, 1e-3):
        gains = loops.axis_gains(drive, inductance)
        loop = margins.Loop(
            resistance, inductance, gains.proportional, gains.integral, 1.0 / frequency, shape
        )
        current, designed = (
            margins.step_response(loop, 400),
            margins.designed_step(bandwidth, 1.0 / frequency, 400),
        )
        assert np.max(np.abs(current - designed)) <= 1e-9
        assert 0.96 <= margins.frequency_response(loop)["bandwidth_hz"] / bandwidth <= 1.0
    # With b = exp(-omega_c T / 2) the shares are closed forms, which the firmware uses.
    b = math.exp(-0.5 * pole)
    assert np.cumsum(shape) == pytest.approx([1.0 / (b * b * (1.0 + b)), 1.0 / b, 1.0], rel=1e-12)


def test_without_prefilter_the_response_is_faster_than_designed(paper: schema.Drive) -> None:
    gains = loops.axis_gains(paper, paper.motor.q_inductance_h)
    resistance = paper.motor.phase_resistance_ohm + paper.inverter.switch_resistance_ohm
    loop = margins.Loop(
        resistance, paper.motor.q_inductance_h, gains.proportional, gains.integral, 50e-6
    )
    ahead = margins.step_response(loop, 40) - margins.designed_step(1000.0, 50e-6, 40)
    assert int(np.argmax(ahead)) == 2
    assert ahead[2] > 0.05


def test_a_bandwidth_above_the_limit_of_the_delay_is_refused_and_the_limit_accepted(
    change: Change,
) -> None:
    fastest = change({"control.current_bandwidth_hz": 1591.0})
    margins.refuse_thin_margins(fastest, margins.current_loop(fastest))
    faster = change({"control.current_bandwidth_hz": 1592.0})
    with pytest.raises(ConfigurationError, match="1592 Hz, accepted: at most 1591 Hz"):
        margins.refuse_thin_margins(faster, margins.current_loop(faster))


def test_the_loop_is_stable_with_a_cold_and_a_hot_winding(paper: schema.Drive) -> None:
    found = margins.current_loop(paper)
    assert {(m.axis, m.winding_temperature_c) for m in found} == {
        (axis, t) for axis in "dq" for t in (-20.0, 25.0, 150.0)
    }
    for m in found:
        assert m.step_deviation <= 0.005
        assert 0.975 <= m.bandwidth_hz / 1000.0 <= 1.0


@pytest.mark.parametrize("bandwidth", [500.0, 1000.0, 1590.0])
def test_the_gain_margin_is_the_stability_limit_of_a_simulated_loop(
    change: Change, bandwidth: float
) -> None:
    drive = change({"control.current_bandwidth_hz": bandwidth})
    found = next(m for m in margins.current_loop(drive) if m.axis == "q")
    period = 1.0 / drive.inverter.pwm_frequency_hz
    resistance = (
        float(np.asarray(models.machine(drive, found.winding_temperature_c).resistance_ohm))
        + drive.inverter.switch_resistance_ohm
    )
    gains = loops.axis_gains(drive, drive.motor.q_inductance_h)
    integral = gains.integral * loops.resistance_ratio(drive, found.winding_temperature_c)

    def grows(factor: float) -> bool:
        loop = margins.Loop(
            resistance,
            drive.motor.q_inductance_h,
            factor * gains.proportional,
            factor * integral,
            period,
        )
        error = np.abs(1.0 - margins.step_response(loop, 4000))
        return bool(np.max(error[3600:]) > np.max(error[200:600]))

    assert not grows(0.98 * found.gain_margin)
    assert grows(1.02 * found.gain_margin)


def test_an_interval_contains_every_result_of_its_operations() -> None:
    rng = np.random.default_rng(6)
    for _ in range(2000):
        ends = np.sort(rng.uniform(-10.0, 10.0, (2, 2)), axis=1)
        a, b = (envelope.Interval(float(low), float(high)) for low, high in ends)
        x, y = (float(rng.uniform(i.low, i.high)) for i in (a, b))
        for result, value in ((a * b, x * y), (a + b, x + y), (2.5 * a, 2.5 * x)):
            assert result.low - 1e-12 <= value <= result.high + 1e-12
        if a.low > 0.0 or a.high < 0.0:
            inverse = a.reciprocal()
            assert inverse.low - 1e-12 <= 1.0 / x <= inverse.high + 1e-12
    with pytest.raises(ZeroDivisionError):
        envelope.Interval(-1.0, 1.0).reciprocal()


@pytest.mark.parametrize("path", MOTORS, ids=lambda path: path.stem)
def test_the_firmwares_scaled_gains_are_inside_the_proved_intervals(
    firmware_library: str, path: Path
) -> None:
    ffi = cffi.FFI()
    ffi.cdef("""
        typedef struct { int32_t proportional_q10, integral_q15, anti_windup_q15; } pi_gains_t;
        typedef struct {
            pi_gains_t d, q;
            int32_t w_l_d_q10, w_l_q_q10, forward_d_q25, forward_q_q25, rest[8];
        } tuning_t;
        typedef struct {
            int32_t of_d[4], of_q[4], rest;
        } winding_t;
        winding_t winding_constants(const void *config);
        tuning_t current_tuning(const void *config, const winding_t *winding, int32_t limit_q15,
                                int32_t v_dc_pu, int32_t speed_q32, int32_t winding_temperature_cC);
    """)
    firmware: Any = ffi.dlopen(firmware_library)
    drive = schema.load(path)
    raw = ffi.from_buffer(image.build(drive))
    proved = {proof.quantity: proof.found for proof in envelope.proofs(drive)}
    config: Any = layout.load().ffi.from_buffer("config_t *", image.build(drive))
    limit = config.current_loop.modulation_limit_pu_q15
    full_scale, base = drive.inverter.voltage_full_scale_v, loops.bases(drive)
    winding = ffi.new("winding_t *", firmware.winding_constants(raw))
    largest: dict[str, float] = {}
    buses = np.linspace(loops.undervoltage_trip_v(drive), derived.overvoltage_trip_v(drive), 7)
    for winding_c in (drive.table.temperature_range_c[0], drive.motor.max_winding_temperature_c):
        for bus, share in itertools.product(buses, (-1.0, -0.5, 0.1, 1.0)):
            omega = share * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.motor.pole_pairs
            turns = omega * base.period_s / (2.0 * math.pi)
            tuning = firmware.current_tuning(
                raw,
                winding,
                limit,
                round(bus / full_scale * 32768),
                round(turns * 2**32),
                round(winding_c * 100),
            )
            values = {
                "proportional_d": tuning.d.proportional_q10 / 1024,
                "proportional_q": tuning.q.proportional_q10 / 1024,
                "integral": tuning.q.integral_q15 / 32768,
                "anti_windup_d": tuning.d.anti_windup_q15 / 32768,
                "w_l_d": tuning.w_l_d_q10 / 1024,
                "w_l_q": tuning.w_l_q_q10 / 1024,
                "w_psi": tuning.forward_q_q25 / 2**25,
            }
            for name, value in values.items():
                found = proved[f"current_loop.{name}"]
                slack = 0.003 * max(abs(found.low), abs(found.high)) + 2.0 / 2048
                assert found.low - slack <= value <= found.high + slack, (name, value, found)
                largest[name] = max(largest.get(name, 0.0), abs(value))
    # The intervals are tight: corners of the envelope reach their ends, except for the speed
    # reserve.
    for name, value in largest.items():
        assert value >= 0.9 * proved[f"current_loop.{name}"].high, name


# One change of the paper's vehicle exceeds each number format, each beyond a plausible drive.
FAST = {
    "motor.max_speed_rpm": 3200.0,
    "motor.flux_linkage_wb": 0.0035,
    "motor.rated_torque_nm": 5.0,
    "motor.max_torque_nm": 8.0,
}
HEAVY_D = {"motor.type": "ipmsm", "motor.d_inductance_h": 3e-3}
HEAVY_Q = {"motor.type": "ipmsm", "motor.q_inductance_h": 3e-3}
BREAKS: dict[str, dict[str, Any]] = {
    "modulation.lowest_counts": {"inverter.min_pulse_s": 1e-5},
    "modulation.limit": {"inverter.dead_time_s": 1e-5},
    "rotor.speed_pu": FAST,
    "current_loop.w_psi": {"battery.min_voltage_v": 8.0},
    "current_loop.integral": {"control.current_bandwidth_hz": 10.0},
    "current_loop.proportional_d": HEAVY_D,
    "current_loop.proportional_q": HEAVY_Q,
    "current_loop.w_l_d": HEAVY_D,
    "current_loop.w_l_q": HEAVY_Q,
    "current_loop.pi_output_d": HEAVY_D,
    "current_loop.pi_output_q": HEAVY_Q,
    "current_loop.anti_windup_d": {"motor.phase_resistance_ohm": 5.0},
    "current_loop.anti_windup_q": {"motor.phase_resistance_ohm": 5.0},
    "current_loop.proportional_d_pu": HEAVY_D,
    "current_loop.proportional_q_pu": HEAVY_Q,
    "current_loop.inductance_d_pu": HEAVY_D,
    "current_loop.inductance_q_pu": HEAVY_Q,
    "dead_time.zone": {"control.dead_time_zone_a": 0.1},
}


def test_every_number_format_can_be_exceeded_by_some_drive(paper: schema.Drive) -> None:
    assert {proof.quantity for proof in envelope.proofs(paper)} == set(BREAKS)


@pytest.mark.parametrize("quantity", BREAKS)
def test_a_quantity_outside_its_number_format_is_found(paper: schema.Drive, quantity: str) -> None:
    drive = paper
    for name, value in BREAKS[quantity].items():
        drive = refusals.with_value(drive, name, value)
    proofs = {proof.quantity: proof for proof in envelope.proofs(drive)}
    assert not proofs[quantity].holds
    with pytest.raises(ConfigurationError):
        image.build(drive)


def test_a_too_coarse_grid_is_refused_before_writing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # T_opt of a motor whose copper dominates goes with 1 / R: over 150 K, R grows by 0.7, and a
    # straight line between the ends is up to 7 % off the hyperbola, (sqrt(1.7) - 1)^2 / (2
    # sqrt(1.7)) of its value: the square of it is lost.
    coarse = tmp_path / "coarse.toml"
    text = (ROOT / "tools" / "motors" / "ebike36v.toml").read_text(encoding="utf-8")
    coarse.write_text(
        re.sub(r"(?m)^temperature_points = \d+", "temperature_points = 2", text), encoding="utf-8"
    )
    with pytest.raises(
        ConfigurationError,
        match=(
            r"^table\.speed_points, table\.temperature_points: the grid loses 0\.\d+% of the energy"
        ),
    ):
        generate.make_report(schema.load(coarse))
    assert cli.main(["generate", str(coarse), "-o", str(tmp_path / "out")]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert errors[0].startswith(
        f"{coarse}: table.speed_points, table.temperature_points: the grid loses"
    )
    assert not (tmp_path / "out").exists()
