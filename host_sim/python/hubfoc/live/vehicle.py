# SPDX-License-Identifier: Apache-2.0
"""The simulated vehicle behind a bus: whole applications, plant, battery management and brakes."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, Self

from hubsim import can_protocol, configuration, engine, run, steps
from hubsim.engine import Rows, Steps
from hubsim.run import axles
from hubsim.scenario import Scenario
from regen_table import layout, service_key
from regen_table.schema import Drive

from hubfoc.bus import Frame

POSITIONS = ("front_left", "front_right", "rear_left", "rear_right")
FRONT_WHEELS = 2
STEP_S = 1e-3  # of simulated time between two looks at the bus
DRY_ROAD = 1.0
LEAST_BUS_F = 1e-4
BEFORE = -1  # the millisecond of all steps before time 0
NOBODY_DRIVES = Scenario(
    description="a vehicle that stands and is driven by what comes by CAN",
    initial_speed_kmh=0.0,
    boots_rolling=True,
    max_duration_s=1.0,  # of which nobody here takes notice
)


def _changeable(drive: Drive, rear: Drive | None) -> dict[str, float]:
    """Return what must be there from the start, so that it can be changed or break later on."""
    boards_f = [axle.inverter.bus_capacitance_f for axle in (drive, rear or drive)]
    capacitance_f = drive.vehicle.driven_wheels * sum(boards_f) / len(boards_f)
    slips = drive.chassis.wheel_inertia_kg_m2 > 0.0
    return {
        "bus.capacitance_f": max(LEAST_BUS_F, capacitance_f),
        "road.friction": DRY_ROAD if slips else 0.0,
        "driver.front_bias": axles.brake_bias(drive, rear or drive),  # of the brakes' own path
    }


class LiveVehicle(Protocol):
    """Wheels that are heard a millisecond at a time: simulated ones, or real ones on a bus."""

    @property
    def wheels(self) -> int:
        """How many."""

    @property
    def wheel_radius_m(self) -> float:
        """Of all wheels."""

    @property
    def time_s(self) -> float:
        """Since the start."""

    @property
    def ended(self) -> bool:
        """Whether nothing comes any more."""

    def step(self, received: Sequence[Frame]) -> list[Frame]:
        """Go on by ``STEP_S`` with what came by the bus; return what the vehicle sent."""

    def meanings(self) -> dict[str, tuple[str, str]]:
        """Return unit and meaning of every signal by name."""

    def choose(self, signals: Sequence[str]) -> None:
        """Choose what ``sample`` takes."""

    def sample(self, row: Rows) -> None:
        """Write the chosen signals now into ``row``."""

    def serial_take(self, wheel: int) -> bytes:
        """Return what a wheel's shell wrote."""

    def serial_type(self, wheel: int, text: bytes) -> None:
        """Type into a wheel's shell."""

    def packet_send(self, wheel: int, packet: bytes) -> None:
        """Give a wheel a packet of the service protocol, beside CAN."""

    def packets_take(self, wheel: int) -> list[bytes]:
        """Return the packets of the service protocol that a wheel sent."""


class Log(Protocol):
    """Who is told everything that goes into a vehicle, in the millisecond in which it does."""

    def frame(self, millisecond: int, identifier: int, data: bytes) -> None:
        """Take a frame from outside."""

    def changed(self, millisecond: int, parameter: str, value: float) -> None:
        """Take a parameter of the simulated world."""

    def typed(self, millisecond: int, wheel: int, text: bytes) -> None:
        """Take what was typed into a wheel's shell."""

    def stepped(self, millisecond: int, wheel: int, found: Steps, image: bytes | None) -> None:
        """Take the steps of a wheel's controller; ``image`` with a boot among them."""


