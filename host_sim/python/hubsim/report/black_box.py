# SPDX-License-Identifier: Apache-2.0
"""The record of the first fault that a controller kept, from the shell's ``blackbox``.

The layout is that of firmware/app/include/app/recorder.h, format 1: little endian, a header
of 168 bytes, the ring of PWM periods and the ring of slow steps, each from its oldest entry on at
an index that the header gives.
"""

import argparse
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from regen_table import schema

from hubsim import files, reasons
from hubsim.errors import HubsimError
from hubsim.report import starts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hubsim.report.reading import FaultRecord

MAGIC, FORMAT = 0x42464F46, 1
COMPLETE, SEALED = 3, 4
BRIDGE_SHIFT = 14
BRIDGES = ("freewheel", "PWM", "short circuit", "short circuit, high side")
HEADER = np.dtype(
    [
        *(("magic", "<u4"), ("format", "<u2"), ("size_bytes", "<u2")),
        *(("phase", "u1"), ("restart_expected", "u1"), ("supply", "<u2"), ("counts_check", "<u4")),
        ("counts", "<u2", 64),
        *(("crc32", "<u4"), ("pwm_frequency_hz", "<u4"), ("config_crc32", "<u4")),
        *(("fault_ms", "<u4"), ("fast_next", "<u2"), ("slow_next", "<u2")),
        *(("reason", "u1"), ("after_reset", "u1"), ("started_by", "u1"), ("ended_by", "u1")),
    ]
)
FAST = np.dtype(
    [("phase_code", "<u2", 3), ("bus_code", "<u2"), ("rotor", "<u2"), ("on_a_counts", "<u2")]
)
SLOW = np.dtype(
    [
        *(
            (name, "<i2")
            for name in ("speed", "command", "estimate", "hydraulic", "bus_v", "bus_a")
        ),
        *(("winding_c", "i1"), ("switch_c", "i1"), ("mode", "u1"), ("reason", "u1")),
    ]
)
FAST_ENTRIES, SLOW_ENTRIES = 400, 200
FAST_AFTER_MS, SLOW_AFTER_S, SLOW_PERIOD_S = 5, 0.5, 0.01
RECORD = np.dtype([("header", HEADER), ("fast", FAST, FAST_ENTRIES), ("slow", SLOW, SLOW_ENTRIES)])
LOW = (19, 26, 27, 28, 29)  # codes of warnings below the first fault
FIRST_LOW, FIRST_START = 50, 55  # of the counters: those, then starts by cause
CHECKED_FROM = 148  # the CRC is of everything behind itself
LONGEST_BYTES = 4_000_000  # of a terminal's log


@dataclass(frozen=True)
class Record:
    """What happened around the first fault; times are seconds from it."""

    reason: str
    fault_s: float
    after_reset: bool
    started_by: str
    """Cause of the start before it; empty if it is not known."""
    ended_by: str
    """Cause of the start that ended it; empty if none did."""
    sealed: bool
    config_crc32: int
    counts: dict[str, int]
    fast_s: npt.NDArray[np.float64]
    current_a: npt.NDArray[np.float64]
    bus_v: npt.NDArray[np.float64]
    bridge: npt.NDArray[np.int64]
    rotor: npt.NDArray[np.int64]
    on_a_counts: npt.NDArray[np.int64]
    slow_s: npt.NDArray[np.float64]
    slow: dict[str, npt.NDArray[np.float64]]


def bytes_of(text: str, name: str) -> bytes:
    """Return the memory that a terminal's log shows, the latest if there are several."""
    lines = re.findall(r"^([0-9A-F]{4}): ([0-9A-F]+)\s*$", text, re.MULTILINE)
    begins = [number for number, (offset, _) in enumerate(lines) if offset == "0000"]
    if not begins:
        raise HubsimError(f"{name}: no record, accepted: what the shell's blackbox printed")
    content = b""
    for offset, digits in lines[begins[-1] :]:
        if int(offset, 16) != len(content) or len(digits) % 2:
            raise HubsimError(f"{name}: the line before {offset} is missing or damaged")
        content += bytes.fromhex(digits)
    if len(content) != RECORD.itemsize:
        raise HubsimError(f"{name}: {len(content)} bytes, accepted: {RECORD.itemsize}")
    return content


