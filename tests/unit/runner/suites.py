# SPDX-License-Identifier: Apache-2.0
"""Write the sources of one program that runs the tests of several files.

python suites.py FOLDER TEST.c...   writes FOLDER/suite_NAME.c for each test_NAME.c, and the table

Each test file is included in a source of its own, in which setUp, tearDown and the tests are
static: files of one program may use the same names. A file that is up to date is not written.
"""

import re
import sys
from collections.abc import Sequence
from pathlib import Path

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_TEST = re.compile(r"^void (test_\w+)\(\s*void\)", re.MULTILINE)
_MOCK = re.compile(r'^#include "(mock_\w+)\.h"', re.MULTILINE)


def name_of(path: Path) -> str:
    """Return the name of a test file's suite: torque_limits for test_torque_limits.c."""
    return path.stem.removeprefix("test_")


def _without_comments(text: str) -> str:
    """Return C without comments, its lines at their places."""
    return _COMMENT.sub(lambda match: "\n" * match[0].count("\n"), text)


def _all_of(name: str, mocks: Sequence[str], action: str) -> list[str]:
    calls = [f"    {mock}_{action}();" for mock in mocks]
    return [f"static void {name}(void)", "{", *calls, "}", ""]


def suite(path: Path) -> str:
    """Return the source that holds a test file and the list of its tests."""
    text = _without_comments(path.read_text(encoding="utf-8"))
    tests = [(match[1], text.count("\n", 0, match.start()) + 1) for match in _TEST.finditer(text)]
    if not tests:
        sys.exit(f"{path}: no test")
    mocks = list(dict.fromkeys(_MOCK.findall(text)))
    functions = ["setUp", "tearDown", *(name for name, _ in tests)]
    lines = ["/* Written by tests/unit/runner/suites.py. */"]
    lines += [f"static void {name}(void);" for name in functions]
    lines += [f'#include "{path}"', '#include "suite.h"', ""]
    hooks = ["begin_mocks", "verify_mocks", "end_mocks"]
    if mocks:
        for hook, action in zip(hooks, ("Init", "Verify", "Destroy"), strict=True):
            lines += _all_of(hook, mocks, action)
    lines += ["static const suite_test_t TESTS[] = {"]
    lines += [f'    {{{name}, "{name}", {line}}},' for name, line in tests]
    lines += ["};", "", f"const suite_t suite_{name_of(path)} = {{"]
    lines += [f'    .name = "{name_of(path)}",', f'    .file = "{path}",']
    lines += ["    .set_up = setUp,", "    .tear_down = tearDown,"]
    lines += [f"    .{hook} = {hook}," for hook in hooks if mocks]
    return "\n".join([*lines, "    .tests = TESTS,", f"    .count = {len(tests)},", "};", ""])


def table(names: Sequence[str]) -> str:
    """Return the source with the list of a program's suites."""
    lines = ["/* Written by tests/unit/runner/suites.py. */", '#include "suite.h"', ""]
    lines += [f"extern const suite_t suite_{name};" for name in names]
    lines += ["", "const suite_t *const SUITES[] = {"]
    lines += [f"    &suite_{name}," for name in names]
    return "\n".join([*lines, "};", f"const int SUITE_COUNT = {len(names)};", ""])


def main(folder: Path, paths: Sequence[Path]) -> None:
    """Write what has changed."""
    written = {f"suite_{name_of(path)}.c": suite(path) for path in paths}
    written["suites.c"] = table([name_of(path) for path in paths])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in written.items():
        file = folder / name
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(argument) for argument in sys.argv[2:]])
