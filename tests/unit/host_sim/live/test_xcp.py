# SPDX-License-Identifier: Apache-2.0
"""XCP of the virtual vehicle, spoken by pyxcp over UDP: what it reads, changes, and may not."""

import hashlib
import logging
import socket
import struct
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from hubfoc import addresses
from hubfoc.live.vehicle import SimulatedVehicle
from hubfoc.live.xcp import Gateways
from hubsim import cli
from pyxcp.config import create_application_from_config
from pyxcp.master.master import Master
from pyxcp.types import XcpResponseError
from regen_table import image, schema
from siphash import key_of, siphash

from tests.unit.host_sim.live.support import running

IN_FORCE, STAGING, OF_TOOL, STORE = 0, 1, 2, 1
PLACES = {signal.name: signal.address for signal in addresses.signals()}
FIELDS = {field.name: field.address for field in addresses.fields()}


@dataclass
class Tool:
    """A connected master, and the vehicle behind it."""

    master: Any
    vehicle: SimulatedVehicle
    gateways: Gateways
    drive: schema.Drive

    def word(self, address: int) -> int:
        return int.from_bytes(self.master.shortUpload(4, address), "little", signed=True)

    def page(self) -> bytes:
        self.master.setMta(addresses.PAGE)
        return bytes(self.master.fetch(addresses.page_bytes()))

    def refused(self, code: int, service: Any, *arguments: object) -> None:  # noqa: ANN401
        with pytest.raises(XcpResponseError) as refusal:
            service(*arguments)
        assert int(refusal.value.args[0]) == code

    def unlock(self) -> None:
        self.master.cond_unlock("calpag")
        self.master.setCalPage(OF_TOOL, 0, STAGING)


def master_of(address: str, key: bytes, policy: object = None) -> Any:  # noqa: ANN401
    host, port = address.split(":")
    application = create_application_from_config(
        {
            "Transport": {"Eth": {"host": host, "port": int(port), "protocol": "UDP"}},
            "General": {
                "disable_error_handling": True,
                "seed_n_key_function": lambda _, seed: key_of(key, seed),
            },
        },
        log_level=logging.ERROR,
    )
    application.transport.timeout = 20.0
    return Master("eth", config=application, policy=policy)


@pytest.fixture(scope="module")
def drive() -> schema.Drive:
    return schema.load(cli.DEFAULT_CONFIG)


@pytest.fixture
def tool(drive: schema.Drive) -> Iterator[Tool]:
    """Return a tool that speaks to the front right wheel of a vehicle in real time."""
    with running() as own:
        vehicle, gateways = own.world.vehicle, own.gateways
        master = master_of(gateways.wheels[1].address, vehicle.key)
        master.transport.connect()
        master.connect()
        yield Tool(master, vehicle, gateways, drive)
        master.transport.close()


def test_the_independent_mac_is_that_of_the_paper() -> None:
    expected = (0xA129CA6149BE45E5).to_bytes(8, "little")
    assert siphash(bytes(range(16)), bytes(range(15))) == expected


def test_what_the_slave_says_of_itself(tool: Tool) -> None:
    master = tool.master
    properties = master.slaveProperties
    assert properties.maxCto == 8
    assert properties.supportsCalpag
    assert properties.supportsDaq
    assert properties.maxDto == 35
    assert master.getCommModeInfo().xcpDriverVersionNumber == 0x10
    assert master.identifier(1).startswith("hubfoc-")
    assert master.getCurrentProtectionStatus()["calpag"]
    assert bytes(master.synch()) == b"\x00"  # the error of that name, its answer
    tool.refused(0x20, master.getPgmProcessorInfo)


def test_measuring_needs_no_key(tool: Tool) -> None:
    end_s = time.monotonic() + 60.0
    while tool.word(PLACES["output.mode"]) != 3:  # READY
        assert time.monotonic() < end_s
    volts = tool.word(PLACES["output.bus_voltage_v"]) / 1000.0
    assert volts == pytest.approx(tool.vehicle.value("bus.voltage_v"), abs=0.5)
    assert tool.word(PLACES["output.speed_rad_per_s"]) == 0
    assert tool.word(PLACES["input.config_accepted"]) == 1
    for address in PLACES.values():
        tool.word(address)
    tool.refused(0x24, tool.word, max(PLACES.values()) + 4)
    assert tool.word(PLACES["fast_input.bus_voltage_code"]) in range(4096)
    tool.refused(0x24, tool.word, 0x20000000)


def test_the_page_is_the_configuration_without_the_key(tool: Tool) -> None:
    expected = bytearray(image.build(tool.drive)[: addresses.page_bytes()])
    expected[FIELDS["vehicle.wheel_position"] - addresses.PAGE] = 1  # the wheel's own
    page = tool.page()
    assert page == bytes(expected)
    assert tool.vehicle.key not in page
    tool.master.setMta(addresses.PAGE)
    assert tool.master.buildChecksum(len(page)).checksum == zlib.crc32(page)
    tool.refused(0x24, tool.word, addresses.PAGE + len(page))


def test_a_parameter_is_changed_stored_and_used(tool: Tool) -> None:
    master = tool.master
    at = FIELDS["driver.lost_hold_ms"]
    before = tool.word(at)

    def write(value: int) -> None:
        master.setMta(at)
        master.download(value.to_bytes(4, "little"))

    tool.refused(0x25, write, before + 7)
    tool.unlock()
    write(10001)
    tool.refused(0x22, master.setRequest, STORE, 0)  # out of range
    write(before + 7)
    assert tool.word(at) == before + 7
    master.setCalPage(OF_TOOL, 0, IN_FORCE)
    assert tool.word(at) == before
    master.setRequest(STORE, 0)
    end_s = time.monotonic() + 60.0
    found = before
    while found == before:  # the wheel restarts
        assert time.monotonic() < end_s
        found = after_a_restart(tool, at, before)
    assert found == before + 7


def after_a_restart(tool: Tool, at: int, otherwise: int) -> int:
    """Read a word by datagrams of one's own, because a wheel that restarts does not answer."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.settimeout(0.2)
        host, port = tool.gateways.wheels[1].address.split(":")
        for packet in (b"\xff\x00", b"\xf4\x04\x00\x00" + at.to_bytes(4, "little")):
            line.sendto(struct.pack("<HH", len(packet), 0) + packet, (host, int(port)))
            try:
                answer = line.recv(64)[4:]
            except TimeoutError:
                return otherwise
        return int.from_bytes(answer[1:5], "little") if answer[0] == 0xFF else otherwise


def test_a_wrong_key_opens_nothing(tool: Tool) -> None:
    master = tool.master
    wrong = hashlib.sha256(tool.vehicle.key).digest()[:16]
    for _ in range(3):
        master.connect()
        seed = bytes(master.getSeed(0, 1).seed)
        tool.refused(0x25, master.unlock, 6, key_of(wrong, seed))
    master.connect()
    tool.refused(0x33, master.getSeed, 0, 1)


def test_other_wheels_have_other_ports_and_junk_is_not_answered(tool: Tool) -> None:
    assert len({wheel.address for wheel in tool.gateways.wheels}) == 4
    host, port = tool.gateways.wheels[0].address.split(":")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as line:
        line.settimeout(0.3)
        for junk in (b"", b"\x01", b"\x00\x00\x00\x00", b"\x03\x00\x00\x00\xff\x00", bytes(600)):
            line.sendto(junk, (host, int(port)))
        with pytest.raises(TimeoutError):
            line.recv(64)
        line.sendto(b"\x02\x00\x00\x00\xff\x00", (host, int(port)))
        assert line.recv(64)[4] == 0xFF
