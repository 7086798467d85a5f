# SPDX-License-Identifier: Apache-2.0
"""Recorded steps of a controller (application/steps.h), and the controller that runs them again.

A step is a record of ``engine.STEP``: ``kind`` (BOOT, FAST, SLOW), ``reports`` and ``values``, raw
inputs first and then outputs in the order of ``variables``.
"""

from typing import Any, Self

from hubsim import variables
from hubsim.configuration import Configuration
from hubsim.controller import Controller
from hubsim.engine import STEP, STEP_VALUES, Steps, library
from hubsim.errors import HubsimError

BOOT, FAST, SLOW = range(3)
BOOT_VALUES = ("kept_temperature_cC", "hold_direction", "hold_leaves")
PORTS = {
    FAST: (variables.FAST_INPUT, variables.FAST_OUTPUT),
    SLOW: (variables.SLOW_INPUT, variables.SLOW_OUTPUT),
}

__all__ = ["BOOT", "FAST", "SLOW", "STEP", "STEP_VALUES", "Replay", "Steps", "inputs", "outputs"]


def inputs(kind: int) -> list[str]:
    """Return the raw names of what a kind of step is given, the first of its values."""
    return [row.raw_name for row in variables.of_port(PORTS[kind][0])]


def outputs(kind: int) -> list[str]:
    """Return the raw names of what a kind of step returns, the values behind its inputs."""
    return [row.raw_name for row in variables.of_port(PORTS[kind][1])]


class Replay:
    """One controller that runs recorded steps again."""

    def __init__(self) -> None:
        self._ffi, self._lib = library()
        handle = self._lib.hubsim_replay_new()
        if handle == self._ffi.NULL:
            raise HubsimError("no memory for a controller")
        self._handle: Any = self._ffi.gc(handle, self._lib.hubsim_replay_delete)

    def __enter__(self) -> Self:
        """Return the controller itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Free it."""
        self._ffi.release(self._handle)

    def configure(self, image: bytes) -> None:
        """Take a configuration from the next boot on."""
        status = self._lib.hubsim_replay_config(
            self._handle, self._ffi.from_buffer(image), len(image)
        )
        if status < 0:
            Controller(Configuration("replay", image))  # which names what the firmware refuses
            raise AssertionError("refused by one interface and not by the other")

    def run(self, recorded: Steps) -> Steps:
        """Run steps with their inputs; return them with what the controller returns now."""
        out = recorded.copy()
        if len(out) == 0:
            return out
        buffer = self._ffi.from_buffer("hubsim_step_t[]", out.data, require_writable=True)
        if self._lib.hubsim_replay_steps(self._handle, buffer, len(out)) < 0:
            raise HubsimError("not the steps of a controller, accepted: from a boot on")
        return out
