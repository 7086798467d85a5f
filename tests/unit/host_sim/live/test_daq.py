# SPDX-License-Identifier: Apache-2.0
"""DAQ lists and the scope of the virtual vehicle: by pyxcp, by the client, by its commands."""

import csv
import itertools
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from daq_packets import Kept
from hubfoc import HubfocError, addresses, cli
from hubfoc.live.vehicle import SimulatedVehicle
from hubfoc.live.xcp import Gateways
from hubfoc.measuring import Trigger
from hubfoc.service import Service, Udp
from hubsim import cli as hubsim_cli
from pyxcp.types import XcpResponseError
from regen_table import schema

from tests.unit.host_sim.live.support import running
from tests.unit.host_sim.live.test_xcp import PLACES, master_of

# The 16 bits of a time stamp wrap every 0.66 s.
WATCHED_MS = 60_000 if "HUBFOC_FOR_LONG" in os.environ else 6_000
# Of the vehicle before what the tool has received: 200 packets, which a socket holds.
AHEAD_MS = 10
PARTS = 4
SLOW, FAST = 0, 1


@dataclass
class Stepped:
    """A vehicle that is stepped as fast as its reader follows."""

    vehicle: SimulatedVehicle
    gateways: Gateways
    ends: threading.Event = field(default_factory=threading.Event)
    steps: int = 0
    most: Callable[[], int] | None = None

    def run(self) -> None:
        """Step until the end."""
        while not self.ends.is_set():
            if self.most is None:
                time.sleep(2e-4)  # one that outruns its reader fills the socket
            elif self.steps >= self.most():
                time.sleep(1e-4)
                continue
            self.gateways.receive(self.vehicle)
            self.vehicle.step([])
            self.gateways.send(self.vehicle)
            self.steps += 1


@pytest.fixture
def stepped() -> Iterator[Stepped]:
    drive = schema.load(hubsim_cli.DEFAULT_CONFIG)
    with (
        SimulatedVehicle(drive) as vehicle,
        Gateways(vehicle.service_base, vehicle.wheels) as gateways,
    ):
        own = Stepped(vehicle, gateways)
        thread = threading.Thread(target=own.run)
        thread.start()
        yield own
        own.ends.set()
        thread.join()


def master_with(policy: Kept, stepped: Stepped) -> Any:  # noqa: ANN401, pyxcp's types
    master = master_of(stepped.gateways.wheels[2].address, stepped.vehicle.key, policy)
    master.transport.connect()
    master.connect()
    return master


def configure(
    master: Any,  # noqa: ANN401
    number: int,
    signals: dict[str, int],
    prescaler: int,
) -> None:
    master.clearDaqList(number)
    master.setDaqPtr(number, 0, 0)
    for name, size in signals.items():
        master.writeDaq(0xFF, size, 0, PLACES[name])
    master.setDaqListMode(0x10, number, number, prescaler, 0)


def test_every_slow_step_comes_without_a_gap(stepped: Stepped) -> None:
    policy = Kept()
    master = master_with(policy, stepped)
    configure(master, SLOW, {"output.bus_voltage_v": 4, "output.mode": 1}, 1)
    follow(stepped, policy, master, SLOW, WATCHED_MS, 1)
    packets = policy.packets[:WATCHED_MS]
    ticks = [int.from_bytes(packet[1:3], "little") for packet in packets]
    assert {packet[0] for packet in packets} == {0}
    assert {(b - a) % 0x10000 for a, b in itertools.pairwise(ticks)} == {100}
    assert {len(packet) for packet in packets} == {8}
    master.close()


def follow(
    stepped: Stepped,
    policy: Kept,
    master: Any,  # noqa: ANN401
    number: int,
    packets: int,
    a_ms: int,
) -> None:
    """Let a list run until there are so many packets, the vehicle never far ahead of them."""
    master.startStopDaqList(1, number)
    assert master.getStatus().sessionStatus.daqRunning
    begun = stepped.steps
    stepped.most = lambda: begun + len(policy.packets) // a_ms + AHEAD_MS
    for part in range(1, PARTS + 1):
        while len(policy.packets) < packets * part // PARTS:
            time.sleep(1e-3)
        master.getStatus()  # a session without commands ends after a minute
    master.startStopSynch(0)


def test_every_pwm_period_comes_by_udp(stepped: Stepped) -> None:
    policy = Kept()
    master = master_with(policy, stepped)
    names = ("fast_input.phase_current_code_a", "fast_output.compare_counts_c")
    configure(master, FAST, {**dict.fromkeys(names, 2), "output.bus_voltage_v": 4}, 1)
    follow(stepped, policy, master, FAST, 20_000, 20)
    packets = policy.packets[:20_000]
    ticks = [int.from_bytes(packet[1:3], "little") for packet in packets]
    assert {packet[0] for packet in packets} == {8}
    assert {(b - a) % 0x10000 for a, b in itertools.pairwise(ticks)} == {5}
    assert all(0 <= int.from_bytes(packet[3:5], "little") < 4096 for packet in packets)
    master.close()


