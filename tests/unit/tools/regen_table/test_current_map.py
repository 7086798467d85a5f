# SPDX-License-Identifier: Apache-2.0
"""The stored demagnetising current.

Exact torque, minimum loss with few points, independence of the bus voltage.
"""

import dataclasses
import math
from pathlib import Path
from typing import Any

import cffi
import numpy as np
import pytest
from regen_table import audit, current_audit, current_map, image, joint, models, schema, torque_map
from regen_table.errors import ConfigurationError
from regen_table.models import Array

ROOT = Path(__file__).resolve().parents[4]
MOTORS = sorted((ROOT / "tools" / "motors").glob("*.toml"))


@pytest.fixture(params=MOTORS, ids=lambda path: path.stem)
def drive(request: pytest.FixtureRequest) -> schema.Drive:
    return schema.load(request.param)


def test_the_torque_is_exact_at_any_demagnetising_current(
    random_drives: list[schema.Drive],
) -> None:
    rng = np.random.default_rng(7)
    for drive in random_drives[::4]:
        motor, inverter = models.machine(drive, 80.0), models.bridge(drive)
        omega = (
            drive.motor.max_speed_rpm
            * math.pi
            / 30.0
            * motor.pole_pairs
            * rng.uniform(-1.0, 1.0, 100)
        )
        torque = drive.motor.rated_torque_nm * rng.uniform(-1.0, 1.0, 100)
        current = -drive.motor.max_phase_current_a * rng.uniform(0.0, 0.6, 100)
        state = current_map.state(motor, inverter, omega, torque, current)
        assert np.all(np.abs(state.torque_nm - torque) <= 1e-9 * drive.motor.rated_torque_nm)
        assert np.all(np.abs(state.current_d_a - current) <= 1e-9 * drive.motor.max_phase_current_a)


def test_few_points_suffice_for_1e_4_of_the_least_loss(
    drive: schema.Drive,
) -> None:
    table = current_audit.choose(drive)
    losses = current_audit.losses(drive, table)
    parts = {f"{cycle} {part}" for cycle in ("ece15", "udds") for part in ("driving", "braking")}
    assert {loss.manoeuvre for loss in losses} >= {"hard stop", "full acceleration"} | parts
    for loss in losses:
        assert -1e-9 <= loss.stored <= 1e-4
        assert -1e-9 <= loss.temperature <= 5e-5
        assert loss.without_d_current >= -1e-9


def test_the_stored_current_does_not_reduce_braking_power_at_any_point(drive: schema.Drive) -> None:
    assert current_audit.worst_power_loss(drive, current_audit.choose(drive)) <= 5e-4


def test_temperature_is_an_axis_only_if_flux_or_iron_loss_depends_on_it() -> None:
    layers = {
        path.stem: current_audit.choose(schema.load(path)).current_d_mA.shape[0] for path in MOTORS
    }
    assert layers["ipm400v"] == layers["lu2013"] == 2
    assert layers["ebike36v"] == layers["scooter48v"] == 1


def test_a_smaller_grid_exceeds_the_permitted_loss(drive: schema.Drive) -> None:
    chosen = current_audit.choose(drive)
    layers = chosen.current_d_mA.shape[0]
    for torque, speed in ((1, 0), (0, 1)):
        steps = (chosen.torque_step_log2 + torque, chosen.speed_step_log2 + speed)
        columns, rows = current_map.points_over(drive, *steps)
        if (
            columns < 5
            or rows < 2
            or (columns, rows) == (chosen.current_d_mA.shape[2], chosen.current_d_mA.shape[1])
        ):
            continue
        coarse = current_map.compute(drive, *steps, layers)
        energy = max(loss.stored for loss in current_audit.losses(drive, coarse))
        assert energy > 1e-4 or current_audit.worst_power_loss(drive, coarse) > 5e-4


def test_a_drive_whose_map_exceeds_its_maximum_size_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drive = schema.load(ROOT / "tools" / "motors" / "ipm400v.toml").named("coarse")  # not kept yet
    monkeypatch.setattr(current_audit, "_grids", lambda drive, layers: [(20, 20)])
    with pytest.raises(
        ConfigurationError,
        match=(
            r"^motor.q_inductance_h: .* loses \d+\.\d+% of the energy .* accepted: at most 0\.02%"
        ),
    ):
        current_audit.choose(drive)


def test_neglecting_the_bus_voltage_costs_less_than_0_1_percent(
    drive: schema.Drive,
) -> None:
    assert current_audit.bus_voltage_loss(drive) < 1e-3


def power_of(drive: schema.Drive, speed: Array, torque: Array, current: Array) -> Array:
    """DC power of torques made with an i_d, at the temperature a single layer is made for."""
    motor, inverter = (
        models.machine(drive, float(np.mean(drive.table.temperature_range_c))),
        models.bridge(drive),
    )
    return current_map.state(motor, inverter, speed * motor.pole_pairs, torque, current).dc_power_w


