# SPDX-License-Identifier: Apache-2.0
"""Results that are kept by the content they were made of."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from hubsim import configuration
from regen_table import declarations, image, installation, schema, stored

MOTORS = installation.ROOT / "tools" / "motors"
LU2013 = schema.load(MOTORS / "lu2013.toml")


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "cache"
    monkeypatch.setenv(stored.VARIABLE, str(path))
    return path


def counted(results: list[bytes]) -> Callable[[], bytes]:
    return lambda: results.pop(0)


def test_a_result_is_made_once_for_the_same_content() -> None:
    make = counted([b"first", b"second"])
    assert stored.by_content("text", (b"a", b"b"), make) == b"first"
    assert stored.by_content("text", (b"a", b"b"), make) == b"first"
    assert stored.by_content("text", (b"ab", b""), make) == b"second"


def test_a_damaged_result_is_made_again(place: Path) -> None:
    make = counted([b"first", b"second"])
    stored.by_content("text", (b"a",), make)
    (file,) = place.iterdir()
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    assert stored.by_content("text", (b"a",), make) == b"second"
    assert stored.by_content("text", (b"a",), make) == b"second"


def test_a_place_that_cannot_be_written_costs_time_only(place: Path) -> None:
    place.write_text("a file")
    make = counted([b"first", b"second"])
    assert stored.by_content("text", (b"a",), make) == b"first"
    assert stored.by_content("text", (b"a",), make) == b"second"


def test_without_a_place_nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(stored.VARIABLE, "")
    assert stored.directory() is None
    make = counted([b"first", b"second"])
    stored.by_content("text", (b"a",), make)
    assert stored.by_content("text", (b"a",), make) == b"second"


def test_a_failure_leaves_nothing_behind(place: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        stored.by_content("text", (b"a",), lambda: bytes(1 // 0))
    assert not place.exists()


def test_the_oldest_results_go_when_there_are_many(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stored, "MOST_FILES", 4)
    for k in range(5):
        stored.by_content(f"text{k}", (b"a",), lambda: b"some")
        for file in place.glob(f"text{k}-*"):
            os.utime(file, (k, k))
    assert sorted(file.name.partition("-")[0] for file in place.iterdir()) == [
        "text2", "text3", "text4",
    ]  # fmt: skip


def test_kept_declarations_are_those_of_the_text(place: Path) -> None:
    text = "typedef struct { int a; double b[3]; } pair_t; enum { PAIR_SIZE = 7 };"
    for _ in range(2):
        ffi = declarations.known(text)
        assert ffi.sizeof("pair_t") == 8 + 3 * 8
        assert ffi.offsetof("pair_t", "b") == 8
        assert len(list(place.iterdir())) == 1


def test_declarations_that_are_none_are_refused() -> None:
    with pytest.raises(declarations.DeclarationError, match="parse error"):
        declarations.known("struct {")


def test_a_kept_image_is_the_computed_one_with_any_strategy(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(_: schema.Drive) -> bytes:
        raise AssertionError("computed although it was kept")

    computed = image.build(LU2013)
    monkeypatch.setattr(configuration, "_known", {})
    assert configuration.image_of(LU2013) == computed
    monkeypatch.setattr(configuration, "_known", {})
    monkeypatch.setattr(image, "build", refused)
    assert configuration.image_of(LU2013) == computed
    monkeypatch.setattr(configuration, "_known", {})
    with pytest.raises(AssertionError, match="although"):
        configuration.image_of(schema.load(MOTORS / "scooter48v.toml"))
