# SPDX-License-Identifier: Apache-2.0
"""A plant of one's own around the controller of one wheel, in a page.

A motor on a dynamometer that holds the speed.

    ./tools/dev python host_sim/python/examples/own_plant.py

The motor is three equations in the rotor's frame, amplitude-invariant, without iron loss:

    L di_d/dt = u_d - R i_d + w L i_q        L di_q/dt = u_q - R i_q - w (L i_d + psi)        T =
    3/2 p psi i_q

A bridge that is on applies duty times bus voltage, one period after its computation; a
bridge that is off carries no current, because at this speed the back-EMF stays below the bus
voltage.
"""

from dataclasses import dataclass

import hubsim
import numpy as np
from hubsim.engine import ROOT

DRIVE = ROOT / "tools" / "motors" / "lu2013.toml"
# Effects without a model in this plant are switched off in the controller as well; an angle sensor
# instead of halls.
SIMPLE = {
    "motor.iron_loss_resistance_ohm": None,
    "inverter.dead_time_s": 0.0,
    "rotor.sensor": "angle",
}
BUS_V = 53.0
PWM = 1.0


@dataclass
class Motor:
    """Phase currents in A (peak) and angle in rad of a motor that turns at ``speed_rad_s``."""

    resistance_ohm: float
    inductance_h: float
    flux_wb: float
    pole_pairs: int
    speed_rad_s: float
    i: complex = 0j  # d + j q
    angle_rad: float = 0.0

    @property
    def torque_nm(self) -> float:
        """Airgap torque."""
        return 1.5 * self.pole_pairs * self.flux_wb * float(self.i.imag)

    def phases_a(self) -> list[float]:
        """Return the three phase currents."""
        return [
            float((self.i * np.exp(1j * (self.angle_rad - k * 2.0 * np.pi / 3.0))).real)
            for k in range(3)
        ]

    def step(self, duty: list[float] | None, duration_s: float, pieces: int = 5) -> None:
        """Go on for a time with duties (1) of the three phases, or with the bridge off."""
        omega, tau = self.pole_pairs * self.speed_rad_s, duration_s / pieces
        for _ in range(pieces):
            self.angle_rad += omega * tau
            if duty is None:
                self.i = 0j
                continue
            stator_v = (
                2.0
                / 3.0
                * BUS_V
                * sum(d * np.exp(2j * np.pi * k / 3.0) for k, d in enumerate(duty))
            )
            u = stator_v * np.exp(-1j * (self.angle_rad - 0.5 * omega * tau))
            slope = (
                u
                - self.resistance_ohm * self.i
                - 1j * omega * (self.inductance_h * self.i + self.flux_wb)
            )
            self.i += slope * tau / self.inductance_h


def main(
    speed_rad_s: float = 20.0, brake_nm: float = 20.0, duration_s: float = 0.5
) -> tuple[float, float]:
    """Brake for a while; print and return the motor's torque and the controller's estimate, N m."""
    config = hubsim.load_configuration(DRIVE, SIMPLE)
    assert config.drive is not None
    m = config.drive.motor
    motor = Motor(
        m.phase_resistance_ohm, m.q_inductance_h, m.flux_linkage_wb, m.pole_pairs, speed_rad_s
    )
    controller = hubsim.Controller(config)
    per_ms = round(1e-3 / controller.period_s)
    duty, slow = None, None
    for n in range(round(duration_s / controller.period_s)):
        if n % per_ms == 0:
            braking = slow is not None and controller.mode_text(slow.mode) == "RUN"
            slow = controller.slow_step(
                enable=n > 100 * per_ms, brake_torque_nm=brake_nm if braking else 0.0
            )
        a, b, c = motor.phases_a()
        turn = motor.angle_rad / (2.0 * np.pi)
        fast = controller.fast_step(
            phase_a_a=a, phase_b_a=b, phase_c_a=c, bus_voltage_v=BUS_V, rotor_angle_turn=turn
        )
        motor.step(duty, controller.period_s)  # duty of the previous period
        duty = [fast.duty_a, fast.duty_b, fast.duty_c] if fast.bridge == PWM else None
    assert slow is not None
    print(
        f"mode {controller.mode_text(slow.mode)}, limit: "
        f"{controller.reason_text(slow.torque_reason)}"
    )
    print(
        f"motor {motor.torque_nm:.3f} N m, controller's estimate "
        f"{slow.motor_torque_estimate_nm:.3f} N m"
    )
    print(f"hydraulic brake command {slow.hydraulic_torque_nm:.3f} N m")
    return motor.torque_nm, slow.motor_torque_estimate_nm


if __name__ == "__main__":
    main()
