# SPDX-License-Identifier: Apache-2.0
"""What was proved is known by its content, and nothing else is."""

import shutil
from collections.abc import Callable
from pathlib import Path

import prove
import proved
import pytest
from run_tests import known

HOLDS = "** Results:\\n[p.assertion.1] line 1 assertion x: SUCCESS\\nVERIFICATION SUCCESSFUL\\n"
SOURCE = '#include "limit.h"\nint limited(int x) { return x > LIMIT ? LIMIT : x; }\n'
PROOF = """
#include "proof.h"
void prove_sum(void)
{
    const int32_t x = any_within(0, %s);
    PROVE(x + x >= x);
    PROOF_END();
}
"""


class Run:
    """A source, and a checker that prints a given text and counts how often it is started."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.source = place / "one.c"
        self.source.write_text(SOURCE, encoding="utf-8")
        self.header = place / "limit.h"
        self.header.write_text("#define LIMIT 3\n", encoding="utf-8")
        self.flags = ["--function", "prove_limited"]
        self.expected = "it holds"
        self.checker("6.6.0", HOLDS)

    def checker(self, version: str, printed: str) -> None:
        text = (
            f'#!/bin/sh\n[ "$1" != --version ] || {{ echo {version}; exit; }}\n'
            f'echo "$@" >>{self.place}/starts\ncat "$1" >{self.place}/read\nprintf \'{printed}\'\n'
        )
        self.cbmc = self.place / f"cbmc-{version}"
        self.cbmc.write_text(text, encoding="utf-8")
        self.cbmc.chmod(0o755)

    def starts(self) -> int:
        """Check once, and return how often the checker has been started so far."""
        arguments = [str(self.source), f"-I{self.place}", *self.flags]
        self.outcome = proved.check(
            str(self.cbmc), arguments, prove.holds, "one", self.expected, self.place
        )
        log = self.place / "starts"
        return len(log.read_text(encoding="utf-8").splitlines()) if log.is_file() else 0

    def prepend(self, file: Path, text: str) -> None:
        file.write_text(text + file.read_text(encoding="utf-8"), encoding="utf-8")


@pytest.fixture(name="run")
def make_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    monkeypatch.setattr(known, "STORE", tmp_path / "known")
    monkeypatch.delenv("HUBFOC_NO_CACHE", raising=False)
    return Run(tmp_path)


def test_the_same_content_is_checked_once(run: Run) -> None:
    assert run.starts() == 1
    assert not run.outcome.cached
    assert run.starts() == 1
    assert run.outcome == proved.Outcome((), cached=True)


def test_the_checker_reads_the_text_that_was_hashed(run: Run) -> None:
    run.starts()
    assert "x > 3 ? 3 : x" in (run.place / "read").read_text(encoding="utf-8")


CHANGES: dict[str, Callable[[Run], object]] = {
    "a source": lambda run: run.prepend(run.source, "int other;\n"),
    "a header": lambda run: run.header.write_text("#define LIMIT 4\n", encoding="utf-8"),
    "a flag": lambda run: run.flags.append("--bounds-check"),
    "the function": lambda run: run.flags.append("--function prove_other"),
    "a definition": lambda run: run.flags.append("-Dx=y"),
    "what is expected": lambda run: setattr(run, "expected", "it fails"),
    "the checker's version": lambda run: run.checker("6.7.0", HOLDS),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_change_is_checked_again_and_the_way_back_is_known(run: Run, what: str) -> None:
    run.starts()
    before = {file: file.read_text(encoding="utf-8") for file in (run.source, run.header)}
    flags, expected, cbmc = list(run.flags), run.expected, run.cbmc
    CHANGES[what](run)
    assert run.starts() == 2
    assert run.starts() == 2
    for file, text in before.items():
        file.write_text(text, encoding="utf-8")
    run.flags, run.expected, run.cbmc = flags, expected, cbmc
    assert run.starts() == 2


def test_comments_and_the_folder_of_generated_sources_change_nothing(run: Run) -> None:
    run.starts()
    run.prepend(run.source, "/* How a limit\n * works. */\n\n")
    run.prepend(run.header, "\n/* A limit. */\n")
    assert run.starts() == 1
    other = run.place / "elsewhere"
    other.mkdir()
    for file in (run.source, run.header):
        shutil.copy(file, other)
    run.prepend(run.source, "static const char *const file = __FILE__;\n")
    run.prepend(other / "one.c", "static const char *const file = __FILE__;\n")
    assert run.starts() == 2
    place, run.place = run.place, other
    run.source = other / "one.c"
    run.starts()
    assert run.outcome.cached
    assert len((place / "starts").read_text(encoding="utf-8").splitlines()) == 2


def test_a_failed_run_is_never_known(run: Run) -> None:
    run.checker("6.6.0", "[p.assertion.1] line 1 assertion x: FAILURE\\nVERIFICATION FAILED\\n")
    assert run.starts() == 1
    assert run.outcome.wrong
    assert run.starts() == 2
    run.checker("6.6.0", "")  # stopped
    assert run.starts() == 3
    run.checker("6.6.0", HOLDS)
    assert run.starts() == 4
    assert not run.outcome.wrong


def test_a_source_that_does_not_compile_fails(run: Run) -> None:
    run.header.unlink()
    assert run.starts() == 0
    assert any("limit.h" in line for line in run.outcome.wrong)


def test_without_the_cache_everything_is_checked(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    run.starts()
    monkeypatch.setenv("HUBFOC_NO_CACHE", "1")
    assert run.starts() == 2
    monkeypatch.delenv("HUBFOC_NO_CACHE")
    assert run.starts() == 2


@pytest.mark.parametrize(
    ("most", "wrong"),
    [
        ("1000", None),
        ("INT32_MAX", "overflow"),  # the sum
        ("-1", "no input meets the assumptions"),
    ],
)
def test_a_proof_holds_for_some_input_and_for_every_one(
    run: Run, capsys: pytest.CaptureFixture[str], most: str, wrong: str | None
) -> None:
    cbmc = shutil.which("cbmc") or str(proved.ROOT / ".dev/cbmc/cbmc")
    run.source.write_text(PROOF % most, encoding="utf-8")
    arguments = [f"-I{Path(__file__).parent}", str(run.source), "--signed-overflow-check"]
    for before in ("", " before (cached)"):
        status = prove.prove(cbmc, "sum", arguments)
        printed = capsys.readouterr().out
        assert status == (0 if wrong is None else 1)
        if wrong is None:
            assert printed == f"1 proof proved{before}: sum\n"
        else:
            assert wrong in printed
            assert "proof proved" not in printed
