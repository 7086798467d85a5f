# SPDX-License-Identifier: Apache-2.0
"""The page's view of a wheel's parameters: read and stored by XCP, through its lock."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from hubsim import configuration, engine
from regen_table.schema import Drive

from hubfoc import addresses
from hubfoc.errors import HubfocError
from hubfoc.service import Service, Udp, values_of

SHOWN_VALUES = 8
OFF_S = 3.0  # until a wheel that is switched off makes no torque
RESTART_S = 10.0
WAIT_S = 0.1
RUNNING = ("RUN", "LIMP")


def rows(address: str, drive: Drive) -> list[dict[str, Any]]:
    """Return every field of the configuration in force: name, values, those of the file, range."""
    image = configuration.image_of(drive)
    with Service(Udp(address)) as wheel:
        found = wheel.values()
    return [
        {
            "name": field.name,
            "values": found[field.name],
            "file": values_of(image, field),
            "unit": "" if field.info.unit == "1" else field.info.unit,
            "lowest": field.info.lowest,
            "highest": field.info.highest,
            "text": field.info.text,
        }
        for field in addresses.fields()
        if field.info.count <= SHOWN_VALUES  # the two maps come from the drive as wholes
    ]


def store(address: str, key: bytes, values: Mapping[str, Sequence[int]]) -> None:
    """Have a wheel that is switched off check values, keep them and restart with them."""
    with Service(Udp(address)) as wheel:
        _await_off(wheel)
        wheel.unlock(key)
        for name, wanted in values.items():
            wheel.write(name, [int(value) for value in wanted])
        wheel.store()
    end_s = time.monotonic() + RESTART_S
    while time.monotonic() < end_s:
        time.sleep(WAIT_S)
        try:
            with Service(Udp(address)) as wheel:
                found = wheel.values()
        except HubfocError:  # it restarts
            continue
        if all(found[name] == list(wanted) for name, wanted in values.items()):
            return
    raise HubfocError("stored, but the wheel has not come back with it: its shell says why")


def _await_off(wheel: Service) -> None:
    end_s = time.monotonic() + OFF_S
    while engine.mode_text(wheel.signal("output.mode")) in RUNNING:
        if time.monotonic() > end_s:
            raise HubfocError("the wheel is switched on, accepted: while nobody drives, at rest")
        time.sleep(WAIT_S)
    if not wheel.signal("output.standstill"):
        raise HubfocError("the wheel turns, accepted: at rest")
