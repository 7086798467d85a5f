# SPDX-License-Identifier: Apache-2.0
"""A controller of one's own on hubfoc's plant, beside the firmware on the same stop.

    ./tools/dev python host_sim/python/examples/own_controller.py

A quarter of the paper's vehicle on one wheel brakes to standstill. Once the firmware does it
(``hubsim.Bench``), once a textbook controller in floating point (``hubsim.Plant``): PI regulators
in the rotor's frame with decoupling, i_d = 0, the motor gives all it can and the hydraulic brake
the rest. The textbook controller has an ideal angle sensor; the firmware has the vehicle's hall
sensors.
"""

import cmath
import math
from dataclasses import dataclass
from typing import Any

import hubsim

DRIVE = "lu2013"
QUARTER = {"vehicle.driven_wheels": 1, "vehicle.mass_kg": 165.0, "vehicle.frontal_area_m2": 0.0}
SPEED_KMH = 30.0
DEMAND_NM = 60.0
BANDWIDTH_HZ = 500.0
BLEND_OUT_RAD_S = 2.0  # below it the motor fades out and the hydraulic brake takes over


@dataclass
class Foc:
    """Field-oriented control of one motor; amplitude-invariant, d + j q.

    One step a PWM period: the voltage it computes acts in the period after it, whose middle is one
    and a half periods away.
    """

    resistance_ohm: float
    inductance_h: float
    flux_wb: float
    pole_pairs: int
    max_current_a: float
    period_s: float
    integral_v: complex = 0j

    def quadrature_current_a(self, torque_nm: float) -> float:
        """Return the current that makes a torque with i_d = 0, within the largest current."""
        wanted = torque_nm / (1.5 * self.pole_pairs * self.flux_wb)
        return max(-self.max_current_a, min(self.max_current_a, wanted))

    def step(
        self, phase_a: list[float], turn: float, omega: float, bus_v: float, i_q: float
    ) -> list[float]:
        """Return the three duties; ``omega`` is electrical, rad/s."""
        stator = complex(
            (2.0 * phase_a[0] - phase_a[1] - phase_a[2]) / 3.0,
            (phase_a[1] - phase_a[2]) / math.sqrt(3.0),
        )
        axis = cmath.exp(2j * math.pi * turn)
        now = stator / axis
        error = 1j * i_q - now
        crossover = 2.0 * math.pi * BANDWIDTH_HZ
        decoupling = 1j * omega * (self.inductance_h * now + self.flux_wb)
        wanted = crossover * self.inductance_h * error + self.integral_v + decoupling
        limit = bus_v / math.sqrt(3.0)
        given = wanted if abs(wanted) <= limit else wanted * (limit / abs(wanted))
        # The regulator integrates the error that the voltage it was given would belong to.
        realised = error + (given - wanted) / (crossover * self.inductance_h)
        self.integral_v += crossover * self.resistance_ohm * self.period_s * realised
        u = given * axis * cmath.exp(1.5j * omega * self.period_s)
        half = math.sqrt(3.0) / 2.0
        phases = (u.real, -0.5 * u.real + half * u.imag, -0.5 * u.real - half * u.imag)
        middle = 0.5 * (max(phases) + min(phases))
        return [0.5 + (phase - middle) / bus_v for phase in phases]


@dataclass(frozen=True)
class Stop:
    """What a stop came to."""

    stored: float  # 1, share of the kinetic energy
    distance_m: float
    hydraulic_j: float  # heat in the hydraulic brake
    residual_j: float  # of the plant's energy account


def _result(vehicle: hubsim.Bench | hubsim.Plant) -> Stop:
    return Stop(
        vehicle["energy.chemical_j"] / vehicle["energy.kinetic_j"],
        vehicle["vehicle.distance_m"],
        vehicle["energy.hydraulic_j"],
        vehicle["energy.residual_j"],
    )


def _settings() -> dict[str, Any]:
    return {
        "initial_speed_kmh": SPEED_KMH,
        "demand_nm": DEMAND_NM,
        "drag": False,
        "stop_at_standstill": True,
    }


def with_firmware(config: hubsim.Configuration) -> Stop:
    """Stop with the firmware's controller."""
    with hubsim.Bench(config, **_settings()) as bench:
        bench.run()
        return _result(bench)


def with_own(config: hubsim.Configuration) -> Stop:
    """Stop with the textbook controller."""
    assert config.drive is not None
    motor = config.drive.motor
    with hubsim.Plant(config, **_settings()) as plant:
        foc = Foc(
            motor.phase_resistance_ohm, motor.q_inductance_h, motor.flux_linkage_wb,
            motor.pole_pairs, motor.max_phase_current_a, plant.period_s,
        )  # fmt: skip
        now = plant.measure()
        while not plant.ended:
            speed = float(now.speed_rad_s[0])
            most = min(motor.max_torque_nm, motor.max_power_w / max(speed, 1e-3))
            share = min(1.0, max(0.0, speed / BLEND_OUT_RAD_S))
            electric = share * min(now.brake_demand_nm, most)
            duty = foc.step(
                now.phase_current_measured_a[0].tolist(), float(now.rotor_turn[0]),
                motor.pole_pairs * speed, now.bus_voltage_measured_v,
                foc.quadrature_current_a(-electric),
            )  # fmt: skip
            now = plant.step(duty, hydraulic_nm=now.brake_demand_nm - electric)
        return _result(plant)


def main() -> dict[str, Stop]:
    """Print and return both stops."""
    config = hubsim.load_configuration(DRIVE, QUARTER)
    found = {"firmware": with_firmware(config), "own": with_own(config)}
    for name, stop in found.items():
        print(
            f"{name:9} {100.0 * stop.stored:5.1f} % of the kinetic energy stored, "
            f"{stop.distance_m:.2f} m to standstill, "
            f"{stop.hydraulic_j:.0f} J in the hydraulic brake"
        )
    return found


if __name__ == "__main__":
    main()