def _counted(number: int) -> str:
    """Return what a counter counts: a fault or warning, or a start by its cause."""
    if FIRST_LOW <= number < FIRST_START:
        return reasons.identifier(LOW[number - FIRST_LOW])
    if number < FIRST_START:
        return reasons.identifier(reasons.first_fault() + number)
    return f"start by {starts.name(number - FIRST_START)}"


def read(
    content: bytes, name: str, current_full_scale_a: float, voltage_full_scale_v: float
) -> Record:
    """Return a record in SI units."""
    record = np.frombuffer(content, RECORD)[0]
    header = record["header"]
    if (header["magic"], header["format"]) != (MAGIC, FORMAT):
        raise HubsimError(f"{name}: not a record of format {FORMAT}")
    sealed = int(header["phase"]) == SEALED
    if sealed and zlib.crc32(content[CHECKED_FROM:]) != int(header["crc32"]):
        raise HubsimError(f"{name}: the CRC of the record is wrong")
    fast = np.roll(record["fast"], -int(header["fast_next"]))
    fast = fast[fast["bus_code"] != 0]
    slow = np.roll(record["slow"], -int(header["slow_next"]))
    slow = slow[slow["mode"] != 0]
    ended = bool(header["after_reset"])
    codes = fast["phase_code"].astype(np.float64)
    bus_code = fast["bus_code"].astype(np.int64)
    last_fast_s = 0.0 if ended else FAST_AFTER_MS * 1e-3
    last_slow_s = 0.0 if ended else SLOW_AFTER_S
    tenths = ("speed", "command", "estimate", "hydraulic", "bus_v", "bus_a")
    return Record(
        reason=reasons.identifier(float(header["reason"])),
        fault_s=float(header["fault_ms"]) * 1e-3,
        after_reset=ended,
        started_by=starts.name(int(header["started_by"])),
        ended_by=starts.name(int(header["ended_by"])),
        sealed=sealed,
        config_crc32=int(header["config_crc32"]),
        counts={
            _counted(number): int(count) for number, count in enumerate(header["counts"]) if count
        },
        fast_s=last_fast_s - np.arange(len(fast) - 1, -1, -1) / float(header["pwm_frequency_hz"]),
        current_a=(codes - 2048.0) / 2048.0 * current_full_scale_a,
        bus_v=(bus_code & ((1 << BRIDGE_SHIFT) - 1)) / 4096.0 * voltage_full_scale_v,
        bridge=bus_code >> BRIDGE_SHIFT,
        rotor=fast["rotor"].astype(np.int64),
        on_a_counts=fast["on_a_counts"].astype(np.int64),
        slow_s=last_slow_s - np.arange(len(slow) - 1, -1, -1, dtype=np.float64) * SLOW_PERIOD_S,
        slow={
            name: slow[name].astype(np.float64) * (0.1 if name in tenths else 1.0)
            for name in SLOW.names or ()
        },
    )


def summary(record: Record) -> list[str]:
    """Return what there is to say, a line each."""
    end = ", ended by a reset" if record.after_reset else ""
    end += f" ({record.ended_by})" if record.ended_by else ""
    end += f", after a start by {record.started_by}" if record.started_by else ""
    lines = [
        f"{record.reason} {record.fault_s:.3f} s after the start{end}; configuration"
        f" 0x{record.config_crc32:08X}" + ("" if record.sealed else "; no CRC, not checked")
    ]
    before = record.slow_s <= 0.0
    if before.any():
        at = {name: values[before][-1] for name, values in record.slow.items()}
        lines.append(
            f"before it: {at['speed']:.1f} rad/s, {at['estimate']:.1f} N m of {at['command']:.1f},"
            f" hydraulic {at['hydraulic']:.1f} N m, {at['bus_v']:.1f} V, {at['bus_a']:.1f} A,"
            f" winding {at['winding_c']:.0f} degC"
        )
    if len(record.fast_s):
        lines.append(
            f"largest phase current {np.abs(record.current_a).max():.1f} A, bus"
            f" {record.bus_v.min():.1f} to {record.bus_v.max():.1f} V, bridge:"
            f" {', '.join(BRIDGES[int(mode)] for mode in dict.fromkeys(record.bridge.tolist()))}"
        )
    lines.extend(f"{count} times {name}" for name, count in record.counts.items())
    return lines


