# SPDX-License-Identifier: Apache-2.0
"""A broken thermistor need not end the ride: firmware/motor/README.md, Thermal model."""

from pathlib import Path

from winding_rows import error_k


def test_the_model_that_the_plant_has_follows_it_within_a_kelvin(tmp_path: Path) -> None:
    """Its own steps of 64 ms and the numbers of the configuration are all that differs."""
    assert error_k(tmp_path, "ebike36v", {}) < 1.0


def test_an_insulation_a_fifth_worse_than_configured_leaves_the_estimate_within_15_k(
    tmp_path: Path,
) -> None:
    assert error_k(tmp_path, "ebike36v", {"winding_thermal_resistance_k_per_w": 0.48}) < 15.0
