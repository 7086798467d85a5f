# SPDX-License-Identifier: Apache-2.0
"""Contracts of public functions: read from their headers, proved with CBMC.

A contract is the `@pre` and `@post` lines of the comment before a declaration, each one C
expression. `result` is what the function returns, `old(expression)` a value before the call.

    python contracts.py list
    python contracts.py without > without_contract.txt
    python contracts.py prove CBMC FUNCTION [--reached]
"""

import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

PROOFS = Path(__file__).resolve().parent
FIRMWARE = PROOFS.parents[1] / "firmware"
MODULES = ("torque", "monitor", "modes", "controller")
WITHOUT = PROOFS / "without_contract.txt"
WITHOUT_HEAD = """\
# SPDX-License-Identifier: Apache-2.0
# Public functions of torque, monitor, modes and controller without a contract that is proved.
"""
CHECKS = (
    "--signed-overflow-check",
    "--undefined-shift-check",
    "--div-by-zero-check",
    "--bounds-check",
    "--pointer-check",
    "--unwind",
    "70",
    "--unwinding-assertions",
)
_FUNCTION = re.compile(
    r"(?:/\*(?P<comment>(?:(?!\*/).)*)\*/\s*)?^(?P<result>(?:static inline )?\w+(?: \*| ))"
    r"(?P<name>[a-z]\w+)\((?P<parameters>[^()]*)\)\s*[;{]",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True)
class Contract:
    """A public function with its preconditions and postconditions, which may be missing."""

    header: Path
    name: str
    result: str
    parameters: tuple[str, ...]
    pre: tuple[str, ...]
    post: tuple[str, ...]

    def harness(self) -> str:
        """Return a proof: any parameters that meet the preconditions, the call, what follows."""
        olds: list[str] = []

        def kept(match: re.Match[str]) -> str:
            olds.append(match[1])
            return f"old_{len(olds)}"

        post = [re.sub(r"\bold\(((?:[^()]|\([^()]*\))*)\)", kept, line) for line in self.post]
        lines = [f'#include "{self.header.relative_to(FIRMWARE).as_posix().split("include/")[1]}"']
        lines += [
            '#include "core/q15.h"',
            '#include "proof.h"',
            f"void prove_{self.name}(void)",
            "{",
        ]
        names = []
        for parameter in self.parameters:
            match = re.fullmatch(r"(.*?)(\*?)\s*(\w+)", parameter)
            assert match is not None
            kind, star, name = match.groups()
            kind = kind.replace("const ", "").strip()
            names.append(name)
            if star:
                lines += [
                    f"    {kind} {name}_object;",
                    f"    {kind} *const {name} = &{name}_object;",
                ]
            else:
                lines += [f"    {kind} {name};"]
        lines += [f"    ASSUME({line});" for line in self.pre]
        lines += [f"    const __typeof__({old}) old_{n} = {old};" for n, old in enumerate(olds, 1)]
        call = f"{self.name}({', '.join(names)});"
        lines += [
            f"    {call}" if self.result == "void" else f"    const {self.result} result = {call}"
        ]
        lines += [f"    PROVE({line});" for line in post]
        return "\n".join([*lines, "    PROOF_END();", "}", ""])


def _lines(comment: str, tag: str) -> tuple[str, ...]:
    text = re.sub(r"\n\s*\*", "\n", comment)
    found = re.findall(rf"@{tag}\s+(.*?)(?=@pre|@post|\n\s*\n|\Z)", text, re.DOTALL)
    return tuple(" ".join(line.split()) for line in found)


def read(header: Path) -> list[Contract]:
    """Return the functions of a header."""
    out = []
    for match in _FUNCTION.finditer(header.read_text(encoding="utf-8")):
        comment = match["comment"] or ""
        parameters = " ".join(match["parameters"].split())
        given = () if parameters == "void" else tuple(parameters.split(", "))
        result = match["result"].replace("static inline ", "").strip()
        pre, post = _lines(comment, "pre"), _lines(comment, "post")
        out.append(Contract(header, match["name"], result, given, pre, post))
    return out


def public() -> dict[str, Contract]:
    """Return the public functions of the modules that have contracts, by name."""
    headers = (path for name in MODULES for path in FIRMWARE.glob(f"{name}/include/*/*.h"))
    return {one.name: one for header in sorted(headers) for one in read(header)}


def bare() -> list[str]:
    """Return the public functions without a contract."""
    return sorted(name for name, one in public().items() if not one.post)


def sources(contract: Contract) -> list[Path]:
    """Return what the function is made of: its module, and core without what proofs replace."""
    module = contract.header.relative_to(FIRMWARE).parts[0]
    own = contract.header.stem
    files = [FIRMWARE / module / f"{own}.c"]
    if own == "monitor":
        files = [FIRMWARE / module / f"{part}.c" for part in ("monitor_fast", "monitor_slow")]
        files += [FIRMWARE / module / f"monitor_{part}.c" for part in ("emf", "speed")]
        files += [FIRMWARE / module / "safe_state.c"]
    core = [FIRMWARE / "core" / f"{part}.c" for part in ("fault", "isqrt", "divide", "scaled")]
    return [path for path in files if path.is_file()] + core


def prove(cbmc: str, name: str, reached: bool) -> int:
    """Run the checker on one contract; with `reached`, on whether its inputs are possible."""
    contract = public()[name]
    with tempfile.TemporaryDirectory() as folder:
        harness = Path(folder) / f"contract_{name}.c"
        harness.write_text(contract.harness(), encoding="utf-8")
        includes = [f"-I{PROOFS}", *(f"-I{path}" for path in FIRMWARE.glob("*/include"))]
        includes += [f"-I{path}" for path in FIRMWARE.iterdir() if path.is_dir()]
        command = [cbmc, "--function", f"prove_{name}", *includes, str(harness)]
        command += [str(path) for path in sources(contract)]
        if reached:
            command += ["-DPROOF_EXPECT_REACHED", "--no-standard-checks", "--unwind", "70"]
        else:
            command += [*CHECKS, "--verbosity", "4"]
        return subprocess.run(command, check=False).returncode


def main() -> int:
    """List the functions with a contract or those without, or prove one."""
    match sys.argv[1:]:
        case ["list"]:
            print("\n".join(name for name, one in public().items() if one.post))
            return 0
        case ["without"]:
            print(WITHOUT_HEAD + "\n".join(bare()))
            return 0
        case ["prove", cbmc, name, *rest]:
            return prove(cbmc, name, rest == ["--reached"])
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
