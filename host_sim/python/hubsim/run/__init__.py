# SPDX-License-Identifier: Apache-2.0
"""One run: from drive and scenario to accounts, signals, criteria, and files of them."""

from regen_table import STRATEGIES

from hubsim.run.simulation import matching, prepare, simulate, timeline

__all__ = ["STRATEGIES", "matching", "prepare", "simulate", "timeline"]
