# SPDX-License-Identifier: Apache-2.0
"""XCP on CAN, spoken by pyxcp with the flashable image on the model of its chip.

The wheel stands still on a virtual bus; what it reads and changes is compared with the image's
bytes and with what the wheel says of itself in its messages.
"""

import itertools
import logging
import os
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import can
import cantools
import pytest
from daq_packets import Kept
from hubfoc import addresses
from hubsim import cli
from pyxcp.config import create_application_from_config
from pyxcp.master.master import Master
from pyxcp.types import XcpResponseError
from regen_table import image, schema, service_key
from siphash import key_of
from wheel_on_bus import standing

ROOT = Path(__file__).resolve().parents[3]
DBC: Any = cantools.database.load_file(ROOT / "firmware" / "comms" / "hubfoc.dbc")
IN_FORCE, STAGING, OF_TOOL, STORE = 0, 1, 2, 1
SLOW, FAST, MODE_READY = 0, 1, 3
PART = 64  # of the page, bytes
WATCHED_MS = 60_000 if "HUBFOC_FOR_LONG" in os.environ else 1_500
PLACES = {signal.name: signal.address for signal in addresses.signals()}
FIELDS = {field.name: field.address for field in addresses.fields()}
CHANNELS = (f"xcp {number}" for number in itertools.count())
ANSWERS_S = 20.0  # the model is slower than the chip


@dataclass
class Tool:
    """A connected master on the wheel's bus."""

    master: Any  # pyxcp has no types
    bus: can.BusABC
    image: bytes
    samples: Kept

    def word(self, address: int) -> int:
        return int.from_bytes(self.master.shortUpload(4, address), "little", signed=True)

    def write(self, address: int, value: int) -> None:
        self.master.setMta(address)
        self.master.download(value.to_bytes(4, "little"))

    def refused(self, code: int, service: Any, *arguments: object) -> None:  # noqa: ANN401
        with pytest.raises(XcpResponseError) as refusal:
            service(*arguments)
        assert int(refusal.value.args[0]) == code

    def message(self, name: str) -> dict[str, Any]:
        """Return the wheel's next message of this name."""
        wanted = DBC.get_message_by_name(name)
        end_s = time.monotonic() + ANSWERS_S
        while (left_s := end_s - time.monotonic()) > 0.0:
            frame = self.bus.recv(timeout=left_s)
            if frame is not None and frame.arbitration_id == wanted.frame_id:
                return dict(wanted.decode(bytes(frame.data)))
        raise AssertionError(f"the wheel sends no {name}")

    def hears(self, name: str, signal: str, value: object) -> None:
        """Take messages until one has a value."""
        end_s = time.monotonic() + 3.0 * ANSWERS_S
        while self.message(name)[signal] != value:
            assert time.monotonic() < end_s, value


def master_of(channel: str, key: bytes, samples: Kept) -> Any:  # noqa: ANN401
    identifier = schema.load(cli.DEFAULT_CONFIG).service.can_base
    application = create_application_from_config(
        {
            "Transport": {
                "CAN": {
                    "interface": "virtual",
                    "channel": channel,
                    "can_id_master": identifier,
                    "can_id_slave": identifier + 4,
                }
            },
            "General": {
                "disable_error_handling": True,
                "seed_n_key_function": lambda _, seed: key_of(key, seed),
            },
        },
        log_level=logging.ERROR,
    )
    application.transport.timeout = ANSWERS_S
    return Master("can", config=application, policy=samples)


@pytest.fixture
def tool(tmp_path: Path) -> Iterator[Tool]:
    key, channel = service_key.draw(), next(CHANNELS)
    whole = service_key.with_key(image.build(schema.load(cli.DEFAULT_CONFIG)), key)
    configuration = tmp_path / "configuration.bin"
    configuration.write_bytes(whole)
    with standing(channel, configuration), can.Bus(channel, interface="virtual") as bus:
        master = master_of(channel, key, samples := Kept())
        master.transport.connect()
        master.connect()
        tool = Tool(master, bus, whole, samples)
        tool.hears("WheelState", "mode", "READY")
        yield tool
        master.transport.close()


