# SPDX-License-Identifier: Apache-2.0
"""The C engine as a Python object.

Parameters, configuration and signals by name, rows as NumPy arrays.

The declarations are read from the library's own headers (bench/engine.h,
exchange/controller_api.h, application/steps.h), so this module cannot disagree with them. Calls
into the engine release the interpreter's lock: runs in several threads use several cores.
"""

import os
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt
from regen_table import declarations, installation

from hubsim.errors import HubsimError
from hubsim.iron import MORE_COEFFICIENTS, Iron

if TYPE_CHECKING:
    import cffi

# The repository, or the copies of its files that an installed distribution carries.
ROOT = installation.ROOT
HEADERS = (
    ROOT / "host_sim" / "bench" / "include" / "bench" / "engine.h",
    ROOT / "host_sim" / "bench" / "include" / "bench" / "external.h",
    ROOT / "host_sim" / "exchange" / "include" / "exchange" / "controller_api.h",
    ROOT / "host_sim" / "application" / "include" / "application" / "steps.h",
)
LIBRARY = Path("host_sim") / "libhubsim_engine.so"
APPLICATION = Path("host_sim") / "libhubsim_application.so"
_BUILT_IN = Path(__file__).resolve().parent / LIBRARY.name
_NAME_BYTES = 96
_FRAMES = 512  # more than a millisecond of any bus has
_SERIAL_BYTES = 4096
_PACKETS_BYTES = 1 << 16  # more than a wheel sends in 20 ms
_MOST_CODE = 2**31 - 1  # a bit that flipped makes a code beyond what the library takes

Rows = npt.NDArray[np.float64]
# hubsim_step_t (application/steps.h).
STEP_VALUES = 56
STEP = np.dtype([("kind", "<i2"), ("reports", "<i2"), ("values", "<i4", (STEP_VALUES,))])
Steps = npt.NDArray[np.void]
_STEPS = 256  # read at once: more than a millisecond has


def _built(library: Path) -> Path:
    named = os.environ.get("HUBFOC_BUILD_DIR")
    return Path(named) / library if named else ROOT / "build" / "host" / library


def application_path() -> Path:
    """Return where the whole application is as a library."""
    if installation.INSTALLED:
        return _BUILT_IN.with_name(APPLICATION.name)
    path = _built(APPLICATION)
    if not path.is_file():
        raise HubsimError(
            f"{path}: the application is not built, './tools/dev hubsim run SCENARIO --on board' "
            "builds it (or 'cmake --build --preset host --target hubsim_application')"
        )
    return path


def library_path() -> Path:
    """Return where the engine is.

    Beside this module in an installed distribution; in the repository under ``HUBFOC_BUILD_DIR`` if
    that is set, else under build/host.
    """
    if installation.INSTALLED:
        return _BUILT_IN
    path = _built(LIBRARY)
    if not path.is_file():
        raise HubsimError(
            f"{path}: the simulation engine is not built, accepted: after 'cmake --build --preset "
            "host'"
        )
    return path


@cache
def library() -> tuple["cffi.FFI", Any]:
    """Declare and open the library, once in a process."""
    text = "\n".join(header.read_text(encoding="utf-8") for header in HEADERS)
    ffi = declarations.known(re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE))
    path = library_path()
    try:
        return ffi, ffi.dlopen(str(path))
    except OSError as error:
        raise HubsimError(f"{path}: cannot be loaded: {' '.join(str(error).split())}") from error


def text_of(chars: Any) -> str:  # noqa: ANN401, cffi's types have no public names
    """Return a text of the library."""
    raw = library()[0].string(chars)
    assert isinstance(raw, bytes)
    return raw.decode("ascii")


