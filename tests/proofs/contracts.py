# SPDX-License-Identifier: Apache-2.0
"""Contracts of functions: prototypes of the headers, clauses of contracts/MODULE.h (README.md).

python contracts.py list
python contracts.py without > without_contract.txt
"""

import re
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

PROOFS = Path(__file__).resolve().parent
FIRMWARE = PROOFS.parents[1] / "firmware"
MODULES = ("motor", "torque", "monitor", "modes", "pedals", "controller")
# Beside them, of other modules.
OTHER_HEADERS = ("app/include/app/recorder.h", "config/include/config/demand_age.h",
                 "config/include/config/finding_times.h")  # fmt: skip
WITHOUT = PROOFS / "without_contract.txt"
WITHOUT_HEAD = """\
# SPDX-License-Identifier: Apache-2.0
# Public functions without a contract that is proved, of the modules that have contracts.
"""
# A private header whose functions are in the sources of a public one.
SAME_SOURCES = {"motor/feasible_ellipse": "motor/feasible_torque"}
_FUNCTION = re.compile(
    r"^(?P<result>(?:static inline |const )?\w+(?: \*| ))"
    r"(?P<name>[a-z]\w+)\((?P<parameters>[^()]*)\)\s*[;{]",
    re.MULTILINE,
)
# A clause begins a line; the lines that go on with it are indented.
_CLAUSE = re.compile(
    r"^(?P<kind>PRE|POST)\((?P<name>\w+), (?P<text>.*(?:\n[ \t]+.*)*)\)$", re.MULTILINE
)
_PARAMETER = re.compile(
    r"(?P<const>const )?(?P<type>\w+) (?P<star>\*?)(?:restrict )?(?P<name>\w+)"
    r"(?:\[(?P<count>\w+)\])?"
)


@dataclass(frozen=True)
class Parameter:
    """One parameter; `count` is the length of an array, empty otherwise."""

    const: bool
    type: str
    pointer: bool
    name: str
    count: str

    @property
    def written(self) -> bool:
        """Whether the function may write what it points to."""
        return self.pointer and not self.const


@dataclass(frozen=True)
class Contract:
    """A function with its preconditions and postconditions, which may be missing."""

    header: Path
    name: str
    result: str
    parameters: tuple[Parameter, ...]
    pre: tuple[str, ...]
    post: tuple[str, ...]
    inline: bool

    @property
    def part(self) -> str:
        """The header's module and name, such as torque/limit."""
        parts = self.header.relative_to(FIRMWARE).parts
        own = f"{parts[0]}/{self.header.stem}"
        return SAME_SOURCES.get(own, own)


Clauses = dict[str, dict[str, list[str]]]


def parse(text: str) -> Clauses:
    """Return the clauses of a text: by function, then by kind (PRE, POST)."""
    out: Clauses = {}
    for match in _CLAUSE.finditer(text):
        of_function = out.setdefault(match["name"], {"PRE": [], "POST": []})
        of_function[match["kind"]].append(" ".join(match["text"].split()))
    return out


@cache
def clauses() -> Clauses:
    """Return the clauses of all functions."""
    files = sorted((PROOFS / "contracts").glob("*.h"))
    return parse("".join(path.read_text(encoding="utf-8") for path in files))


def _parameter(text: str, arrays: dict[str, str]) -> Parameter:
    match = _PARAMETER.fullmatch(text)
    assert match is not None, text
    name = match["name"]
    count = match["count"] or (arrays.get(name, "") if match["star"] else "")
    return Parameter(bool(match["const"]), match["type"], bool(match["star"] or count), name, count)


# Pointers to the first of several objects, by name.
ARRAYS = {"lines": "TORQUE_LINE_COUNT"}


def read(header: Path, given_clauses: Clauses | None = None) -> list[Contract]:
    """Return the functions of a header, with the given clauses or those of contracts/."""
    stated = clauses() if given_clauses is None else given_clauses
    out = []
    for match in _FUNCTION.finditer(header.read_text(encoding="utf-8")):
        parameters = " ".join(match["parameters"].split())
        given = () if parameters == "void" else tuple(parameters.split(", "))
        result = match["result"].replace("static inline ", "").strip()
        own = stated.get(match["name"], {"PRE": [], "POST": []})
        pre, post = tuple(own["PRE"]), tuple(own["POST"])
        named = tuple(_parameter(one, ARRAYS) for one in given)
        inline = match["result"].startswith("static")
        out.append(Contract(header, match["name"], result, named, pre, post, inline))
    return out


def public() -> dict[str, Contract]:
    """Return the public functions of the modules that have contracts, by name."""
    headers = [path for name in MODULES for path in FIRMWARE.glob(f"{name}/include/*/*.h")]
    headers += [FIRMWARE / name for name in OTHER_HEADERS]
    return {one.name: one for header in sorted(headers) for one in read(header)}


def _of_the_modules() -> list[Path]:
    patterns = (f"{module}/{headers}" for module in MODULES for headers in ("include/*/*.h", "*.h"))
    own = [path for pattern in patterns for path in FIRMWARE.glob(pattern)]
    return own + [FIRMWARE / name for name in OTHER_HEADERS]


@cache
def known() -> dict[str, Contract]:
    """Return every function with a contract: public ones, private ones, those of core."""
    headers = [*FIRMWARE.glob("core/include/core/*.h"), *_of_the_modules()]
    return {one.name: one for header in sorted(headers) for one in read(header) if one.post}


# Of foc, called as they are.
AS_THEY_ARE = ("foc_report_copy", "foc_report_complete", "foc_view")


@cache
def without_promise() -> dict[str, Contract]:
    """Return the functions of the modules without a contract: anything may follow their call.

    Those of foc, the checksum of config and the square root of core as well, which have none.
    """
    others = ("foc/include/foc/foc.h", "config/include/config/validate.h",
              "core/include/core/isqrt.h")  # fmt: skip
    headers = [*_of_the_modules(), *(FIRMWARE / other for other in others)]
    return {one.name: one for header in sorted(headers) for one in read(header)
            if not one.post and not one.inline and not one.result.endswith("*")
            and one.name not in AS_THEY_ARE}  # fmt: skip


def bare() -> list[str]:
    """Return the public functions without a contract."""
    return sorted(name for name, one in public().items() if not one.post)


def main() -> int:
    """List the functions with a contract or those without."""
    match sys.argv[1:]:
        case ["list"]:
            print("\n".join(name for name, one in public().items() if one.post))
            return 0
        case ["without"]:
            print(WITHOUT_HEAD + "\n".join(bare()))
            return 0
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
