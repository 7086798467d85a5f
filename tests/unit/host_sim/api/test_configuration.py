# SPDX-License-Identifier: Apache-2.0
"""Configurations from TOML files and images; errors of either are reported in one line."""

from pathlib import Path

import hubsim
import pytest
from hubsim import configuration
from hubsim.engine import ROOT
from regen_table.schema import Drive

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"
IMAGE = ROOT / "firmware" / "config" / "generated" / "lu2013.bin"


def test_drive_file_and_flashed_image_give_the_same_configuration(
    config: hubsim.Configuration,
) -> None:
    image = hubsim.load_configuration(IMAGE)
    assert image.image == config.image
    assert image.name == config.name == "lu2013"
    assert config.drive is not None
    assert image.drive is None


def test_an_override_changes_the_drive_and_the_image(config: hubsim.Configuration) -> None:
    other = hubsim.load_configuration(
        LU2013, {"vehicle.mass_kg": 700.0, "motor.iron_loss_resistance_ohm": None}
    )
    assert other.drive is not None
    assert other.drive.vehicle.mass_kg == 700.0
    assert other.drive.motor.iron_loss_resistance_ohm is None
    assert other.image != config.image


@pytest.mark.parametrize(
    ("path", "settings", "message"),
    [
        ("nowhere.toml", None, "nowhere.toml: file not found"),
        ("nowhere.bin", None, "nowhere.bin: file not found"),
        (str(LU2013), {"mass_kg": 1.0}, "'mass_kg': accepted: section.key"),
        (str(LU2013), {"vehicle.mass_kg": -1.0}, "vehicle.mass_kg"),
        (str(LU2013), {"vehicle.colour": 1.0}, "colour"),
        (str(IMAGE), {"vehicle.mass_kg": 1.0}, "an image cannot be changed"),
    ],
)
def test_errors_are_reported_in_one_line_with_the_cause(
    path: str, settings: dict[str, float] | None, message: str
) -> None:
    with pytest.raises(hubsim.HubsimError) as caught:
        hubsim.load_configuration(path, settings)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_image_refused_by_the_firmware_is_reported_with_the_firmwares_text(
    config: hubsim.Configuration, tmp_path: Path
) -> None:
    damaged = bytearray(config.image)
    damaged[200] ^= 1
    path = tmp_path / "damaged.bin"
    path.write_bytes(damaged)
    with pytest.raises(hubsim.HubsimError, match="damaged: configuration refused"):
        hubsim.Controller(path)


def test_images_are_kept_by_what_a_flux_map_holds_not_by_its_path(
    config: hubsim.Configuration, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []

    def computed(drive: Drive) -> bytes:
        made.append(drive.motor.flux_map)
        return config.image

    monkeypatch.setenv("HUBFOC_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(configuration, "_computed", computed)
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    assert config.drive is not None
    motor = config.drive.motor
    for path, content, count in ((first, "1", 1), (second, "1", 1), (first, "2", 2)):
        path.write_text(content, encoding="utf-8")
        mapped = motor.model_copy(update={"flux_map": str(path)})
        configuration.image_of(config.drive.model_copy(update={"motor": mapped}))
        assert len(made) == count