class Engine:
    """One simulated vehicle. Not for two threads at the same time."""

    def __init__(self) -> None:
        self._ffi, self._lib = library()
        handle = self._lib.hubsim_new()
        if handle == self._ffi.NULL:
            raise HubsimError("no memory for a simulated vehicle")
        self._sim = self._ffi.gc(handle, self._lib.hubsim_delete)
        self._chosen: list[str] = []
        self._packets = self._ffi.new("unsigned char[]", _PACKETS_BYTES)
        # Where the library writes an answer; runs of a millisecond ask thousands of times a second.
        self._number = self._ffi.new("double *")
        self._written = self._ffi.new("int64_t *")
        self.ended = False

    def __enter__(self) -> Self:
        """Return the engine itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Free the vehicle now, not when the collector finds it."""
        self._ffi.release(self._sim)

    def set(self, name: str, value: float) -> None:
        """Set a parameter, before the run or during it."""
        self._check(self._lib.hubsim_set(self._sim, name.encode(), float(value)))

    def get(self, name: str) -> float:
        """Return a parameter."""
        if self._lib.hubsim_get(self._sim, name.encode(), self._number) != self._lib.HUBSIM_OK:
            raise HubsimError(f"{name}: no such parameter")
        return float(self._number[0])

    def set_voltage_curve(self, soc: Sequence[float], voltage_v: Sequence[float]) -> None:
        """Set the battery's open-circuit voltage (V) over state of charge (0 to 1, rising).

        One point: constant.
        """
        self._check(self._lib.hubsim_set_voltage_curve(self._sim, *self._points(soc, voltage_v)))

    def set_energy_map(self, iron: Iron) -> None:
        """Set what the iron of every motor adds to its inductances, before ``start``."""
        coefficient_j = self._ffi.new("double[]", iron.coefficient_j.ravel().tolist())
        map_of = {
            "d_first_wb": iron.d_first_wb,
            "d_step_wb": iron.d_step_wb,
            "q_first_wb": iron.q_first_wb,
            "q_step_wb": iron.q_step_wb,
            "d_cells": iron.coefficient_j.shape[0] - MORE_COEFFICIENTS,
            "q_cells": iron.coefficient_j.shape[1] - MORE_COEFFICIENTS,
            "coefficient_j": coefficient_j,
        }
        found = self._ffi.new("hubsim_energy_map_t *", map_of)
        self._check(self._lib.hubsim_set_energy_map(self._sim, found))

    def set_trace(self, time_s: Sequence[float], speed_m_per_s: Sequence[float]) -> None:
        """Set the speed trace: times in s rising from 0, speeds in m/s."""
        self._check(self._lib.hubsim_set_trace(self._sim, *self._points(time_s, speed_m_per_s)))

    def load_config(self, image: bytes) -> None:
        """Give all controllers a configuration; the firmware's own validator may refuse it."""
        self._check(
            self._lib.hubsim_load_config(self._sim, self._ffi.from_buffer(image), len(image))
        )

    def set_rear(self, rear: Self) -> None:
        """Give the wheels of the rear axle the drives of another engine, before ``start``.

        That one was given everything but not started; it cannot be used afterwards.
        """
        self._check(self._lib.hubsim_set_rear(self._sim, rear._sim))
        self._ffi.gc(rear._sim, None)  # deleted with this one

    def attach_processor(self, path: str) -> None:
        """Let the emulated core whose RAM is this file execute the controllers, before ``start``.

        ``hubsim.emulator`` starts one.
        """
        self._check(self._lib.hubsim_processor(self._sim, path.encode()))

    def attach_application(self, path: Path) -> None:
        """Let the whole application be the controller of every wheel, before ``start``."""
        self._check(self._lib.hubsim_application(self._sim, str(path).encode()))

    def bus_send(self, identifier: int, data: bytes) -> None:
        """Put a frame of another node on the bus of wheels that have the whole application."""
        values = {"identifier": identifier, "length": len(data), "data": list(data)}
        frame = self._ffi.new("hubsim_frame_t *", values)
        self._check(self._lib.hubsim_bus_send(self._sim, frame))

    def bus_read(self) -> list[tuple[int, bytes]]:
        """Return identifier and content of what wheels, battery and brakes sent since last time."""
        frames = self._ffi.new("hubsim_frame_t[]", _FRAMES)
        count = self._lib.hubsim_bus_read(self._sim, frames, _FRAMES)
        self._check(min(count, 0))
        return [(f.identifier, bytes(f.data)[: f.length]) for f in frames[0:count]]

    def serial_take(self, wheel: int) -> bytes:
        """Return what the application of a wheel wrote to its serial line since last time."""
        buffer = self._ffi.new("char[]", _SERIAL_BYTES)
        count = self._lib.hubsim_serial_take(self._sim, wheel, buffer, _SERIAL_BYTES)
        self._check(min(count, 0))
        return bytes(self._ffi.buffer(buffer, count))

    def serial_type(self, wheel: int, text: bytes) -> None:
        """Type on the serial line of a wheel's application."""
        self._check(self._lib.hubsim_serial_type(self._sim, wheel, text, len(text)))

    def record(self) -> None:
        """Have the steps of every wheel's application recorded, before ``start``."""
        self._check(self._lib.hubsim_record(self._sim))

    def record_end(self) -> None:
        """Record no more steps."""
        self._check(self._lib.hubsim_record_end(self._sim))

    def steps_read(self, wheel: int) -> Steps:
        """Return the steps of a wheel since last time, as ``hubsim.steps`` describes them."""
        parts: list[Steps] = []
        while True:
            found = np.empty(_STEPS, dtype=STEP)
            buffer = self._ffi.from_buffer("hubsim_step_t[]", found.data, require_writable=True)
            count = self._lib.hubsim_steps_read(self._sim, wheel, buffer, _STEPS)
            self._check(min(count, 0))
            parts.append(found[:count])
            if count < _STEPS:
                return parts[0].copy() if len(parts) == 1 else np.concatenate(parts)

    def steps_config(self, wheel: int, size_bytes: int) -> bytes:
        """Return the image with which a wheel booted last, while its steps are recorded."""
        image = self._ffi.new("char[]", size_bytes)
        self._check(self._lib.hubsim_steps_config(self._sim, wheel, image, size_bytes))
        return bytes(self._ffi.buffer(image))

    def packet_send(self, wheel: int, packet: bytes) -> None:
        """Give the application of a wheel a packet of the service protocol, beside CAN."""
        self._check(self._lib.hubsim_packet_send(self._sim, wheel, packet, len(packet)))

    def packets_take(self, wheel: int) -> list[bytes]:
        """Return the packets of the service protocol that a wheel sent since last time."""
        count = self._lib.hubsim_packets_take(self._sim, wheel, self._packets, _PACKETS_BYTES)
        self._check(min(count, 0))
        taken, at, packets = bytes(self._ffi.buffer(self._packets, count)), 0, []
        while at < count:
            packets.append(taken[at + 1 : at + 1 + taken[at]])
            at += 1 + taken[at]
        return packets

    def start(self) -> None:
        """Boot the controllers and bring the vehicle to its initial speed; time is 0 afterwards."""
        self._check(self._lib.hubsim_start(self._sim))
        self.ended = False

    def choose(self, signals: Sequence[str]) -> None:
        """Choose what ``run`` records."""
        known = {name: k for k, name in enumerate(self.signals())}
        for name in signals:
            if name not in known:
                raise HubsimError(f"{name}: no such signal")
        self._check(
            self._lib.hubsim_choose(self._sim, [known[name] for name in signals], len(signals))
        )
        self._chosen = list(signals)

    def signals(self) -> list[str]:
        """Return the names of all signals; known after ``start``."""
        buffer = self._ffi.new("char[]", _NAME_BYTES)
        names = []
        for k in range(self._lib.hubsim_signal_count(self._sim)):
            self._lib.hubsim_signal_name(self._sim, k, buffer, _NAME_BYTES)
            names.append(text_of(buffer))
        return names

    def meanings(self) -> dict[str, tuple[str, str]]:
        """Return unit and meaning of all signals by name.

        The unit is "1" for a share, "" for a code or a flag.
        """
        unit, text = self._lib.hubsim_signal_unit, self._lib.hubsim_signal_text
        return {
            name: (text_of(unit(self._sim, k)), text_of(text(self._sim, k)))
            for k, name in enumerate(self.signals())
        }

    def run(self, duration_s: float) -> Rows:
        """Run for a time or to the end of the run, and return what was recorded.

        Returns
        -------
        array, shape (rows, chosen signals)
            In the units of the signals' names. ``ended`` is true after the end of the run.
        """
        width = max(len(self._chosen), 1)
        capacity = int(duration_s / self.get("run.record_interval_s")) + 2 if self._chosen else 0
        rows: Rows = np.empty((capacity, width), dtype=np.float64)
        buffer = self._ffi.from_buffer("double[]", rows.data) if capacity else self._ffi.NULL
        status = self._lib.hubsim_run(
            self._sim, duration_s, buffer, capacity, self._written, self._number
        )
        self._check(status)
        if status == self._lib.HUBSIM_FULL:
            raise AssertionError("the engine recorded more rows than the interval allows")
        self.ended = status == self._lib.HUBSIM_ENDED
        return rows[: self._written[0], : len(self._chosen)]

    def advance(self, until_s: float) -> None:
        """Go on to a time, at most to the end of the run, and record nothing."""
        status = self._lib.hubsim_advance(self._sim, until_s)
        self._check(status)
        self.ended = status == self._lib.HUBSIM_ENDED

    def sample(self, row: Rows) -> None:
        """Write the chosen signals now into ``row``; rates are means since the row before."""
        if row.shape != (len(self._chosen),) or not row.flags.c_contiguous:
            raise ValueError(f"row: shape {row.shape}, accepted: ({len(self._chosen)},)")
        buffer = self._ffi.from_buffer("double[]", row.data, require_writable=True)
        self._check(self._lib.hubsim_sample(self._sim, buffer))

    def save(self) -> bytes:
        """Return everything that changes while the vehicle runs.

        For ``restore`` into a started engine of the same library.
        """
        state = self._ffi.new("char[]", self._lib.hubsim_state_bytes())
        self._check(self._lib.hubsim_save(self._sim, state))
        return bytes(self._ffi.buffer(state))

    def restore(self, state: bytes) -> None:
        """Go on from what ``save`` returned."""
        if len(state) != self._lib.hubsim_state_bytes():
            raise HubsimError(
                f"a vehicle's state has {self._lib.hubsim_state_bytes()} bytes, got {len(state)}"
            )
        self._check(self._lib.hubsim_restore(self._sim, self._ffi.from_buffer(state)))
        self.ended = False

    @property
    def handle(self) -> Any:  # noqa: ANN401, cffi's types have no public names
        """The library's own handle, for the functions of external.h."""
        return self._sim

    def check(self, status: int) -> None:
        """Raise what the library's last call had to object to, if it had."""
        self._check(status)

    def value(self, name: str) -> float:
        """Return a signal now; of a rate, the account it is the rate of."""
        if self._lib.hubsim_value(self._sim, name.encode(), self._number) != self._lib.HUBSIM_OK:
            raise HubsimError(f"{name}: no such signal")
        return float(self._number[0])

    def mode_text(self, mode: float) -> str:
        """Return the name of a controller's mode."""
        return mode_text(mode)

    def reason_text(self, reason: float) -> str:
        """Return what a reason code means."""
        return reason_text(reason)

    def _points(self, x: Sequence[float], y: Sequence[float]) -> tuple[Any, Any, int]:
        return self._ffi.new("double[]", list(x)), self._ffi.new("double[]", list(y)), len(x)

    def _check(self, status: int) -> None:
        if status < self._lib.HUBSIM_OK:
            raise HubsimError(text_of(self._lib.hubsim_error(self._sim)))


def mode_text(mode: float) -> str:
    """Return the name of a controller's mode."""
    return text_of(library()[1].hubsim_mode_text(min(int(mode), _MOST_CODE)))


def reason_text(reason: float) -> str:
    """Return what a reason code means."""
    return text_of(library()[1].hubsim_reason_text(int(reason)))


class Parameter:
    """One line of the engine's list of parameters."""

    def __init__(self, name: str, unit: str, text: str, lowest: float, highest: float) -> None:
        self.name, self.unit, self.text, self.lowest, self.highest = (
            name,
            unit,
            text,
            lowest,
            highest,
        )


@cache
def parameters() -> dict[str, Parameter]:
    """Return all parameters of the simulated world by name."""
    _, lib = library()
    found = [
        Parameter(
            text_of(lib.hubsim_parameter_name(k)),
            text_of(lib.hubsim_parameter_unit(k)),
            text_of(lib.hubsim_parameter_text(k)),
            lib.hubsim_parameter_lowest(k),
            lib.hubsim_parameter_highest(k),
        )
        for k in range(lib.hubsim_parameter_count())
    ]
    return {parameter.name: parameter for parameter in found}