def tables(record: Record) -> dict[str, str]:
    """Return file name and text of the two rings."""
    fast = ["time_s,current_a_a,current_b_a,current_c_a,bus_v,bridge,rotor,on_a_counts"]
    fast += [
        f"{time:.6f},{a:.3f},{b:.3f},{c:.3f},{bus:.3f},{mode},{rotor},{on}"
        for time, (a, b, c), bus, mode, rotor, on in zip(
            *(record.fast_s, record.current_a, record.bus_v, record.bridge, record.rotor),
            record.on_a_counts,
            strict=True,
        )
    ]
    names = list(record.slow)
    slow = [f"time_s,{','.join(names)}"]
    slow += [
        f"{time:.2f}," + ",".join(f"{record.slow[name][row]:g}" for name in names)
        for row, time in enumerate(record.slow_s)
    ]
    return {
        "blackbox_fast.csv": "\n".join(fast) + "\n",
        "blackbox_slow.csv": "\n".join(slow) + "\n",
    }


def _figure(record: Record) -> "Figure":
    """Return the picture: phase currents, bus voltage, torque and speed around the fault."""
    from regen_table import plotting  # noqa: PLC0415, only where something is drawn

    made, panels = plotting.figure(f"Black box: {record.reason}", 2, 2, 10.0, 7.0)
    currents, bus, torque, speed = panels
    colours = (plotting.BLUE, plotting.ORANGE, plotting.GREEN)
    for phase, colour in zip("abc", colours, strict=True):
        values = record.current_a[:, "abc".index(phase)]
        currents.plot(record.fast_s * 1e3, values, color=colour, label=f"phase {phase}")
    currents.set(title="phase currents", xlabel="ms from the fault", ylabel="A")
    currents.legend(fontsize=8)
    bus.plot(record.fast_s * 1e3, record.bus_v, color=plotting.BLUE)
    bus.set(title="bus voltage", xlabel="ms from the fault", ylabel="V")
    for name, colour in zip(("command", "estimate", "hydraulic"), colours, strict=True):
        torque.plot(record.slow_s, record.slow[name], color=colour, label=name)
    torque.set(title="torque", xlabel="s from the fault", ylabel="N m")
    torque.legend(fontsize=8)
    speed.plot(record.slow_s, record.slow["speed"], color=plotting.BLUE)
    speed.set(title="wheel speed", xlabel="s from the fault", ylabel="rad/s")
    for axes in panels:
        axes.axvline(0.0, color="0.3", linewidth=0.8)
    return made


def draw(record: Record, directory: Path) -> list[Path]:
    """Write blackbox.svg and blackbox.png."""
    from regen_table import plotting  # noqa: PLC0415, only where something is drawn

    return plotting.save({"blackbox": _figure(record)}, directory)


def load(path: Path, config: Path) -> Record:
    """Return the record in a terminal's log; the drive's full scales make amperes and volts."""
    inverter = schema.load(config).inverter
    content = bytes_of(files.read_text(path, LONGEST_BYTES), str(path))
    return read(content, str(path), inverter.current_full_scale_a, inverter.voltage_full_scale_v)


def for_page(path: Path, config: Path) -> "FaultRecord":
    """Return what the report shows of the record in a terminal's log."""
    from regen_table import plotting  # noqa: PLC0415, only where something is drawn

    from hubsim.report.reading import FaultRecord  # noqa: PLC0415, likewise

    record = load(path, config)
    return FaultRecord(path.name, record.reason, summary(record), plotting.vector(_figure(record)))


def command(options: argparse.Namespace) -> int:
    """Print what a record says and write its tables and picture if asked for."""
    record = load(options.file, options.config)
    for line in summary(record):
        print(line)
    if options.output is not None:
        from regen_table import generate  # noqa: PLC0415, only here

        made = {name: text.encode() for name, text in tables(record).items()}
        generate.write_all(made, options.output)
        draw(record, options.output)
        print(f"tables and picture: {options.output}")
    return 0
