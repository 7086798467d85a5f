# SPDX-License-Identifier: Apache-2.0
"""A measuring tool finds the application's variables in the images, although they are optimised.

a2ltool reads the debugger's information as tools for measuring and calibration (ASAM MCD-2 MC) do.
It finds no variable of a source that is optimised with the whole image; app.c is not.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmark import elf

ROOT = Path(__file__).resolve().parents[2]
IMAGES = [Path(name) for name in os.environ["HUBFOC_IMAGES"].split(":")]
OUTPUT = "app.controller.fast.output"
BRIDGE_AT = 3 * 2
"""Bytes of three compare values in front of it (fast_output_t)."""


def address_of(image: Path, variable: str, scratch: Path) -> int:
    """Return the address that the tool gives to a variable."""
    a2l = scratch / "image.a2l"
    tool = Path(sys.executable).parent / "a2ltool"
    subprocess.run(
        [tool, "--create", "--elffile", image, "--measurement", variable, "--output", a2l],
        check=True,
        capture_output=True,
    )
    addresses = re.findall(r"ECU_ADDRESS (0x[0-9A-F]+)", a2l.read_text())
    assert len(addresses) == 1, f"{variable} in {image.name}: {addresses}"
    return int(addresses[0], 16)


def has_symbol(image: Path, prefix: str) -> bool:
    """Return whether a function or variable begins with this."""
    return any(name.startswith(prefix) for name in elf.symbols(image))


VESC_PACKETS = (9, 14, 15, 16, 27)  # of comms/vesc_status.c

# A row of the list by its first words: whether an image has what it names.
FOUND: dict[str, Callable[[Path], bool]] = {
    "XCP": lambda image: has_symbol(image, "xcp_"),
    "WheelEnergy": lambda image: has_symbol(image, "can_link_transmit_energy"),
    "VESC status frames": lambda image: bytes(VESC_PACKETS) in image.read_bytes(),
    "texts of reasons": lambda image: b"motor torque limit" in image.read_bytes(),
    "times of findings": lambda image: b"torque ramp + monitor." in image.read_bytes(),
    "flux maps": lambda image: b"no maps on this port" not in image.read_bytes(),
    "uncertainty of the torque estimate": lambda image: has_symbol(image, "torque_uncertainty_"),
}


def test_an_image_has_what_its_ports_readme_does_not_leave_out() -> None:
    readme = (ROOT / "hal" / "stm32g431" / "README.md").read_text(encoding="utf-8")
    left_out = readme.partition("## Left out")[2].partition("\n## ")[0]
    listed = re.findall(r"^\| (?!what|---)([\w ]+)", left_out, flags=re.MULTILINE)
    assert listed == list(FOUND)
    assert {image.stem.removeprefix("hubfoc_") for image in IMAGES} >= {"stm32f405", "stm32g431"}
    for image in IMAGES:
        for what, is_found in FOUND.items():
            assert is_found(image) == ("g431" not in image.stem), f"{what}: {image.stem}"


@pytest.mark.parametrize("image", IMAGES, ids=lambda image: image.stem)
def test_a_measuring_tool_finds_what_the_bridge_is_given(image: Path, tmp_path: Path) -> None:
    app = elf.symbols(image)["app"]
    first = address_of(image, f"{OUTPUT}.compare_counts[0]", tmp_path)
    assert app.address <= first < app.address + app.size
    assert address_of(image, f"{OUTPUT}.bridge", tmp_path) == first + BRIDGE_AT
