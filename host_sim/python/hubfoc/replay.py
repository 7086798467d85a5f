# SPDX-License-Identifier: Apache-2.0
"""``hubfoc replay``: what was recorded through the same C again, with these or other parameters.

Open loop: each controller gets what it got when it was recorded, so with other parameters its
outputs are what it would have commanded for these sensor values; no motor turned by them. Simulated
again: a vehicle that gets what came from outside then (demands, road, faults), closed loop.
"""

import argparse
import json
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from hubsim import configuration, files, steps
from hubsim import scenario as scenarios
from hubsim.engine import Steps
from hubsim.scenario import overrides
from regen_table import layout, schema, service_key
from regen_table.errors import ConfigurationError

from hubfoc.errors import HubfocError
from hubfoc.live.vehicle import BEFORE, POSITIONS, SimulatedVehicle
from hubfoc.recording import STEP_NAMES, Event, Group, Part, Recording, signal_columns

FAILED = 1
SHOWN_SIGNALS = 12
Parameters = Callable[[bytes], bytes]  # of a boot: from the recorded image to another
Compared = tuple[Part, Steps]  # what was recorded, and the same steps now


@dataclass(frozen=True)
class FirstDifference:
    """The first output that was another one; ``step`` counts the steps of its wheel."""

    wheel: str
    step: int
    kind: str
    time_s: float
    signal: str
    recorded: int
    replayed: int


@dataclass
class Comparison:
    """What a replay has found."""

    open_loop: bool
    simulated: bool
    fast_steps: int = 0
    slow_steps: int = 0
    inputs_complete: bool = True
    equal: bool = True
    first_difference: FirstDifference | None = None
    # Of each output that differed: by how much at most, raw.
    largest: dict[str, int] = field(default_factory=dict)

    def add(self, part: Part, replayed: Steps) -> None:
        """Compare the outputs of some steps."""
        kinds = part.steps["kind"]
        self.fast_steps += int(np.count_nonzero(kinds == steps.FAST))
        self.slow_steps += int(np.count_nonzero(kinds == steps.SLOW))
        found: list[FirstDifference] = []
        for kind in (steps.FAST, steps.SLOW):
            rows = np.flatnonzero(kinds == kind)
            columns = signal_columns(kind)
            for place in range(len(steps.inputs(kind)), len(columns)):
                recorded = part.steps["values"][rows, place].astype(np.int64)
                change = np.abs(replayed["values"][rows, place] - recorded)
                differs = np.flatnonzero(change)
                if len(differs) == 0:
                    continue
                name, row = columns[place], rows[differs[0]]
                self.largest[name] = max(self.largest.get(name, 0), int(change.max()))
                found.append(FirstDifference(
                    POSITIONS[part.wheel], int(part.numbers[row]), STEP_NAMES[kind],
                    float(part.time_s[row]), name, int(recorded[differs[0]]),
                    int(replayed["values"][row, place]),
                ))  # fmt: skip
        if found:
            self.equal = False
            first = min(found, key=lambda one: one.step)
            known = self.first_difference
            if known is None or first.time_s < known.time_s:
                self.first_difference = first


def parameters_of(image: bytes) -> Parameters:
    """Return what makes this image that of a wheel; each keeps its own position."""

    def changed(recorded: bytes) -> bytes:
        config: Any = layout.load().ffi.from_buffer("config_t *", recorded)
        position = int(config.vehicle.wheel_position)
        own = configuration.changed_image(image, {("vehicle", "wheel_position"): position})
        return service_key.with_key(own, None)

    return changed


def same_parameters(one: bytes, other: bytes) -> bool:
    """Return whether two images are the same but for name and key."""
    header = layout.load()
    begin, end = (header.ffi.offsetof("config_t", name) for name in ("motor", "crc32"))
    return one[begin:end] == other[begin:end]


def open_loop(recording: Recording, parameters: Parameters | None) -> Iterator[Compared]:
    """Run every wheel's steps again with the inputs that were recorded."""
    controllers: dict[int, steps.Replay] = {}
    for group in recording.groups():
        for part in group.parts:
            controller = controllers.setdefault(part.wheel, steps.Replay())
            yield part, _run(controller, part, parameters)


def _run(controller: steps.Replay, part: Part, parameters: Parameters | None) -> Steps:
    """Run a part, which may begin anew with other configurations in the middle."""
    begins = np.flatnonzero(part.steps["kind"] == steps.BOOT).tolist()
    pieces = [controller.run(part.steps[: begins[0] if begins else None])]
    for image, begin, end in zip(part.images, begins, [*begins, None][1:], strict=True):
        controller.configure(image if parameters is None else parameters(image))
        pieces.append(controller.run(part.steps[begin:end]))
    return np.concatenate(pieces)


class _Kept:
    """The log of a vehicle that is simulated again: its steps until they are taken."""

    def __init__(self) -> None:
        self._blocks: dict[int, list[Steps]] = {}

    def frame(self, millisecond: int, identifier: int, data: bytes) -> None:
        """Take no notice."""

    def changed(self, millisecond: int, parameter: str, value: float) -> None:
        """Take no notice."""

    def typed(self, millisecond: int, wheel: int, text: bytes) -> None:
        """Take no notice."""

    def stepped(self, millisecond: int, wheel: int, found: Steps, image: bytes | None) -> None:
        """Keep the steps."""
        del millisecond, image
        self._blocks.setdefault(wheel, []).append(found)

    def taken(self, wheel: int, count: int) -> Steps:
        """Return the next steps of a wheel, at most so many."""
        whole = np.concatenate(self._blocks[wheel])
        self._blocks[wheel] = [whole[count:]]
        return whole[:count]