def test_at_zero_torque_the_map_gives_the_least_power(drive: schema.Drive) -> None:
    table = current_audit.choose(drive)
    table = current_map.compute(drive, table.torque_step_log2, table.speed_step_log2, 1)
    speed, torque = table.speeds_rad_s, np.zeros(len(table.speeds_rad_s))
    at = current_map.read(table, torque, speed, 0.0)
    assert np.allclose(
        at * 1000.0, table.current_d_mA[0, :, table.current_d_mA.shape[2] // 2], rtol=0.0, atol=1e-6
    )
    # Neighbours half an ampere away cost more: so the points are minima, verified without the
    # search.
    for step in (-0.5, 0.5):
        assert np.all(
            power_of(drive, speed, torque, at + step)
            >= power_of(drive, speed, torque, at) - 1e-6 * drive.motor.max_power_w
        )


@pytest.mark.parametrize(
    "path", [p for p in MOTORS if schema.load(p).motor.type == "ipmsm"], ids=lambda path: path.stem
)
def test_points_off_the_curve_give_a_smaller_loss_than_points_on_it(path: Path) -> None:
    drive = schema.load(path)
    torque_step = torque_map.step_log2(2000.0 * drive.motor.max_torque_nm, 9, 0)
    beside = current_map.compute(
        drive,
        torque_step,
        torque_map.step_log2(drive.motor.max_speed_rpm * math.pi / 30.0 * 1000.0, 5, 6),
        1,
    )
    motor, inverter = (
        models.machine(drive, float(np.mean(drive.table.temperature_range_c))),
        models.bridge(drive),
    )

    def least(torque: Array, speed: Array) -> joint.Point:
        bounds = joint.Limits(current_map.RELAXED * drive.motor.max_phase_current_a)
        return joint.least_power(motor, inverter, speed * motor.pole_pairs, torque, bounds)

    on = least(beside.torques_nm, beside.speeds_rad_s[:, np.newaxis]).state.current_d_a
    table = dataclasses.replace(
        beside, current_d_mA=np.rint(1000.0 * on).astype(np.int32)[np.newaxis]
    )
    top_rad_s = drive.motor.max_speed_rpm * math.pi / 30.0
    speed, torque = np.meshgrid(
        np.linspace(0.0, 1.0, 41)[1:] * top_rad_s,
        np.linspace(-1.0, 1.0, 81) * drive.motor.max_torque_nm,
    )
    best = least(torque, speed).state.dc_power_w
    lost = [
        float(
            np.mean(power_of(drive, speed, torque, current_map.read(t, torque, speed, 0.0)) - best)
        )
        for t in (beside, table)
    ]
    assert 0.0 < lost[0] < 0.7 * lost[1]


def test_reverse_rotation_uses_the_negated_torque(drive: schema.Drive) -> None:
    table = current_audit.choose(drive)
    torque = np.linspace(-1.0, 1.0, 41) * drive.motor.max_torque_nm
    speed = 0.37 * drive.motor.max_speed_rpm * math.pi / 30.0
    assert np.array_equal(
        current_map.read(table, torque, speed, 40.0), current_map.read(table, -torque, -speed, 40.0)
    )


def test_braking_table_of_the_map_loses_negligible_energy(drive: schema.Drive) -> None:
    table = current_audit.choose(drive)
    losses = audit.grid_losses(
        drive, current_map.regen_map(drive, table), current_map.production(table)
    )
    assert all(-1e-6 <= loss.relative <= 2e-4 for loss in losses), losses


def test_the_optimum_of_the_map_is_the_joint_optimum_of_both_currents(drive: schema.Drive) -> None:
    table = current_audit.choose(drive)
    motor, inverter = (
        models.machine(drive, float(np.mean(drive.table.temperature_range_c))),
        models.bridge(drive),
    )
    speed = np.array([0.05, 0.1, 0.3, 0.9]) * drive.motor.max_speed_rpm * math.pi / 30.0
    limit = 0.9 * drive.motor.max_torque_nm
    torque = current_map.best_torque_nm(motor, inverter, table, speed, limit)
    made = current_map.production(table).state(motor, inverter, speed, -torque).dc_power_w
    best = joint.best_braking(
        motor,
        inverter,
        speed * motor.pole_pairs,
        joint.Limits(3.0 * drive.motor.max_phase_current_a),
        limit,
    )
    assert np.all(made <= best.state.dc_power_w + 1e-3 * np.abs(best.state.dc_power_w))


def test_look_up_of_generator_and_firmware_is_bit_identical(
    firmware_library: str, drive: schema.Drive
) -> None:
    ffi = cffi.FFI()
    ffi.cdef("""
        typedef struct { int64_t words[16]; } row_t;
        row_t loss_maps_row_at(const void *config, int32_t speed_mrad_s,
                               int32_t winding_temperature_cC);
        int32_t loss_maps_row_d_mA(const row_t *row, int32_t along_mNm);
    """)
    firmware: Any = ffi.dlopen(firmware_library)
    raw = ffi.from_buffer(image.build(drive))
    table = current_audit.choose(drive)
    rng = np.random.default_rng(8)
    top, most = (
        round(1200.0 * drive.motor.max_speed_rpm * math.pi / 30.0),
        round(1500.0 * drive.motor.max_torque_nm),
    )
    speeds, torques, warm = (
        rng.integers(low, high, 3000) for low, high in ((-top, top), (-most, most), (-5000, 20000))
    )
    row = ffi.new("row_t *")
    expected = []
    for s, w, t in zip(speeds, warm, torques, strict=True):
        row[0] = firmware.loss_maps_row_at(raw, int(s), int(w))
        expected.append(firmware.loss_maps_row_d_mA(row, int(t) if s >= 0 else -int(t)))
    found = current_map.read(table, torques / 1000.0, speeds / 1000.0, warm / 100.0)
    assert np.rint(found * 1000.0).astype(int).tolist() == expected


def test_power_at_every_torque_in_the_firmware_equals_that_of_the_generator(
    firmware_library: str, drive: schema.Drive
) -> None:
    """The current setpoint, compiled, against the model.

    Torque within 0.2 %, and the DC power of the stored map, or the least within the phase current
    limit where the map lies outside it. A torque beyond the current limit is reduced to the largest
    one inside it.
    """
    ffi = cffi.FFI()
    ffi.cdef("""
        typedef struct { int64_t words[32]; } constants_t;
        typedef struct { const void *constants, *config; int32_t words[24]; } model_t;
        typedef struct { int64_t words[16]; } set_t;
        typedef struct { int32_t d_mA, q_mA; bool limited; } current_t;
        void motor_constants_init(constants_t *constants, const void *config);
        model_t motor_model_at(const constants_t *constants, const void *config,
                               int32_t speed_mrad_s, int32_t winding_temperature_cC);
        set_t feasible_set_at(const model_t *model, int32_t phase_voltage_mV);
        current_t current_setpoint_step(const set_t *set, int32_t torque_mNm,
                                        int32_t i_d_weakening_mA);
    """)
    firmware: Any = ffi.dlopen(firmware_library)
    raw = ffi.from_buffer(image.build(drive))
    constants = ffi.new("constants_t *")
    firmware.motor_constants_init(constants, raw)
    table, inverter = current_audit.choose(drive), models.bridge(drive)
    warm = drive.motor.reference_temperature_c + 60.0
    motor = models.machine(drive, warm)
    most, circle = drive.motor.max_phase_current_a, np.linspace(0.0, 2.0 * math.pi, 2001)
    for speed in np.linspace(-1.0, 1.0, 9) * drive.motor.max_speed_rpm * math.pi / 30.0:
        model = ffi.new(
            "model_t *",
            firmware.motor_model_at(constants, raw, round(speed * 1000.0), round(warm * 100.0)),
        )
        feasible = ffi.new("set_t *", firmware.feasible_set_at(model, 1_000_000))  # no limit
        turning = float(np.clip(speed, -0.5, 0.5)) / 0.5
        friction = turning * motor.friction_nm + motor.viscous_nm_s * speed
        limit = models.evaluate(
            motor,
            inverter,
            speed * motor.pole_pairs,
            most * np.cos(circle),
            most * np.sin(circle),
        ).torque_nm
        for asked in np.linspace(-1.0, 1.0, 9) * drive.motor.max_torque_nm:
            torque = float(np.clip(asked, limit.min(), limit.max()))
            i = firmware.current_setpoint_step(feasible, round((asked - friction) * 1000.0), 0)
            assert i.limited == (abs(asked - torque) > 1e-2 * drive.motor.max_torque_nm)
            assert math.hypot(i.d_mA, i.q_mA) <= 1000.0 * most + 1.0
            made = models.evaluate(
                motor, inverter, speed * motor.pole_pairs, i.d_mA / 1000.0, i.q_mA / 1000.0
            )
            assert abs(float(made.torque_nm) - torque) <= 2e-3 * drive.motor.max_torque_nm
            if i.limited:
                continue
            promised = current_map.state(
                motor,
                inverter,
                speed * motor.pole_pairs,
                torque,
                current_map.read(table, torque, speed, warm),
            )
            if math.hypot(float(promised.current_d_a), float(promised.current_q_a)) > most:
                within = joint.Limits(most)
                promised = joint.least_power(
                    motor, inverter, speed * motor.pole_pairs, torque, within
                ).state
            assert float(made.dc_power_w) == pytest.approx(
                float(promised.dc_power_w), rel=3e-3, abs=2e-3 * drive.motor.max_power_w
            )
