# SPDX-License-Identifier: Apache-2.0
"""What the pages in the browser work with, beside the vehicle: pedals, history, findings, limits.

All but ``History.rows`` and ``History.latest`` belongs to the thread that steps the vehicle.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from typing import Any

from hubsim import engine, reasons
from hubsim.scenario import cycles
from regen_table.schema import Drive

from hubfoc import measuring
from hubfoc.bus import Frame, join
from hubfoc.client import WHEELS
from hubfoc.errors import HubfocError
from hubfoc.live import scopes
from hubfoc.live.clock import Clock
from hubfoc.live.cockpit import Cockpit
from hubfoc.live.findings import Findings
from hubfoc.live.history import DRAWN, RETURNED, History
from hubfoc.live.limits import Inquiry, texts
from hubfoc.live.replays import signals
from hubfoc.live.world import LiveWorld, World
from hubfoc.live.xcp import Gateways
from hubfoc.service import Can, Service, Udp

OF_WHEEL = (
    *("motor_torque_nm", "hydraulic_torque_nm", "speed_rad_per_s", "available_nm"),
    *("drive_available_nm", "reason", "mode", "fault_reason", "warning_reason", "waits_for"),
    *("winding_temperature_c",),
)
OF_VEHICLE = (
    *("vehicle.speed_m_per_s", "battery.soc", "battery.voltage_v", "battery.current_a"),
    *(DRAWN, RETURNED, "energy.shaft_j", "energy.copper_j", "energy.iron_j"),
    *("energy.conduction_j", "energy.diode_j", "energy.switching_j", "energy.hydraulic_j"),
    *("energy.battery_j", "energy.bearing_j"),
)
MODES = range(8)
REAR = 2  # the first wheel of the rear axle
RECORDED_MS = 120_000  # of a recording that a page has begun


class Desk:
    """The pages' side of one live vehicle."""

    def __init__(
        self, world: LiveWorld, clock: Clock, gateways: Gateways | None = None,
        channel: str | None = None,
    ) -> None:  # fmt: skip
        self.world = world
        self._channel = channel  # of real wheels
        self._gateways = gateways
        self._clock = clock
        self.cockpit = Cockpit(world.drive, world.rear)
        self.inquiry = Inquiry()
        self._wheels_of: dict[object, int] = {}
        world.scenarios()
        self.begin()

    def begin(self) -> None:
        """Start with the world's present vehicle."""
        vehicle = self.world.vehicle
        self.number = self.world.number  # first: rows are of the number that a page knows
        self.history = History(vehicle)
        self.findings = Findings(self.history, vehicle.wheels)
        self.inquiry.begin()
        self.cockpit.begin()
        names = [f"wheel{k}.{name}" for k in range(vehicle.wheels) for name in OF_WHEEL]
        self.shown = [n for n in (*names, *OF_VEHICLE) if n in self.history.meanings]

    @property
    def simulation(self) -> World:
        """The world, if it is a simulated one."""
        if not isinstance(self.world, World):
            raise HubfocError("these wheels are real, accepted: of a virtual vehicle")
        return self.world

    def drive_of(self, wheel: int) -> Drive:
        """Return what drives a wheel."""
        rear = self.world.rear
        return rear if rear is not None and wheel >= REAR else self.world.drive

    def address(self, wheel: int) -> str:
        """Return where XCP reaches a wheel."""
        if self._gateways is None or not self._gateways.wheels:
            raise HubfocError("this drive has no XCP, accepted: one with [service] can_base")
        return self._gateways.wheels[wheel].address

    def session(self, wheel: int) -> Service:
        """Return a session of XCP with a wheel: of a real one by CAN."""
        if not self.world.real:
            return Service(Udp(self.address(wheel)))
        base = self.drive_of(wheel).service.can_base
        if self._channel is None or base == 0:
            raise HubfocError("this drive has no XCP, accepted: one with [service] can_base")
        return Service(Can(join(self._channel), base, wheel))

    def shell(self, wheel: int, command: str) -> Future[str]:
        """Ask a wheel's shell; its answer comes while the vehicle goes on."""
        if self.world.real:
            raise HubfocError("a real wheel's shell is on its serial line, accepted: the log of a"
                              " terminal there")  # fmt: skip
        return self.inquiry.command(wheel, command, self.world.time_s)

    def before(self, received: Sequence[Frame]) -> list[Frame]:
        """Return the frames of the pages for this millisecond."""
        if self.number != self.world.number:
            self.begin()
        silent = self.world.faults.silences or self.world.scenario is not None
        return self.cockpit.frames(self.world.time_s, received, silent=silent)

    def after(self) -> None:
        """Take notice of what the millisecond has brought."""
        world = self.world
        if isinstance(world, World) and world.records_itself and world.recorded_ms >= RECORDED_MS:
            world.stop_recording()
        row = self.history.record(self.world.vehicle)
        self.findings.look(self.world.time_s, row, self.world.faults.active)
        if not self.world.real:
            self.inquiry.ask(self.world.vehicle)

    def hello(self) -> dict[str, Any]:
        """Return what does not change as long as this vehicle is the same."""
        world = self.world
        return {
            "kind": "hello",
            "number": self.number,
            "vehicle": ", ".join(drive.name for drive in (world.drive, world.rear) if drive),
            "wheels": list(WHEELS[: world.vehicle.wheels]),
            "wheel_radius_m": world.vehicle.wheel_radius_m,
            "real": world.real,
            "demands": world.demands,
            "drive_nm": self.cockpit.drive_nm,
            "brake_nm": self.cockpit.brake_nm,
            "hydraulic_nm": world.drive.brake.max_hydraulic_torque_nm,
            "top_speed_kmh": world.drive.motor.max_speed_rpm
            * 0.10471975512
            * world.vehicle.wheel_radius_m
            * cycles.KMH_PER_M_PER_S,
            "signals": {name: list(meaning) for name, meaning in self.history.meanings.items()},
            "shown": self.shown,
            "reasons": {
                str(code): [name, engine.reason_text(code)]
                for name, code in reasons.codes().items()
            },
            "modes": [engine.mode_text(mode) for mode in MODES],
            "waits_for": {str(k): reasons.waits_for(k) for k in range(32)},
            "limits": texts(),
            "commands": signals(),
            "scope": scopes.signals(),
            "triggers": measuring.KINDS,
            "faults": world.fault_list(),
            "scenarios": world.scenarios(),
        }

    def state(self, page: object) -> dict[str, Any]:
        """Return what changes slowly, for one page."""
        if self.number != self.world.number:
            self.begin()  # else this were the new vehicle's state under the old one's number
        cockpit, wheel = self.cockpit, self._wheels_of.get(page, 0)
        controls = (
            "own"
            if cockpit.owner is page
            else "another page"
            if cockpit.owner is not None
            else "another sender"
            if cockpit.foreign
            else "free"
        )
        return {
            "kind": "state",
            "number": self.number,
            "controls": controls,
            **self.world.state(),
            "limits": self.inquiry.shown(wheel, self.history.cost_j[wheel]),
            "findings": self.findings.shown(),
            "health": self._clock.health(),
        }

    def do(self, page: object, wanted: Mapping[str, Any]) -> None:
        """Do what a page wants."""
        what = wanted.get("do")
        if what == "take":
            if not self.world.demands:
                raise HubfocError("real wheels, accepted: after hubfoc live --allow-demand")
            self.cockpit.take(page)
        elif what == "release":
            self.cockpit.release(page)
        elif what == "drive":
            self.cockpit.drive(
                page, float(wanted["accelerator"]), float(wanted["brake"]),
                str(wanted["direction"]),
            )  # fmt: skip
        elif what == "acknowledge":
            self.cockpit.acknowledge(page)
            self.findings.acknowledge(self.world.time_s)
        elif what == "change":
            self.cockpit.check(page)
            self.world.change(dict(wanted["change"]))
        elif what == "wheel":
            self._wheels_of[page] = int(wanted["wheel"]) % self.world.vehicle.wheels
            self.inquiry.wanted = set(self._wheels_of.values())
        else:
            raise HubfocError(f"{what!r} is not accepted")

    def arrive(self, page: object) -> None:
        """Take notice of another page, which gets the controls if they are free."""
        self._wheels_of[page] = 0
        self.inquiry.wanted = set(self._wheels_of.values())
        if self.cockpit.owner is None and not self.cockpit.foreign and not self.world.real:
            self.cockpit.take(page)

    def leave(self, page: object) -> None:
        """Forget a page that is gone."""
        self.cockpit.release(page)
        self._wheels_of.pop(page, None)
        self.inquiry.wanted = set(self._wheels_of.values())
