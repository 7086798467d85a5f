# SPDX-License-Identifier: Apache-2.0
"""Worst-case depth of the stack.

From the compiler's own figures and the call graph of the linked program.

``python3 stack_report.py --elf firmware.elf --objects DIR --limit BYTES --root main --interrupt
adc_handler ...``

The compiler writes (``-fcallgraph-info=su``) what each function puts on the stack: of a program
that is optimised whole when it is linked, beside the program; of a file that it compiles apart,
beside the object. Functions of the run-time library, which come compiled, are measured by the
instructions that move the stack pointer. Whatever is called must be in the program: an unknown name
is an error, as a call through a pointer is, and no path of zero bytes.

Each interrupt that can preempt the ones before it adds its own worst path and the frame that the
core pushes; one with a stack of its own adds that frame alone. Calls that a function makes before
interrupts are enabled (``--before-interrupts CALLER:CALLED,...``) are a case of their own, with the
faults of the core (``--own-stack``) on top. The result also goes into ``firmware.stack.json``
beside the program.

Standard library only, because it runs after every link of the firmware.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmark import elf as elf_reader

EXCEPTION_FRAME_BYTES = 8 * 4 + 4
"""Eight registers and, at worst, a word of alignment (ARMv7-M, B1.5.6).

No floating-point state: the firmware uses none.
"""

_NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
_BYTES = re.compile(r"(\d+) bytes \((\w+)[^)]*\)")


@dataclass(frozen=True)
class CallPath:
    """A chain of calls and the stack it takes."""

    bytes: int
    functions: tuple[str, ...]


class StackError(Exception):
    """The depth cannot be bounded.

    Recursion, a call through a pointer, or stack of variable size.
    """


def _frames_of(graphs: Iterable[Path]) -> dict[str, int]:
    """Stack of every function in call graphs, in bytes; of several with one name, the largest."""
    frames: dict[str, int] = {}
    for path in sorted(graphs):
        for title, label in _NODE.findall(path.read_text(errors="replace")):
            size = _BYTES.search(label)
            if not size:
                continue
            if size.group(2) == "dynamic":
                raise StackError(f"{title}: stack of variable size")
            name = title.rsplit(":", maxsplit=1)[-1]
            frames[name] = max(frames.get(name, 0), int(size.group(1)))
    return frames


def compiled_frames(elf: Path, objects: list[Path]) -> dict[str, int]:
    """Stack of every function the compiler reported, in bytes.

    What was optimised with the whole program has the figure of its link; anything else that of its
    object.
    """
    linked = _frames_of(elf.parent.glob(f"{elf.name}.ltrans*.ci"))
    apart = _frames_of(
        found
        for directory in objects
        for found in directory.rglob("*.ci")
        if ".ltrans" not in found.name
    )
    return apart | linked


def function_named(name: str, functions: dict[str, elf_reader.Function]) -> elf_reader.Function:
    """Return a function of the program, or raise StackError."""
    if name not in functions:
        raise StackError(f"{name}: no such function in the program")
    return functions[name]


def worst_path(
    start: str,
    functions: dict[str, elf_reader.Function],
    frames: dict[str, int],
    left_out: frozenset[tuple[str, str]] = frozenset(),
) -> CallPath:
    """Deepest chain of calls from a function, without the calls that are left out."""
    known: dict[str, CallPath] = {}

    def visit(name: str, above: tuple[str, ...]) -> CallPath:
        if name in above:
            raise StackError("recursion: " + " -> ".join([*above[above.index(name) :], name]))
        if name not in known:
            function = function_named(name, functions)
            if function.indirect:
                raise StackError(f"{name}: calls through a pointer")
            if function.variable:
                raise StackError(f"{name}: stack of variable size")
            # A library function is measured by its instructions.
            own = max(frames.get(name.partition("@")[0], 0), function.pushed_bytes)
            deepest = CallPath(0, ())
            for called in sorted(function.calls):
                if (name, called) not in left_out:
                    below = visit(called, (*above, name))
                    deepest = max(deepest, below, key=lambda path: path.bytes)
            known[name] = CallPath(own + deepest.bytes, (name, *deepest.functions))
        return known[name]

    return visit(start, ())


@dataclass(frozen=True)
class Cases:
    """What does not add up with everything else."""

    early: frozenset[tuple[str, str]] = frozenset()
    """Calls before interrupts are enabled."""
    own_stack: tuple[str, ...] = ()
    """Interrupts that leave the stack alone after the core's frame."""


