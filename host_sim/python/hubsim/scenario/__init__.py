# SPDX-License-Identifier: Apache-2.0
"""What a run does and must show: scenarios, events, criteria, cycles, named faults, settings."""

from hubsim.scenario.schema import DIRECTORY, Scenario, accepted, builtin_names, load

__all__ = ["DIRECTORY", "Scenario", "accepted", "builtin_names", "load"]
