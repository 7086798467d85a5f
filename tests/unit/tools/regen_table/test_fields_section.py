# SPDX-License-Identifier: Apache-2.0
"""[fields]: values of the image that a file gives as such."""

import re
from pathlib import Path

import pytest
from regen_table import image, installation, layout, schema
from regen_table.errors import ConfigurationError


def test_a_field_has_the_value_that_the_file_gives(tmp_path: Path) -> None:
    """In the image, and nothing else but the checksum behind it."""
    base = installation.drive_file("lu2013")
    path = tmp_path / base.name
    text = f'{base.read_text(encoding="utf-8")}\n[fields]\n"driver.lost_hold_ms" = 250\n'
    path.write_text(text, encoding="utf-8")
    own, other = (image.build(schema.load(file)) for file in (base, path))
    header = layout.load().ffi
    begin = header.offsetof("config_t", "driver")
    begin += header.offsetof("config_driver_t", "lost_hold_ms")
    checksum = header.offsetof("config_t", "crc32")
    assert own[:begin] == other[:begin]
    assert other[begin : begin + 4] == (250).to_bytes(4, "little")
    assert own[begin + 4 : checksum] == other[begin + 4 : checksum]
    assert own[checksum : checksum + 4] != other[checksum : checksum + 4]


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ('"driver.lost_hold" = 1', "unknown field 'driver.lost_hold', did you mean driver."),
        ('"driver.lost_hold_ms" = 10001', "10001, accepted: 0 to 10000 ms"),
        ('"driver.lost_hold_ms" = [1]', "accepted: a whole number"),
        ('"pedals.lowest_q15" = [1]', "accepted: a list of 4 whole numbers"),
        ('"driver.lost_hold_ms" = 1.5', "1.5 is not accepted"),
    ],
)
def test_what_is_no_field_is_refused(tmp_path: Path, line: str, why: str) -> None:
    path = tmp_path / "own.toml"
    text = installation.drive_file("lu2013").read_text(encoding="utf-8")
    path.write_text(f"{text}\n[fields]\n{line}\n", encoding="utf-8")
    with pytest.raises(ConfigurationError, match=re.escape(why)) as refused:
        schema.load(path)
    assert str(refused.value).startswith(f"{path}: fields")
