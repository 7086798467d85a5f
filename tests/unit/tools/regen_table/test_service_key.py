# SPDX-License-Identifier: Apache-2.0
"""The key of the lock of XCP: in its file, in an image, and nowhere else."""

import shutil
import stat
from collections.abc import Callable
from pathlib import Path

import pytest
from regen_table import cli, generate, image, layout, schema, service_key
from regen_table.errors import ConfigurationError

ROOT = Path(__file__).resolve().parents[4]


def test_a_drawn_key_is_its_owners_and_is_never_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [tmp_path / "a.key", tmp_path / "b.key"]
    for path in files:
        assert cli.main(["key", str(path)]) == 0
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    keys = [service_key.read(path) for path in files]
    assert keys[0] != keys[1]
    assert {len(key) for key in keys} == {16}
    assert cli.main(["key", str(files[0])]) == 2
    assert service_key.read(files[0]) == keys[0]
    shown = "".join(capsys.readouterr())
    assert "exists" in shown
    assert keys[0].hex() not in shown


@pytest.mark.parametrize("text", ["", "0" * 32, "12345678" * 3, "g" * 32, "12" * 17, "\u00e4"])
def test_what_is_no_key_is_refused_without_being_shown(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.key"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError, match="32 hexadecimal digits") as refusal:
        service_key.read(path)
    assert not text or text not in str(refusal.value)
    with pytest.raises(ConfigurationError, match="cannot be read"):
        service_key.read(tmp_path / "none.key")


def test_an_image_has_the_key_behind_its_checksum_and_only_there(tmp_path: Path) -> None:
    key = bytes(range(16))
    (tmp_path / "wheel.key").write_text(key.hex().upper() + "\n", encoding="ascii")
    toml = tmp_path / "mine.toml"
    shutil.copy(ROOT / "tools" / "motors" / "lu2013.toml", toml)
    plain = generate.artefacts(schema.load(toml))
    with toml.open("a", encoding="utf-8") as file:
        file.write('\n[service]\nkey = "wheel.key"\n')
    drive = schema.load(toml)
    made = generate.artefacts(drive)
    at = layout.load().ffi.offsetof("config_t", "service_key")
    assert made.image == plain.image[:at] + key
    assert plain.image[at:] == bytes(16) == image.build(drive)[at:]
    source = made.files["mine.c"].decode()
    assert ".service_key = {0x03020100, 0x07060504, 0x0B0A0908, 0x0F0E0D0C}," in source
    assert "service_key" not in plain.files["mine.c"].decode()


def test_the_base_of_xcp_is_below_every_message(change: Callable[..., schema.Drive]) -> None:
    assert change({"service.can_base": 0x1A0}).service.can_base == 0x1A0
    for refused in (0x198, 0x1A4):
        with pytest.raises(ConfigurationError, match="0, or a multiple of 8 of at least 416"):
            change({"service.can_base": refused})
