# SPDX-License-Identifier: Apache-2.0
"""The plant alone, for controllers of one's own: duties in, currents, voltages and speed out.

    plant = hubsim.Plant("lu2013", initial_speed_kmh=40.0, demand_nm=40.0, stop_at_standstill=True)
    now = plant.measure()
    while not plant.ended:
        duty = my_controller(now)           # shape (wheels, 3)
        now = plant.step(duty)              # one PWM period
    print(-plant["energy.chemical_j"])

Bridge, motor, bus, battery, temperatures, hydraulic brakes, vehicle, driver, sensors and accounts
are those that the firmware works with in ``hubsim.Bench``, so the same run with the same arguments
compares both.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from hubsim.configuration import Configuration
from hubsim.engine import library
from hubsim.errors import HubsimError
from hubsim.run.bench import Bench

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]

OFF, PWM, SHORT, SHORT_HIGH = 0, 1, 2, 3
_C_TYPES = {"double": "f8", "int32_t": "i4"}


class Measurement:
    """Everything at one instant, the boundary of two PWM periods; arrays have a row for each wheel.

    Motor signs: current into the motor is positive, torque is positive where it drives forward.
    ``seen`` is what the converters of the firmware's sensors show, with their resolution, noise and
    faults; everything else is the plant's truth.
    """

    __slots__ = ("_vehicle", "_wheels")

    def __init__(self, vehicle: Any, wheels: Any) -> None:  # noqa: ANN401, NumPy's records
        self._vehicle, self._wheels = vehicle, wheels

    @property
    def time_s(self) -> float:
        """Time since the run began, s."""
        return float(self._vehicle["time_s"])

    @property
    def speed_m_per_s(self) -> float:
        """Speed of the vehicle, m/s, positive forward."""
        return float(self._vehicle["speed_m_per_s"])

    @property
    def bus_voltage_v(self) -> float:
        """Voltage at the bridges, V."""
        return float(self._vehicle["bus_voltage_v"])

    @property
    def bus_voltage_measured_v(self) -> float:
        """The same as its converter shows it, V."""
        return float(self._vehicle["bus_voltage_measured_v"])

    @property
    def battery_voltage_v(self) -> float:
        """Voltage at the battery's terminals, V, mean of the last period."""
        return float(self._vehicle["battery_voltage_v"])

    @property
    def battery_current_a(self) -> float:
        """Current out of the battery, A, mean of the last period; charging is negative."""
        return float(self._vehicle["battery_current_a"])

    @property
    def drive_demand_nm(self) -> float:
        """Driver's drive demand at each driven wheel, N m."""
        return float(self._vehicle["drive_demand_nm"])

    @property
    def brake_demand_nm(self) -> float:
        """Driver's braking demand at each driven wheel, N m, >= 0."""
        return float(self._vehicle["brake_demand_nm"])

    @property
    def charge_limit_a(self) -> float:
        """What the battery management allows into the battery, A."""
        return float(self._vehicle["charge_limit_a"])

    @property
    def discharge_limit_a(self) -> float:
        """What the battery management allows out of the battery, A."""
        return float(self._vehicle["discharge_limit_a"])

    @property
    def enable(self) -> bool:
        """Whether the driver's switch is on."""
        return bool(self._vehicle["enable"])

    @property
    def anti_lock_at_work(self) -> bool:
        """Whether an anti-lock intervention requires zero motor torque."""
        return bool(self._vehicle["anti_lock_at_work"])

    @property
    def phase_current_a(self) -> Floats:
        """Currents in the wires, A, shape (wheels, 3)."""
        return self._of("phase_current_a")

    @property
    def phase_current_measured_a(self) -> Floats:
        """The same as the converters show them, A, shape (wheels, 3)."""
        return self._of("phase_current_measured_a")

    @property
    def rotor_turn(self) -> Floats:
        """Electrical angle of the rotors in turns, 0 to 1, shape (wheels,).

        0: d axis on phase a.
        """
        return self._of("rotor_turn")

    @property
    def speed_rad_s(self) -> Floats:
        """Mechanical speed of the wheels, rad/s, shape (wheels,)."""
        return self._of("speed_rad_s")

    @property
    def motor_torque_nm(self) -> Floats:
        """Airgap torque at this instant, N m, shape (wheels,)."""
        return self._of("motor_torque_nm")

    @property
    def hydraulic_torque_nm(self) -> Floats:
        """What the hydraulic brakes can hold now, N m, >= 0, shape (wheels,)."""
        return self._of("hydraulic_torque_nm")

    @property
    def winding_temperature_c(self) -> Floats:
        """Temperature of the windings, degC, shape (wheels,)."""
        return self._of("winding_temperature_c")

    @property
    def switch_temperature_c(self) -> Floats:
        """Temperature of the switches, degC, shape (wheels,)."""
        return self._of("switch_temperature_c")

    @property
    def hall_state(self) -> Integers:
        """State of the hall sensors: bit 0 = A, 1 = B, 2 = C, shape (wheels,)."""
        found: Integers = self._wheels["hall_state"]
        return found

    @property
    def encoder_count(self) -> Integers:
        """Counters of the encoders, four to a line, 0 to 65535, shape (wheels,); 0 without one."""
        found: Integers = self._wheels["encoder_count"]
        return found

    def _of(self, name: str) -> Floats:
        found: Floats = self._wheels[name]
        return found


