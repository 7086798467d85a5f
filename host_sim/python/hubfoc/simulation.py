# SPDX-License-Identifier: Apache-2.0
"""The simulated world of a virtual vehicle, reached through its local service."""

import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

from hubfoc.errors import HubfocError

TIMEOUT_S = 30.0
LOOK_S = 0.05


class Simulation:
    """Road, battery, faults and scenario of a vehicle that ``hubfoc live`` runs.

    Parameters
    ----------
    url : str
        What ``hubfoc live`` printed; the token in it is the permission.

    >>> world = Simulation(url)
    >>> world.set(slope=0.05, friction=0.3)
    >>> world.fault("current_a_dead", wheel="rear_left")
    >>> world.fault("current_a_dead", on=False)
    """

    def __init__(self, url: str) -> None:
        self._url = url if url.endswith("/") else f"{url}/"
        self.state()

    def state(self) -> dict[str, Any]:
        """Return time_s, slope, friction, soc, temperature_c, faults, scenario, paused, ended."""
        return dict(self._ask("simulation"))

    def set(self, **settings: float) -> dict[str, Any]:
        """Change the world from now on, and return its state.

        Parameters
        ----------
        settings
            ``slope``: rise over run, positive uphill. ``friction``: of tyre and road. ``soc``:
            state of charge, 0 to 1. ``temperature_c``: of windings and switches; where the
            scenario lets them warm up by themselves it has no effect.
        """
        return self._change(settings)

    def faults(self) -> list[dict[str, Any]]:
        """Return every fault: name, group, text, one_wheel, and refused: why it cannot be."""
        return list(self._ask("faults"))

    def fault(self, name: str, *, on: bool = True, wheel: str | None = None) -> dict[str, Any]:
        """Let a fault be there, in all wheels or in one, or be there no more."""
        return self._change({"fault": name, "on": on, "wheel": wheel})

    def scenarios(self) -> dict[str, str]:
        """Return the built-in scenarios by name, with what they are."""
        return dict(self._ask("scenarios"))

    def scenario(self, name: str | None) -> dict[str, Any]:
        """Begin again with a scenario, whose driver drives; None: the vehicle stands."""
        return self._change({"scenario": name})

    def record(self, file: str | Path) -> dict[str, Any]:
        """Begin again, from the boot on with a recording into a new ``.parquet`` or ``.csv``."""
        return self._change({"record": str(Path(file).absolute())})

    def stop_recording(self) -> dict[str, Any]:
        """Complete the recording, while the vehicle goes on."""
        state = self._change({"record": None})
        while state["completes"]:
            time.sleep(LOOK_S)
            state = self.state()
        if state["recording_failed"]:
            raise HubfocError(state["recording_failed"])
        return state

    def pause(self) -> dict[str, Any]:
        """Let the time stand: nothing moves, and nothing is sent on the bus."""
        return self._change({"paused": True})

    def go_on(self) -> dict[str, Any]:
        """Let the time run again."""
        return self._change({"paused": False})

    def _change(self, wanted: Mapping[str, Any]) -> dict[str, Any]:
        return dict(self._ask("simulation", json.dumps(wanted).encode()))

    def _ask(self, what: str, body: bytes | None = None) -> Any:  # noqa: ANN401, JSON
        request = Request(self._url + what, body, {"Content-Type": "application/json"})
        try:
            with urlopen(request, timeout=TIMEOUT_S) as answer:
                return json.load(answer)
        except HTTPError as error:
            raise HubfocError(_objection(error)) from error
        except (URLError, OSError, ValueError) as error:
            raise HubfocError(f"{self._url}: no virtual vehicle answers, accepted: the address "
                              "that 'hubfoc live' prints") from error  # fmt: skip


def _objection(error: HTTPError) -> str:
    try:
        return str(json.load(error)["error"])
    except (ValueError, KeyError, TypeError):
        return f"{error.url}: {error.reason}"