class SimulatedVehicle:
    """Four wheels (or as many as the drive has) that see a bus and are seen on it.

    Without a scenario nobody in the simulation sends a demand; the brake system hears the demands
    that others send, as a real one does, and takes its own path where a wheel hands over.

    ``key`` opens the lock of XCP in every wheel: that of the drive, else one drawn for this run.
    ``rear``: of the wheels of the rear axle, where they differ. ``parameters``: returns another
    image of the controllers than a drive's. ``log``: takes what goes in, and the controllers'
    steps.
    """

    def __init__(
        self, drive: Drive, scenario: Scenario | None = None, beside: Path = Path(),
        key: bytes | None = None, rear: Drive | None = None,
        parameters: Callable[[bytes], bytes] | None = None, log: Log | None = None,
    ) -> None:  # fmt: skip
        self._base = drive.vehicle.can_base
        self.service_base = drive.service.can_base
        self._driven = scenario is not None
        self.rotor_sensors = {axle.rotor.sensor for axle in (drive, rear or drive)}
        chosen = scenario if scenario is not None else NOBODY_DRIVES
        own_key = key or service_key.of(drive) or service_key.draw()
        self.key = own_key

        def image_of(axle: Drive) -> bytes:
            image = configuration.image_of(axle)
            own = image if parameters is None else parameters(image)
            return service_key.with_key(own, own_key)

        self._engine, planned_s = run.prepare(
            drive, chosen, beside, {} if self._driven else _changeable(drive, rear), rear, image_of
        )
        self._engine.attach_application(engine.application_path())
        self._log, self._milliseconds = log, 0
        if log is not None:
            self._engine.record()
        if not self._driven:
            self._engine.set("driver.silent", 1.0)
        self._engine.start()
        self.wheels = int(self._engine.get("vehicle.driven_wheels"))
        self.wheel_radius_m = self._engine.get("vehicle.wheel_radius_m")
        self._read_steps(BEFORE)
        self._happening = run.timeline(chosen, beside)
        self.time_s = 0.0
        self._end_s = planned_s if self._driven else math.inf

    def __enter__(self) -> Self:
        """Return the vehicle itself."""
        return self

    def __exit__(self, *exc: object) -> None:
        """Free it."""
        self._engine.__exit__(*exc)

    @property
    def ended(self) -> bool:
        """Whether the scenario has come to its end."""
        return self._engine.ended or self.time_s >= self._end_s

    def step(self, received: Sequence[Frame]) -> list[Frame]:
        """Go on by ``STEP_S`` with what came by the bus; return what the vehicle sent."""
        for identifier, data in received:
            if self._log is not None:
                self._log.frame(self._milliseconds, identifier, data)
            self._engine.bus_send(identifier, data)
            if not self._driven:
                self._hear(identifier, data)
        self._happening.apply(self._engine, self.time_s)
        self._engine.advance(self.time_s + STEP_S)
        self._read_steps(self._milliseconds)
        self._milliseconds += 1
        self.time_s = self._engine.value("time_s")
        return self._engine.bus_read()

    def end_log(self) -> None:
        """Tell the log nothing more."""
        self._log = None
        self._engine.record_end()

    def _read_steps(self, millisecond: int) -> None:
        if self._log is None:
            return
        for wheel in range(self.wheels):
            found = self._engine.steps_read(wheel)
            image = None
            if (found["kind"] == steps.BOOT).any():
                whole = self._engine.steps_config(wheel, layout.load().size_bytes)
                image = service_key.with_key(whole, None)  # a key is in no recording
            self._log.stepped(millisecond, wheel, found, image)

    def _hear(self, identifier: int, data: bytes) -> None:
        """Tell the brake system what was last demanded of any wheel, in its axle's share."""
        if can_protocol.message_of(identifier, self._base) != "Demand":
            return
        profile = can_protocol.MESSAGES["Demand"].profile
        values = can_protocol.decode("Demand", data)
        if values is not None and can_protocol.intact(profile, data, identifier):
            bias = self._engine.get("driver.front_bias")
            share = (
                1.0 + bias if identifier & can_protocol.WHEEL_MASK < FRONT_WHEELS else 1.0 - bias
            )
            self._engine.set("driver.brake_demand_nm", values["brake_torque_nm"] / share)

    def packet_send(self, wheel: int, packet: bytes) -> None:
        """Give a wheel a packet of the service protocol."""
        self._engine.packet_send(wheel, packet)

    def packets_take(self, wheel: int) -> list[bytes]:
        """Return the packets of the service protocol that a wheel sent."""
        return self._engine.packets_take(wheel)

    def serial_take(self, wheel: int) -> bytes:
        """Return what a wheel's shell wrote."""
        return self._engine.serial_take(wheel)

    def serial_type(self, wheel: int, text: bytes) -> None:
        """Type into a wheel's shell."""
        if self._log is not None:
            self._log.typed(self._milliseconds, wheel, text)
        self._engine.serial_type(wheel, text)

    def set(self, parameter: str, value: float) -> None:
        """Change a parameter of the simulated world (``hubsim list --parameters``)."""
        self._engine.set(parameter, value)
        if self._log is not None:
            self._log.changed(self._milliseconds, parameter, value)

    def meanings(self) -> dict[str, tuple[str, str]]:
        """Return unit and meaning of every signal by name."""
        return self._engine.meanings()

    def choose(self, signals: Sequence[str]) -> None:
        """Choose what ``sample`` takes."""
        self._engine.choose(signals)

    def sample(self, row: Rows) -> None:
        """Write the chosen signals now into ``row``; rates are means since the row before."""
        self._engine.sample(row)

    def get(self, parameter: str) -> float:
        """Return a parameter of the simulated world."""
        return self._engine.get(parameter)

    def value(self, signal: str) -> float:
        """Return a signal of the simulation (``hubsim list --signals``)."""
        return self._engine.value(signal)
