# SPDX-License-Identifier: Apache-2.0
"""The firmware with a motor model of motulator.

motulator's synchronous machine and solver, hubfoc's controller.

    ./tools/dev python host_sim/python/examples/motulator_motor.py

motulator (PyPI) simulates a drive as a continuous-time model and a discrete-time control system
that is called once per sampling period. The firmware takes the place of that control system. Held
at one speed, the commanded torque, the estimated torque, the
torque of motulator's machine and that of hubfoc's own plant have to be the same.
"""

from types import SimpleNamespace

import hubsim
import numpy as np
from hubsim.engine import ROOT
from motulator.drive import model
from motulator.drive.utils import SynchronousMachinePars

DRIVE = ROOT / "tools" / "motors" / "lu2013.toml"
BUS_V = 53.0
# motulator's machine has no iron loss and its converter neither dead time nor resistance. So that
# plant and belief agree:
IDEAL = {
    "motor.iron_loss_resistance_ohm": None,
    "inverter.dead_time_s": 0.0,
    "inverter.switch_resistance_ohm": 0.0,
    "battery.series_resistance_ohm": 1e-6,
    "battery.polarisation_resistance_ohm": 1e-6,
    "battery.open_circuit_voltage_v": BUS_V,
    "rotor.sensor": "angle",
}
POINTS = ((10.0, 20.0), (40.0, 35.0))  # mechanical speed in rad/s, braking demand in N m
BOOT_S = 0.3
SETTLE_S = 0.15


class Firmware:
    """motulator's idea of a control system.

    Called with the model, it returns the sampling period and three duties.
    """

    def __init__(
        self, config: hubsim.Configuration, pole_pairs: int, speed_rad_s: float, brake_nm: float
    ) -> None:
        self.controller = hubsim.Controller(config)
        self.period_s, self.brake_nm, self.calls = self.controller.period_s, brake_nm, 0
        self.per_ms = round(1e-3 / self.period_s)
        self.slow = self.controller.slow_step(enable=False)
        self.data = SimpleNamespace(torque_nm=[])
        self._boot(pole_pairs, speed_rad_s)

    def _boot(self, pole_pairs: int, speed_rad_s: float) -> None:
        """Let the controller calibrate and find the turning rotor with the bridge off.

        motulator has no model of that bridge.
        """
        turns_per_period = pole_pairs * speed_rad_s / (2.0 * np.pi) * self.period_s
        periods = round(BOOT_S / self.period_s)
        for n in range(-periods, 0):
            if n % self.per_ms == 0:
                self.slow = self.controller.slow_step(enable=n > -periods // 3)
            self.controller.fast_step(bus_voltage_v=BUS_V, rotor_angle_turn=n * turns_per_period)

    def __call__(self, mdl: model.Drive) -> tuple[float, list[float]]:
        """Sample, step, and hand over the duties.

        Motulator delays them by one period, as the timer does.
        """
        if self.calls % self.per_ms == 0:
            self.slow = self.controller.slow_step(enable=True, brake_torque_nm=self.brake_nm)
            self.data.torque_nm.append(mdl.machine.tau_M)
        self.calls += 1
        a, b, c = mdl.machine.meas_currents()
        turn = float(np.angle(mdl.machine.state.exp_j_theta_m)) / (2.0 * np.pi)
        fast = self.controller.fast_step(
            phase_a_a=a,
            phase_b_a=b,
            phase_c_a=c,
            bus_voltage_v=mdl.converter.meas_dc_voltage(),
            rotor_angle_turn=turn,
        )
        return self.period_s, [fast.duty_a, fast.duty_b, fast.duty_c]

    def post_process(self) -> None:
        """Do nothing; called at the end of a simulation."""


def on_motulator(
    config: hubsim.Configuration, speed_rad_s: float, brake_nm: float
) -> dict[str, float]:
    """Return the torques in N m that remain at a speed and demand.

    ``command``, ``estimate``, ``motulator``.
    """
    assert config.drive is not None
    m = config.drive.motor
    parameters = SynchronousMachinePars(
        n_p=m.pole_pairs,
        R_s=m.phase_resistance_ohm,
        L_d=m.d_inductance_h,
        L_q=m.q_inductance_h,
        psi_f=m.flux_linkage_wb,
    )
    mdl = model.Drive(
        converter=model.VoltageSourceConverter(u_dc=BUS_V),
        machine=model.SynchronousMachine(parameters),
        mechanics=model.ExternalRotorSpeed(w_M=lambda t: speed_rad_s + 0.0 * t),
    )
    firmware = Firmware(config, m.pole_pairs, speed_rad_s, brake_nm)
    mdl.delay.data = [[0.5, 0.5, 0.5]]  # the bridge's first period: no voltage between the phases
    model.Simulation(mdl, firmware).simulate(t_stop=SETTLE_S)
    last = firmware.data.torque_nm[-20:]
    return {
        "command": firmware.slow.motor_torque_command_nm,
        "estimate": firmware.slow.motor_torque_estimate_nm,
        "motulator": float(np.mean(last)),
    }


def on_bench(config: hubsim.Configuration, speed_rad_s: float, brake_nm: float) -> float:
    """Return the torque in N m of hubfoc's own plant there.

    A vehicle this heavy keeps its speed.
    """
    assert config.drive is not None
    speed_kmh = 3.6 * speed_rad_s * config.drive.vehicle.wheel_radius_m
    with hubsim.Bench(
        config,
        plant={"vehicle.mass_kg": 1e6},
        record=("wheel0.motor_torque_nm",),
        initial_speed_kmh=speed_kmh,
        demand_nm=brake_nm,
        drag=False,
    ) as bench:
        return float(np.mean(bench.run(SETTLE_S)["wheel0.motor_torque_nm"][-3:]))


def main(points: tuple[tuple[float, float], ...] = POINTS) -> list[dict[str, float]]:
    """Print and return the torques of every point in N m."""
    config = hubsim.load_configuration(DRIVE, IDEAL)
    found = []
    for speed_rad_s, brake_nm in points:
        torques = on_motulator(config, speed_rad_s, brake_nm) | {
            "bench": on_bench(config, speed_rad_s, brake_nm)
        }
        listing = ", ".join(f"{name} {torque:.3f}" for name, torque in torques.items())
        print(f"{speed_rad_s:g} rad/s, brake {brake_nm:g} N m: {listing} N m")
        found.append(torques)
    return found


if __name__ == "__main__":
    main()
