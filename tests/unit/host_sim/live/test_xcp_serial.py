# SPDX-License-Identifier: Apache-2.0
"""XCP on a wheel's serial line, spoken by pyxcp over the virtual vehicle's pseudo terminal."""

import logging
import time
from typing import Any

import pytest
import serial  # type: ignore[import-untyped]
from hubfoc import addresses
from pyxcp.config import create_application_from_config
from pyxcp.master.master import Master
from pyxcp.types import XcpResponseError
from siphash import key_of

from tests.unit.host_sim.live.support import TIMEOUT_S, running
from tests.unit.host_sim.live.test_xcp import FIELDS, IN_FORCE, OF_TOOL, PLACES, STAGING

WHEEL = 1
READY = 3
DAQ_CONFIG = 0x2A


def prompt_of(line: serial.Serial, command: str, expected: bytes) -> None:
    """Type a command and read its answer until the prompt behind it."""
    line.write(command.encode() + b"\r")
    seen, end_s = b"", time.monotonic() + TIMEOUT_S
    while expected not in seen or not seen.endswith(b"> "):
        seen += line.read(256)
        assert time.monotonic() < end_s, seen


def master_of(line: serial.Serial, key: bytes) -> Any:  # noqa: ANN401
    application = create_application_from_config(
        {
            "Transport": {
                "SxI": {
                    "header_format": "HEADER_LEN_CTR_BYTE",
                    "tail_format": "CHECKSUM_BYTE",
                }
            },
            "General": {
                "disable_error_handling": True,
                "seed_n_key_function": lambda _, seed: key_of(key, seed),
            },
        },
        log_level=logging.ERROR,
    )
    application.transport.timeout = 20.0
    return Master("sxi", config=application, transport_layer_interface=line)


def word(master: Any, address: int) -> int:  # noqa: ANN401
    return int.from_bytes(master.shortUpload(4, address), "little", signed=True)


def test_a_public_tool_measures_and_calibrates_over_the_shell_s_line() -> None:
    with running() as own, serial.Serial(own.serial[WHEEL], timeout=0.1) as line:
        prompt_of(line, "xcp", b"XCP")
        master = master_of(line, own.world.vehicle.key)
        master.transport.connect()
        master.connect()
        assert master.slaveProperties.maxDto == 8
        assert master.identifier(1).startswith("hubfoc-")
        end_s = time.monotonic() + TIMEOUT_S
        while word(master, PLACES["output.mode"]) != READY:
            assert time.monotonic() < end_s
        volts = word(master, PLACES["output.bus_voltage_v"]) / 1000.0
        assert volts == pytest.approx(own.value("bus.voltage_v"), abs=0.5)
        at = FIELDS["driver.lost_hold_ms"]
        before = word(master, at)
        master.cond_unlock("calpag")
        master.setCalPage(OF_TOOL, 0, STAGING)
        master.setMta(at)
        master.download((before + 7).to_bytes(4, "little"))
        assert word(master, at) == before + 7
        master.setCalPage(OF_TOOL, 0, IN_FORCE)
        assert word(master, at) == before
        master.setMta(addresses.PAGE)
        page = bytes(master.fetch(addresses.page_bytes()))
        place = at - addresses.PAGE
        assert page[place : place + 4] == before.to_bytes(4, "little")
        master.setDaqPtr(0, 0, 0)
        master.writeDaq(0xFF, 4, 0, PLACES["output.speed_rad_per_s"])
        master.setDaqListMode(0x10, 0, 0, 1, 0)
        with pytest.raises(XcpResponseError) as refusal:
            master.startStopDaqList(1, 0)
        assert int(refusal.value.args[0]) == DAQ_CONFIG
        master.disconnect()
        master.transport.close()
        prompt_of(line, "version", b"hubfoc")