def report(
    elf: Path, objects: list[Path], root: str, interrupts: list[str], cases: Cases | None = None
) -> list[tuple[str, CallPath]]:
    """Worst path of the root and of each interrupt, the core's frame included in the latter.

    The first row of two or more is the root with interrupts, without the early calls.
    """
    cases = cases or Cases()
    functions = elf_reader.functions(elf)
    for caller, called in sorted(cases.early):
        if caller not in functions or called not in functions[caller].calls:
            raise StackError(f"no call of {called} by {caller} in the program")
    frames = compiled_frames(elf, objects)
    if not frames:
        raise StackError(
            f"no .ci files in {', '.join(map(str, objects))}; compile with -fcallgraph-info=su"
        )
    elsewhere = frozenset(
        (name, called)
        for name in cases.own_stack
        for called in function_named(name, functions).calls
    )
    left_out = cases.early | elsewhere
    rows = [(root, worst_path(root, functions, frames, left_out))]
    for name in interrupts:
        path = (
            CallPath(0, (name,))
            if name in cases.own_stack
            else worst_path(name, functions, frames, left_out)
        )
        rows.append((name, CallPath(path.bytes + EXCEPTION_FRAME_BYTES, path.functions)))
    return rows


def early_case(
    elf: Path, objects: list[Path], root: str, rows: list[tuple[str, CallPath]], cases: Cases
) -> list[tuple[str, CallPath]]:
    """Return the root with its early calls, and the interrupts that come on any stack."""
    path = worst_path(root, elf_reader.functions(elf), compiled_frames(elf, objects))
    return [(root, path), *(row for row in rows[1:] if row[0] in cases.own_stack)]


def result_of(elf: Path) -> Path:
    """Return where the result for a program is."""
    return elf.with_suffix(".stack.json")


def write(elf: Path, total: int, limit: int, rows: list[tuple[str, CallPath]]) -> None:
    """Write the result beside the program."""
    found = {
        "bytes": total,
        "reserved": limit,
        "paths": [
            {"from": name, "bytes": path.bytes, "through": path.functions[1:]}
            for name, path in rows
        ],
    }
    result_of(elf).write_text(json.dumps(found, indent=2) + "\n")


def main(arguments: list[str] | None = None) -> int:
    """Print the table; exit status 1 if the sum exceeds the limit or cannot be bounded."""
    parser = argparse.ArgumentParser(description="Worst-case stack depth of a linked firmware.")
    parser.add_argument("--elf", type=Path, required=True)
    parser.add_argument(
        "--objects",
        type=Path,
        required=True,
        action="append",
        help="where the compiler left its .ci files",
    )
    parser.add_argument("--root", default="main")
    parser.add_argument(
        "--interrupt", action="append", default=[], help="from the lowest priority to the highest"
    )
    parser.add_argument(
        "--own-stack", action="append", default=[], help="an interrupt that has one, the highest"
    )
    parser.add_argument(
        "--before-interrupts",
        action="append",
        default=[],
        metavar="CALLER:CALLED,...",
        help="calls before interrupts are enabled",
    )
    parser.add_argument("--limit", type=int, required=True, help="bytes the linker script reserves")
    options = parser.parse_args(arguments)
    early = {
        (caller, called)
        for caller, _, names in (text.partition(":") for text in options.before_interrupts)
        for called in names.split(",")
    }
    cases = Cases(frozenset(early), tuple(options.own_stack))
    interrupts = [*options.interrupt, *options.own_stack]
    try:
        rows = report(options.elf, options.objects, options.root, interrupts, cases)
        if early:
            alone = early_case(options.elf, options.objects, options.root, rows, cases)
            rows = max(rows, alone, key=lambda case: sum(path.bytes for _, path in case))
    except StackError as error:
        print(f"stack_report: {options.elf.name}: {error}", file=sys.stderr)
        return 1
    total = sum(path.bytes for _, path in rows)
    write(options.elf, total, options.limit, rows)
    print(f"Stack, worst case: {total} of {options.limit} bytes")
    for name, path in rows:
        print(f"{path.bytes:7d}  {name}: {' > '.join(path.functions[1:])}")
    if total > options.limit:
        print(
            f"stack_report: {options.elf.name}: {total} bytes may be needed, {options.limit} are"
            " there",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
