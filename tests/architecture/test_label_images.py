# SPDX-License-Identifier: Apache-2.0
"""Every label's configuration is one for the board that it proposes, and each board links with it.

The check is the one that ``tools/dev firmware`` makes; the image is built as it builds one, in a
tree of its own, so that no build directory is configured anew.
"""

import csv
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from regen_table import boards, cli, schema

ROOT = Path(__file__).resolve().parents[2]
ROWS = list(csv.DictReader((ROOT / "tools/motors/labels.csv").read_text("utf-8").splitlines()))
CHECK = """
set -euo pipefail
ROOT=$1 VENV=$1/none CMOCK_PREFIX=/none CBMC_PREFIX=/none
source "$ROOT/tools/setup/common.sh"
source "$ROOT/tools/setup/build.sh"
check_board firmware "$2" "$3" "$4"
"""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a tree with this one's files and a folder of its own for configurations."""
    root = tmp_path_factory.mktemp("tree")
    own = ("firmware", "firmware/config")
    for folder in ("", *own):
        (root / folder).mkdir(exist_ok=True)
        for entry in (ROOT / folder).iterdir():
            inside = entry.relative_to(ROOT)
            hidden = entry.name.startswith(".") or entry.name == "build"
            if not hidden and inside.as_posix() not in (*own, "firmware/config/generated"):
                (root / inside).symlink_to(entry)
    shutil.copytree(ROOT / "firmware/config/generated", root / "firmware/config/generated")
    return root


@pytest.fixture(scope="module")
def proposed(tree: Path) -> dict[str, str]:
    """Make every label's configuration in the tree; return those that propose a board."""
    found = {}
    for row in ROWS:
        options = [
            word
            for option, value in row.items()
            if value and option not in ("name", "source")
            for word in (f"--{option}", value)
        ]
        path = tree / f"{row['name']}_label.toml"
        assert cli.main(["new", path.stem, *options, "-o", str(path)]) == 0
        if (board := schema.load(path).inverter.board) is not None:
            generated = str(tree / "firmware/config/generated")
            assert cli.main(["generate", str(path), "-o", generated]) == 0
            found[path.stem] = board
    return found


def port_of(board: str) -> str:
    return next(iter((ROOT / "hal").glob(f"stm32*/boards/{board}.h"))).parents[1].name


def checked(tree: Path, board: str, name: str) -> str:
    """Return what ``tools/dev firmware`` says against a configuration, "" where it is accepted."""
    command = ["bash", "-c", CHECK, "check", str(tree), port_of(board), board, name]
    result = subprocess.run(command, check=False, capture_output=True, text=True)
    assert (result.returncode == 0) == (result.stderr == ""), result.stderr
    return result.stderr


def linked(tree: Path, folder: Path, board: str, name: str) -> Iterator[Path]:
    """Build the image of a board with a configuration; yield what can be flashed."""
    port = port_of(board)
    options = [f"-DHUBFOC_BOARD={board}", f"-DHUBFOC_CONFIG={name}", "-DHUBFOC_TESTS=OFF"]
    commands = (
        ["cmake", "--preset", port, "-S", str(tree), "-B", str(folder), *options],
        ["cmake", "--build", str(folder), "--target", f"hubfoc_{port}"],
    )
    for command in commands:
        result = subprocess.run(command, cwd=tree, check=False, capture_output=True, text=True)
        assert result.returncode == 0, result.stdout[-3000:] + result.stderr[-3000:]
    for suffix in ("elf", "bin", "hex"):
        yield folder / f"hubfoc_{port}.{suffix}"


@pytest.fixture(autouse=True)
def _cross_compiler() -> None:
    assert shutil.which("arm-none-eabi-gcc"), "./tools/dev setup arm installs the cross compiler"


def test_every_label_is_for_the_board_that_it_proposes_and_for_no_other(
    tree: Path, proposed: dict[str, str]
) -> None:
    assert len(proposed) > len(ROWS) // 2
    others = {"b_g431b_esc1": "vesc6_mk3"}
    for name, board in proposed.items():
        assert checked(tree, board, name) == "", name
        other = others.get(board, "b_g431b_esc1")
        assert f"{name} is for another board" in checked(tree, other, name)


def test_each_proposed_board_has_an_image_with_a_label_s_configuration(
    tree: Path, proposed: dict[str, str], tmp_path: Path
) -> None:
    for board in sorted(set(proposed.values())):
        assert board in boards.known()
        name = next(label for label, of in proposed.items() if of == board)
        configuration = (tree / f"firmware/config/generated/{name}.bin").read_bytes()
        images = list(linked(tree, tmp_path / board, board, name))
        assert all(image.stat().st_size > 0 for image in images)
        assert configuration in images[1].read_bytes(), board