def simulated(recording: Recording, parameters: Parameters | None) -> Iterator[Compared]:
    """Run the whole vehicle again with what came into it from outside."""
    if recording.path.suffix != ".parquet":
        raise HubfocError(f"{recording.path}: accepted with --simulate: a .parquet recording")
    origin, log = recording.provenance, _Kept()
    drives = [_drive(axle, recording.path) for axle in origin["axles"]]
    with _vehicle(drives, origin["scenario"], log, parameters) as vehicle:
        for group in recording.groups():
            _advance(vehicle, group)
            for part in group.parts:
                if part.numbers[0] > 0 and part.images:
                    raise HubfocError(
                        f"{recording.path}: {POSITIONS[part.wheel]} has booted again at"
                        f" {part.time_s[0]:.3f} s or later, accepted with --simulate: without"
                    )
                replayed = log.taken(part.wheel, len(part.steps))
                if not np.array_equal(replayed["kind"], part.steps["kind"]):
                    raise HubfocError(
                        f"{recording.path}: {POSITIONS[part.wheel]} makes other steps now, from"
                        f" {part.time_s[0]:.3f} s on"
                    )
                yield part, replayed


def _drive(origin: Mapping[str, Any], path: Path) -> schema.Drive:
    folder = Path(origin["folder"])
    try:
        data = tomllib.loads(origin["toml"])
        data.get("service", {}).pop("key", None)  # a file that need not be here
        drive = schema.parse(data, name=origin["drive"], source=str(path), beside=folder)
    except (ConfigurationError, tomllib.TOMLDecodeError) as error:
        raise HubfocError(f"{path}: {error}") from error
    return drive.found_in(folder)


def _vehicle(
    drives: Sequence[schema.Drive],
    scenario: str | None,
    log: _Kept,
    parameters: Parameters | None,
) -> SimulatedVehicle:
    if scenario is None:
        front, rear = drives[0], drives[1] if len(drives) > 1 else None
        return SimulatedVehicle(front, rear=rear, parameters=parameters, log=log)
    _, chosen, beside = scenarios.load(scenario, {}, drives[0])
    source = f"{chosen.source}: drive"
    own = [overrides.changed(drive, chosen.drive_changes, source) for drive in drives]
    return SimulatedVehicle(
        own[0], chosen, beside, rear=own[1] if len(own) > 1 else None, parameters=parameters,
        log=log,
    )  # fmt: skip


def _advance(vehicle: SimulatedVehicle, group: Group) -> None:
    """Let the milliseconds of a group pass, with what came from outside in each."""
    events: dict[int, list[Event]] = {}
    for event in group.events:
        events.setdefault(event.millisecond, []).append(event)
    seen = {int(k) for part in group.parts for k in np.unique(part.milliseconds)} - {BEFORE}
    for millisecond in sorted(seen):
        frames = []
        for event in events.get(millisecond, ()):
            if event.what == "frame":
                assert event.identifier is not None
                frames.append((event.identifier, event.data or b""))
            elif event.what == "changed":
                assert event.parameter is not None and event.value is not None
                vehicle.set(event.parameter, event.value)
            else:
                assert event.wheel is not None
                vehicle.serial_type(event.wheel, event.data or b"")
        vehicle.step(frames)


def compared(
    recording: Recording, parameters: Parameters | None, *, simulate: bool,
    take: Callable[[Part, Steps], None] | None = None,
) -> Comparison:  # fmt: skip
    """Replay a recording and compare all outputs with the recorded ones.

    Parameters
    ----------
    parameters : callable, optional
        Returns other parameters than those that a wheel booted with.
    simulate : bool
        The whole vehicle again; else each controller, with the inputs that it got.
    take : callable, optional
        Gets every part as it was recorded, and its steps now.
    """
    out = Comparison(open_loop=False, simulated=simulate)
    for part, replayed in (simulated if simulate else open_loop)(recording, parameters):
        if parameters is not None and not simulate:
            others = (not same_parameters(parameters(one), one) for one in part.images)
            out.open_loop = out.open_loop or any(others)
        out.add(part, replayed)
        if take is not None:
            take(part, replayed)
    return out


def in_words(found: Comparison, *, others: bool) -> str:
    """Return what was found, for a person."""
    what = f"{found.fast_steps} fast and {found.slow_steps} slow steps"
    if found.simulated:
        how = "simulated again, closed loop" + (", with other parameters" if others else "")
    elif found.open_loop:
        how = (
            "open loop, with other parameters: what the controllers would have commanded for these"
            " sensor values; no motor turned by it"
        )
    else:
        how = "with the recorded parameters"
    lines = [f"{what}, {how}"]
    first = found.first_difference
    if first is None:
        return "\n".join([*lines, "every output equal"])
    lines.append(
        f"first difference at {first.time_s:.6f} s, {first.wheel}, step {first.step}:"
        f" {first.signal} was {first.recorded}, is {first.replayed}"
    )
    for name in list(found.largest)[:SHOWN_SIGNALS]:
        lines.append(f"  {name} differs by at most {found.largest[name]}")
    return "\n".join(lines)


def run(options: argparse.Namespace) -> int:
    """Do ``hubfoc replay``."""
    recording = Recording(options.file)
    other = options.config and parameters_of(configuration.load(options.config).image)
    if options.json is not None:
        files.check_writable(options.json)
    found = compared(recording, other, simulate=options.simulate)
    print(in_words(found, others=other is not None))
    if options.json is not None:
        files.write_text(options.json, json.dumps(asdict(found), indent=1) + "\n")
    return FAILED if other is None and not found.equal else 0