def test_every_signal_is_read_without_a_key_and_nothing_else(tool: Tool) -> None:
    read = {name: tool.word(address) for name, address in PLACES.items()}
    state, power = tool.message("WheelState"), tool.message("WheelPower")
    assert state["mode"] == "READY"
    assert read["output.speed_rad_per_s"] == state["speed_rad_s"] == 0
    volts = pytest.approx(power["bus_voltage_v"], abs=0.2)
    assert read["output.bus_voltage_v"] / 1000.0 == volts
    assert read["fast_input.bus_voltage_code"] in range(1, 4096)
    tool.refused(0x24, tool.word, max(PLACES.values()) + 4)
    tool.refused(0x24, tool.word, 0x20000000)
    tool.refused(0x24, tool.word, 0x08000000)


def test_the_page_is_the_image_s_without_the_key(tool: Tool) -> None:
    page = tool.image[: addresses.page_bytes()]
    for at in (0, len(page) // 2, len(page) - PART):
        tool.master.setMta(addresses.PAGE + at)
        assert bytes(tool.master.fetch(PART)) == page[at : at + PART]
    tool.master.setMta(addresses.PAGE)
    assert tool.master.buildChecksum(len(page)).checksum == zlib.crc32(page)
    tool.refused(0x24, tool.word, addresses.PAGE + len(page))


def test_a_parameter_is_changed_in_flash_and_in_force_after_the_restart(tool: Tool) -> None:
    at = FIELDS["driver.lost_hold_ms"]
    before = tool.word(at)
    tool.refused(0x25, tool.write, at, before + 7)
    tool.master.cond_unlock("calpag")
    tool.master.setCalPage(OF_TOOL, 0, STAGING)
    tool.write(at, 10_001)
    tool.refused(0x22, tool.master.setRequest, STORE, 0)  # out of range
    tool.write(at, before + 7)
    derate, most = (FIELDS[f"motor.{name}_winding_temperature_cC"] for name in ("derate", "max"))
    right = tool.word(derate)
    tool.write(derate, tool.word(most) + 1)
    tool.refused(0x22, tool.master.setRequest, STORE, 0)  # each in range, not both together
    tool.write(derate, right)
    tool.master.setCalPage(OF_TOOL, 0, IN_FORCE)
    assert tool.word(at) == before
    tool.master.setRequest(STORE, 0)
    for mode in ("OFFSET_CAL", "READY"):  # it restarts, and does not answer before
        tool.hears("WheelState", "mode", mode)
    tool.master.connect()
    assert tool.word(at) == before + 7


def test_a_list_comes_every_millisecond_without_a_gap(tool: Tool) -> None:
    master = tool.master
    master.clearDaqList(SLOW)
    master.setDaqPtr(SLOW, 0, 0)
    for name, size in (("output.bus_voltage_v", 4), ("output.mode", 1)):
        master.writeDaq(0xFF, size, 0, PLACES[name])
    master.setDaqListMode(0x10, SLOW, SLOW, 1, 0)
    master.clearDaqList(FAST)
    master.setDaqPtr(FAST, 0, 0)
    master.writeDaq(0xFF, 2, 0, PLACES["fast_input.bus_voltage_code"])
    master.setDaqListMode(0x10, FAST, FAST, 1, 0)
    tool.refused(0x2A, master.startStopDaqList, 1, FAST)  # more than CAN carries
    master.startStopDaqList(1, SLOW)
    while len(tool.samples.packets) < WATCHED_MS:
        time.sleep(0.2)
        master.getStatus()  # a session without commands ends
    master.startStopSynch(0)
    packets = tool.samples.packets[:WATCHED_MS]
    ticks = [int.from_bytes(packet[1:3], "little") for packet in packets]
    assert {packet[0] for packet in packets} == {0}
    assert {(b - a) % 0x10000 for a, b in itertools.pairwise(ticks)} == {100}
    assert {packet[-1] for packet in packets} == {MODE_READY}
