# SPDX-License-Identifier: Apache-2.0
"""Every JSON, page, Parquet and MDF file contains its provenance."""

import json
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from asammdf import MDF
from hubsim import cli, configuration, engine, reasons
from regen_table import installation, schema

DATE = "2026-03-01T10:20:30Z"
QUICK = ("--set", "initial_speed_kmh=5", "--set", "demand_nm=60", "--set", "seed=7")
KEYS = {
    "program", "version", "commit", "configuration", "configuration_crc32", "scenario", "seed",
    "date",
}  # fmt: skip


def expected(scenario: str = "stop", seed: int = 7, changes: str = "") -> dict[str, Any]:
    """Derive the provenance from the image of the configuration."""
    drive = schema.load(cli.DEFAULT_CONFIG)
    assert not changes
    return {
        "program": "hubfoc",
        "version": installation.version(),
        "commit": installation.commit(),
        "configuration": "lu2013",
        "configuration_crc32": installation.crc32(configuration.image_of(drive)),
        "scenario": scenario,
        "seed": seed,
        "date": DATE,
    }


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a directory with one run in every format, and the page made of it."""
    directory = tmp_path_factory.mktemp("run")
    outputs = [
        text
        for kind, ending in (("json", "json"), ("parquet", "parquet"), ("mdf", "mf4"))
        for text in (f"--{kind}", str(directory / f"run.{ending}"))
    ]
    assert cli.main(["run", "stop", *QUICK, "--date", DATE, *outputs]) == 0
    page = str(directory / "run.html")
    assert cli.main(["report", str(directory / "run.json"), "-o", page]) == 0
    return directory


def test_the_json_contains_its_provenance(written: Path) -> None:
    found = json.loads((written / "run.json").read_text(encoding="utf-8"))
    assert found["provenance"] == expected()


def test_the_parquet_table_contains_its_provenance(written: Path) -> None:
    metadata = pq.read_schema(written / "run.parquet").metadata
    assert json.loads(metadata[b"provenance"]) == expected()


def test_the_mdf4_file_contains_its_provenance_and_starts_at_its_date(written: Path) -> None:
    with MDF(written / "run.mf4") as file:
        assert file.start_time == datetime.fromisoformat(DATE).astimezone(UTC)
        comment = file.header.comment
    found = dict(re.findall(r'<e name="(\w+)">([^<]*)</e>', comment))
    assert found == {key: str(value) for key, value in expected().items()} | {
        "strategy": "series_optimal"
    }


def test_the_page_contains_its_provenance_as_text_and_as_data(written: Path) -> None:
    text = (written / "run.html").read_text(encoding="utf-8")
    for key, value in expected().items():
        assert f'<meta name="hubfoc-{key}" content="{value}">' in text
        if key != "program":
            assert f"<code>{value}</code>" in text


def test_a_page_of_a_result_without_provenance_contains_that_of_the_call(
    tmp_path: Path, written: Path
) -> None:
    found = json.loads((written / "run.json").read_text(encoding="utf-8"))
    del found["provenance"]
    (tmp_path / "old.json").write_text(json.dumps(found), encoding="utf-8")
    page = tmp_path / "page.html"
    assert cli.main(["report", str(tmp_path / "old.json"), "-o", str(page), "--date", DATE]) == 0
    text = page.read_text(encoding="utf-8")
    for key in ("version", "commit", "configuration", "scenario", "date"):
        assert f'<meta name="hubfoc-{key}" content="{expected()[key]}">' in text


def test_the_crc_equals_that_of_the_controllers_image(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    changed = ("--set", "motor.max_phase_current_a=74", "--json", str(path))
    assert cli.main(["run", "stop", *QUICK, "--date", DATE, *changed]) == 0
    found = json.loads(path.read_text(encoding="utf-8"))["provenance"]
    assert found["configuration_crc32"] != expected()["configuration_crc32"]
    assert re.fullmatch(r"0x[0-9A-F]{8}", found["configuration_crc32"])


def test_summary_sweep_and_comparison_contain_their_provenance(tmp_path: Path) -> None:
    (tmp_path / "hop.csv").write_text("time_s,speed_km_h\n0,0\n5,20\n9,0\n", encoding="utf-8")
    hop = tmp_path / "hop.toml"
    hop.write_text('cycle = "hop.csv"\nseed = 3\n', encoding="utf-8")
    assert cli.main(["sim", "--scenario", str(hop), "--output", str(tmp_path), "--date", DATE]) == 0
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    for found in (summary["provenance"], *(run["provenance"] for run in summary["runs"])):
        assert set(found) == KEYS
        assert (found["scenario"], found["seed"], found["date"]) == ("hop", 3, DATE)
    assert f'content="{DATE}"' in (tmp_path / "index.html").read_text(encoding="utf-8")

    grid = str(tmp_path / "grid.parquet")
    vary = ("--vary", "demand_nm=60,80", "--workers", "1", "--seed", "5")
    assert cli.main(["sweep", "stop", *vary, "--output", grid, "--date", DATE]) == 0
    metadata = pq.read_schema(grid).metadata
    assert json.loads(metadata[b"provenance"]) == expected(seed=5)

    difference_path = str(tmp_path / "difference.json")
    assert (
        cli.main(["compare", "stop", "stop", *QUICK, "--json", difference_path, "--date", DATE])
        == 0
    )
    compared = json.loads(Path(difference_path).read_text(encoding="utf-8"))
    assert compared["provenance"]["date"] == DATE
    assert [side["provenance"] for side in compared["sides"]] == [expected(), expected()]
    assert len(compared["differences"]) > 10


def test_repeated_calls_with_one_date_write_identical_bytes(tmp_path: Path) -> None:
    names = ("json", "parquet", "mf4")
    for side in ("a", "b"):
        outputs = [
            text
            for kind, name in zip(("json", "parquet", "mdf"), names, strict=True)
            for text in (f"--{kind}", str(tmp_path / f"{side}.{name}"))
        ]
        assert cli.main(["run", "stop", *QUICK, "--date", DATE, *outputs]) == 0
    for name in ("parquet", "mf4"):
        assert (tmp_path / f"a.{name}").read_bytes() == (tmp_path / f"b.{name}").read_bytes()
    a, b = (json.loads((tmp_path / f"{side}.json").read_text(encoding="utf-8")) for side in "ab")
    del a["realtime_factor"], b["realtime_factor"]
    assert a == b


@pytest.mark.parametrize("call", [("run", "stop", *QUICK), ("compare", "stop", "stop", *QUICK)])
def test_an_invalid_date_is_an_error_in_one_line(
    capsys: pytest.CaptureFixture[str], call: tuple[str, ...]
) -> None:
    assert cli.main([*call, "--date", "yesterday"]) == 2
    assert "'yesterday', accepted: ISO 8601" in capsys.readouterr().err


def test_reasons_and_modes_of_a_measurement_convert_to_their_texts(written: Path) -> None:
    table = pq.read_table(written / "run.parquet")
    with MDF(written / "run.mf4") as file:
        for name, text in (("reason", engine.reason_text), ("mode", engine.mode_text)):
            raw = file.get(f"wheel0.{name}", raw=True)
            codes = table[f"wheel0.{name}"].to_numpy()
            assert np.array_equal(raw.samples, codes)
            shown = file.get(f"wheel0.{name}").samples
            assert [s.decode() for s in shown] == [text(code) for code in codes]
            assert len(set(codes)) > 1 or name == "mode"
            known = json.loads(table.schema.field(f"wheel0.{name}").metadata[b"codes"])
            assert {int(code): difference_path for code, difference_path in known.items()}[
                int(codes[0])
            ] == text(codes[0])
        conversion = file.get("wheel0.reason", raw=True).conversion
    converted = conversion.convert(np.array(sorted(reasons.codes().values()), dtype=float))
    texts = [engine.reason_text(code) for code in sorted(reasons.codes().values())]
    assert [s.decode() if isinstance(s, bytes) else str(s) for s in converted] == texts