def refused(code: int, service: Any, *arguments: object) -> None:  # noqa: ANN401
    with pytest.raises(XcpResponseError) as refusal:
        service(*arguments)
    assert int(refusal.value.args[0]) == code


def test_pyxcp_reads_what_there_is_and_is_refused_the_rest(stepped: Stepped) -> None:
    master = master_with(Kept(), stepped)
    info = master.getDaqProcessorInfo()
    assert (info.maxDaq, info.maxEventChannel, info.minDaq) == (2, 2, 0)
    assert info.daqProperties.daqConfigType == "STATIC"
    assert info.daqProperties.timestampSupported
    resolution = master.getDaqResolutionInfo()
    assert resolution.timestampMode.unit == "DAQ_TIMESTAMP_UNIT_10US"
    assert resolution.maxOdtEntrySizeDaq == 4
    assert master.getDaqEventInfo(SLOW).eventChannelTimeCycle == 1
    assert bytes(master.fetch(9)) == b"slow step"
    assert master.getDaqEventInfo(FAST).eventChannelTimeCycle == 50
    assert bytes(master.fetch(10)) == b"PWM period"
    assert master.getDaqListInfo(FAST).maxOdt == 1
    refused(0x29, master.writeDaq, 0xFF, 4, 0, PLACES["output.mode"])
    configure(master, SLOW, {"output.mode": 1}, 1)
    refused(0x24, master.writeDaq, 0xFF, 4, 0, addresses.PAGE)
    refused(0x24, master.writeDaq, 0xFF, 4, 0, 0x20000000)
    refused(0x22, master.setDaqPtr, 2, 0, 0)
    refused(0x2A, master.startStopDaqList, 1, FAST)  # empty
    master.startStopDaqList(1, SLOW)
    refused(0x11, master.setDaqPtr, SLOW, 0, 0)
    master.close()


def test_the_client_measures_signals_of_both_loops(stepped: Stepped) -> None:
    names = ["output.mode", "output.bus_voltage_v", "input.winding_temperature_c",
             "fast_input.bus_voltage_code"]  # fmt: skip
    with Service(Udp(stepped.gateways.wheels[0].address)) as wheel:
        with closing(wheel.daq(names)) as samples:
            first = [next(samples) for _ in range(50)]
        assert wheel.signal("output.bus_voltage_v") == first[-1].values["output.bus_voltage_v"]
        with closing(wheel.daq(names[-1:], fast=True, every=2)) as samples:
            fast = [next(samples) for _ in range(50)]
        with pytest.raises(HubfocError, match="accepted: 1 to 255"):
            next(wheel.daq(names, every=0))
    assert not any(sample.lost for sample in first)
    times_s = [sample.time_s for sample in first]
    assert np.diff(times_s) == pytest.approx(1e-3)
    assert set(first[0].values) == set(names)
    assert np.diff([sample.time_s for sample in fast]) == pytest.approx(1e-4)


def test_a_recording_has_its_trigger_at_time_zero(stepped: Stepped) -> None:
    name = "input.config_accepted"
    with Service(Udp(stepped.gateways.wheels[0].address)) as wheel:
        level = wheel.signal(name)
        found = wheel.scope(
            [name, "fast_input.bus_voltage_code"], trigger=Trigger.of(f"above:{name}:{level}"),
            before=20, rows=100, every=3,
        )  # fmt: skip
        assert found.time_s[[0, 20, 99]] == pytest.approx([-20 * 150e-6, 0.0, 79 * 150e-6])
        assert set(found.values[name]) == {level}
        with pytest.raises(HubfocError, match="nothing has triggered"):
            wheel.scope([name], trigger=Trigger.of(f"rises:{name}:{level + 1}"), wait_s=0.2)
        with pytest.raises(HubfocError, match="1 to 8"):
            wheel.scope([name] * 9)


@pytest.mark.parametrize(
    "text", ["", "rises", "rises:a", "rises:a:b", "rises:a:1:2", "finding:NO_REASON", "any:a:1"]
)
def test_what_is_no_trigger_is_refused(text: str) -> None:
    with pytest.raises(HubfocError, match="accepted: none, above"):
        Trigger.of(text)


def test_the_commands_write_a_table_and_show_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, names = tmp_path / "record.csv", "fast_input.phase_current_code_a,output.mode"
    with running() as own:
        where = ("--udp", own.gateways.wheels[1].address)
        assert cli.main(["scope", "--signals", names, "--rows", "50", "-o", str(file), *where]) == 0
        assert cli.main(["watch", "--signals", names, "--for", "0.5", *where]) == 0
        assert cli.main(["scope", "--signals", "x", "-o", str(file), *where]) == 2
    with file.open(encoding="utf-8") as table:
        rows = list(csv.reader(table))
    assert rows[0] == ["time_s", *names.split(",")]
    assert len(rows) == 51
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"time_s {names.replace(',', ' ')}"
    assert len(lines[1].split()) == 3
