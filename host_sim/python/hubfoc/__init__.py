# SPDX-License-Identifier: Apache-2.0
"""A vehicle with hubfoc controllers: a virtual one, and a client of its CAN bus, real or virtual.

>>> from hubfoc import Vehicle
>>> with Vehicle("udp_multicast") as car:
...     car.demand(brake_nm=40)
...     print(car.front_left.status())
"""

from hubfoc.client import Vehicle, WheelStatus
from hubfoc.counterparts import Bms, BrakeSystem
from hubfoc.errors import HubfocError
from hubfoc.simulation import Simulation

__all__ = ["Bms", "BrakeSystem", "HubfocError", "Simulation", "Vehicle", "WheelStatus"]