class Plant:
    """One simulated vehicle for external controllers.

    Not for two threads at the same time. The firmware's controllers bring the vehicle to its
    initial speed without torque and are then taken away. From then on ``step`` is one PWM period.

    Parameters
    ----------
    drive, scenario, plant, settings
        As of ``hubsim.Bench``.
    delay_periods : int
        1: duties given to a step act in the period after it, as those of a microcontroller that
        needs the period for its computation (and as the firmware's do); 0: at once.
    """

    def __init__(
        self,
        drive: Configuration | str | Path | None = None,
        /,
        scenario: str | Path | None = None,
        *,
        plant: Mapping[str, float] | None = None,
        delay_periods: int = 1,
        **settings: Any,  # noqa: ANN401, whatever a scenario's keys take
    ) -> None:
        self._ffi, self._lib = library()
        self._bench = Bench(drive, scenario, plant=plant, record=(), **settings)
        self._engine = self._bench.engine
        self._engine.check(self._lib.hubsim_external_take(self._engine.handle, int(delay_periods)))
        self.wheels = int(self._lib.hubsim_external_wheels(self._engine.handle))
        self._commands = self._ffi.new("hubsim_command_t[]", self.wheels)
        self._command = _view(self._ffi, self._commands, "hubsim_command_t")
        self._vehicle = self._ffi.new("hubsim_vehicle_t *")
        self._wheels = self._ffi.new("hubsim_wheel_t[]", self.wheels)
        self._vehicle_view = _view(self._ffi, self._vehicle, "hubsim_vehicle_t")
        self._wheels_view = _view(self._ffi, self._wheels, "hubsim_wheel_t")
        self.ended = False
        self._bench.happen(0.0)
        self._due_s = self._bench.happens_next_s(0.0)

    def __enter__(self) -> Self:
        """Return the plant itself."""
        return self

    def __exit__(self, *arguments: object) -> None:
        """Free the vehicle now, not when the collector finds it."""
        self._bench.__exit__(*arguments)

    @property
    def period_s(self) -> float:
        """Length of a PWM period, s."""
        return self._bench.period_s

    @property
    def planned_s(self) -> float:
        """When the scenario is over, s; a vehicle that stands may end it before."""
        return self._bench.planned_s

    def measure(self) -> Measurement:
        """Return where everything is now."""
        self._engine.check(
            self._lib.hubsim_external_read(self._engine.handle, self._vehicle, self._wheels)
        )
        return Measurement(self._vehicle_view[0].copy(), self._wheels_view.copy())

    def step(
        self,
        duty: npt.ArrayLike,
        hydraulic_nm: npt.ArrayLike = 0.0,
        bridge: npt.ArrayLike = PWM,
    ) -> Measurement:
        """Go on for one PWM period and return where everything is then.

        Parameters
        ----------
        duty : array, shape (wheels, 3) or (3,)
            Share of the period in which the high side of each phase is on, 0 to 1; what lies
            outside is clamped, and all are rounded to the counts of the firmware's PWM timer.
        hydraulic_nm : float or array, shape (wheels,)
            Commands of the hydraulic brakes, N m, >= 0; effective with the next
            millisecond.
        bridge : int or array, shape (wheels,)
            ``PWM``; ``OFF``: all switches open, current flows through the diodes only; ``SHORT``:
            the three low sides closed; ``SHORT_HIGH``: the three high sides.

        Raises
        ------
        HubsimError
            When a number is not accepted, or the bus collapses. After the end nothing moves.
        """
        if self.ended:
            raise HubsimError("the run has ended, accepted: step() while not plant.ended")
        try:
            self._command["duty"] = duty
            self._command["hydraulic_nm"] = hydraulic_nm
            self._command["bridge"] = bridge
        except (TypeError, ValueError) as error:
            raise HubsimError(
                f"step: accepted: duty of shape ({self.wheels}, 3), hydraulic_nm and bridge "
                f"of shape ({self.wheels},) ({' '.join(str(error).split())})"
            ) from error
        status = self._lib.hubsim_external_step(self._engine.handle, self._commands)
        self._engine.check(status)
        now = self.measure()
        self.ended = status == self._lib.HUBSIM_ENDED or now.time_s >= self.planned_s - 1e-9
        if now.time_s >= self._due_s - 1e-9:
            self._bench.happen(now.time_s)
            self._due_s = self._bench.happens_next_s(now.time_s)
        return now

    def __getitem__(self, name: str) -> float:
        """Return a signal now, as ``hubsim.Bench`` does; those of a controller are constant."""
        return self._bench[name]

    def set(self, name: str, value: float) -> None:
        """Set a parameter of the simulated world from now on."""
        self._bench.set(name, value)

    def get(self, name: str) -> float:
        """Return a parameter of the simulated world."""
        return self._bench.get(name)


def _view(ffi: Any, memory: Any, name: str) -> Any:  # noqa: ANN401, of cffi
    """Return memory of the library as an array of one of external.h's structures."""
    names, formats, offsets = [], [], []
    for field, info in ffi.typeof(name).fields:
        shape, ctype = "", info.type
        if ctype.kind == "array":
            shape, ctype = str(ctype.length), ctype.item
        names.append(field)
        formats.append(f"{shape}{_C_TYPES[ctype.cname]}")
        offsets.append(info.offset)
    size = ffi.sizeof(name)
    record = {"names": names, "formats": formats, "offsets": offsets, "itemsize": size}
    return np.frombuffer(ffi.buffer(memory), dtype=np.dtype(record))  # type: ignore[call-overload]
