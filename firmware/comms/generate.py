# SPDX-License-Identifier: Apache-2.0
"""Write what is made from hubfoc.dbc.

generated/hubfoc.h, generated/hubfoc.c and the message table of README.md; with the numbers of the
end-to-end protection (protection.py) generated/protection.h and the Python module
host_sim/python/hubsim/can_protocol.py; hubfoc_four_wheels.dbc, the same protocol with a message for
each wheel; and, before that, the DBC's own value tables of reasons and of ``waits_for`` from the
lists in firmware/core, its version and its attributes of the protection.

cantools' code, with two changes: without the date, so that equal protocols make equal files, and
without the range checks of physical values, which are the only floating point in it and which
nothing here calls. It keeps cantools' licence, MIT, whose text it carries.

    tools/dev python firmware/comms/generate.py            write
    tools/dev python firmware/comms/generate.py --check    only say whether everything is up to date
    tools/dev python firmware/comms/generate.py --base 0x320 --output DIR    both DBCs of a vehicle
                                                           with [vehicle] can_base = 0x320
"""

import argparse
import os
import re
import sys
import tempfile
import textwrap
from pathlib import Path

import cantools
import protection
from cantools.database.can import Database, Message, Signal
from cantools.database.can.c_source import generate

MODULE = Path(__file__).resolve().parent
DBC = MODULE / "hubfoc.dbc"
FOUR_WHEELS = MODULE / "hubfoc_four_wheels.dbc"
README = MODULE / "README.md"
CORE = MODULE.parent / "core" / "include" / "core"
PYTHON = MODULE.parents[1] / "host_sim/python/hubsim/can_protocol.py"
BEGIN = "<!-- from hubfoc.dbc by generate.py -->\n"
END = "<!-- end -->\n"

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
BIT_RATE_PER_S = 500_000
LINE_COLUMNS = 100
# Start, identifier, control, CRC, delimiters, acknowledge, end and intermission of a classic data
# frame (ISO 11898-1).
OVERHEAD_BITS = 47
# From the start bit to the end of the CRC a bit may be stuffed after the fifth equal one and then
# after every fourth.
STUFFED_OVERHEAD_BITS = 34


def longest_frame_bits(length_bytes: int) -> int:
    """Return the bits one frame takes on the bus with the most stuffing there can be."""
    stuffable = STUFFED_OVERHEAD_BITS + 8 * length_bytes
    return OVERHEAD_BITS + 8 * length_bytes + (stuffable - 1) // 4


def load_text(dbc: str) -> Database:
    """Load the protocol, strictly."""
    database = cantools.database.load_string(dbc, "dbc", strict=True)
    assert isinstance(database, Database)
    return database


def listed(header: str) -> str:
    """Return the numbers and names of a list in firmware/core as a DBC value table has them."""
    text = (CORE / header).read_text(encoding="utf-8")
    rows = re.findall(r"^\s*X\((\d+), (\w+), \"", text, re.MULTILINE)
    if not rows:
        raise ValueError(f"{header}: no list was found")
    pairs = sorted((int(number), name) for number, name in rows)
    return " ".join(f'{number} "{name}"' for number, name in pairs)


def with_value_tables(dbc: str) -> str:
    """Return the DBC with the value tables of its reasons made new."""
    for signal, header in ((r"\w*reason", "reason.h"), ("waits_for", "waits_for.h")):
        table = listed(header)
        dbc = re.sub(rf"^(VAL_ \d+ {signal}) [^;]*;", rf"\1 {table};", dbc, flags=re.MULTILINE)
    return dbc


def with_protection(dbc: str) -> str:
    """Return the DBC with version and attributes of the protection made new."""
    dbc = re.sub(r'^BA_ "E2E.*;\n', "", dbc, flags=re.MULTILINE)
    dbc = re.sub(r'^VERSION ".*"$', f'VERSION "{protection.VERSION}"', dbc, flags=re.MULTILINE)
    made = protection.attributes(load_text(dbc).messages, MODULE)
    return re.sub(r"(\A.*\nBA_ [^\n]*\n)", lambda found: found[1] + made, dbc, flags=re.DOTALL)


def moved(dbc: str, base: int) -> str:
    """Return the DBC with other identifiers: base instead of the one in the DBC."""

    def identifier(found: re.Match[str]) -> str:
        return f"{found[1]}{int(found[2]) + base - protection.BASE}"

    text = re.sub(
        r"^(BO_ |VAL_ |(?:CM_|BA_ \"\w+\") (?:BO_|SG_) )(\d+)\b",
        identifier,
        dbc,
        flags=re.MULTILINE,
    )
    return with_protection(text)


def _per_wheel(paragraph: str, each: set[int]) -> str:
    """Return a message's paragraph, or a line about one, once for each wheel it is of."""
    found = re.match(
        r"(BO_ |VAL_ |(?:CM_|BA_ \"\w+\") (?:BO_|SG_) )(\d+)\b(.*)", paragraph, re.DOTALL
    )
    if found is None:
        return paragraph
    start, identifier, rest = found[1], int(found[2]), found[3]
    if identifier not in each:
        receivers = ",".join(f"wheel_{wheel}" for wheel in WHEELS)
        return re.sub(r" wheel$", f" {receivers}", paragraph, flags=re.MULTILINE)
    text = ""
    for number, wheel in enumerate(WHEELS):
        own = re.sub(r" wheel$", f" wheel_{wheel}", rest, flags=re.MULTILINE)
        if start == "BO_ ":
            own = re.sub(r"\A (\w+):", rf" \1{wheel.title().replace('_', '')}:", own)
        text += f"{start}{identifier + number}{own}"
    return text


def four_wheels(dbc: str) -> str:
    """Return the DBC of a vehicle with four wheels, each with messages of its own."""
    messages = load_text(dbc).messages
    each = {message.frame_id for message in messages if message.senders != ["battery"]}
    parts = re.split(r"^(?=BO_ |VAL_ |CM_ |BA_)", dbc, flags=re.MULTILINE)
    text = "".join(_per_wheel(part, each) for part in parts)
    names = [wheel.replace("_", " ") for wheel in WHEELS]
    text = re.sub(
        r"^(BU_: .*) wheel$",
        rf"\1 {' '.join(f'wheel_{w}' for w in WHEELS)}",
        text,
        flags=re.MULTILINE,
    )
    comments = "".join(
        f'CM_ BU_ wheel_{wheel} "The hubfoc controller of the {name} wheel.";\n'
        for wheel, name in zip(WHEELS, names, strict=True)
    )
    text = re.sub(r'^CM_ BU_ wheel ".*";\n', comments, text, flags=re.MULTILINE)
    text = re.sub(
        r'^CM_ "hubfoc, one wheel.*";$',
        'CM_ "hubfoc, four wheels; made from hubfoc.dbc by'
        " generate.py. Every message carries a CRC and a counter:"
        " firmware/comms/README.md. A quantity of a wheel beyond its range is not sent as the end"
        ' of it but as NOT_AVAILABLE.";',
        text,
        flags=re.MULTILINE,
    )
    return with_protection(text)


def without_phys_range(text: str) -> str:
    """Take out what the checks that compute in floating point are, with their comments."""
    text = re.sub(
        r"/\*\*\n(?: \*[^\n]*\n)*? \*/\nbool \w+_is_in_phys_range\(double value\);\n\n",
        "",
        text,
    )
    return re.sub(
        r"bool \w+_is_in_phys_range\(double value\)\n\{\n.*?\n\}\n\n?",
        "",
        text,
        flags=re.DOTALL,
    )


def c_code(database: Database) -> dict[str, str]:
    """Return file name and text of the generated C."""
    header, source, _, _ = generate(
        database, "hubfoc", "hubfoc.h", "hubfoc.c", "", floating_point_numbers=False
    )
    dateless = [
        re.sub(r"(generated by cantools version \S+) [^\n]*\.\n", r"\1.\n", text)
        for text in (header, source)
    ]
    header, source = [without_phys_range(text).rstrip("\n") + "\n" for text in dateless]
    licence = "/* SPDX-License-Identifier: MIT */\n"
    return {"hubfoc.h": licence + header, "hubfoc.c": licence + source}


def load_share(database: Database, wheels: int) -> float:
    """Return the share of the bus that is taken when every frame is as long as it can be."""
    bits_per_s = 0.0
    for message in database.messages:
        senders = 1 if message.senders == ["battery"] else wheels
        bits_per_s += senders * longest_frame_bits(message.length) * 1000.0 / cycle_ms(message)
    return bits_per_s / BIT_RATE_PER_S


def cycle_ms(message: Message) -> int:
    """Return the cycle time, which every message has."""
    assert message.cycle_time, message.name
    return message.cycle_time


def number(value: float | int | None) -> str:
    """Return a number without a needless fraction."""
    return f"{value:.9g}"


def signal_row(signal: Signal) -> str:
    """Return the row of one signal: where, how fine, how far, what."""
    last = signal.start + signal.length - 1
    bits = f"{signal.start}" if signal.length == 1 else f"{signal.start} .. {last}"
    if signal.multiplexer_ids:
        bits += f"; `{signal.multiplexer_signal}` {signal.multiplexer_ids[0]}"
    listed = signal.choices and not signal.unit
    span = "" if listed else f"{number(signal.minimum)} .. {number(signal.maximum)}"
    step = number(signal.conversion.scale) if signal.unit else ""
    return (
        f"| `{signal.name}` | {bits} | {step} | {span} | {signal.unit or ''} | {signal.comment} |\n"
    )


def tables(database: Database) -> str:
    """Return the messages and their signals as Markdown."""
    lines = ["| identifier | message | from | every |\n", "|---|---|---|---|\n"]
    for message in database.messages:
        each = "" if message.senders == ["battery"] else " + wheel"
        lines.append(
            f"| `0x{message.frame_id:03X}`{each} | {message.name} | {message.senders[0]} |"
            f" {cycle_ms(message)} ms |\n"
        )
    load = (
        "With the most bit stuffing there can be, one wheel takes"
        f" {100 * load_share(database, 1):.1f} % of a bus of {BIT_RATE_PER_S // 1000} kbit/s, four"
        f" wheels {100 * load_share(database, len(WHEELS)):.1f} %, the battery's message included."
    )
    lines.append(f"\n{textwrap.fill(load, LINE_COLUMNS)}\n")
    for message in database.messages:
        about = textwrap.fill(f"**{message.name}**: {message.comment}", LINE_COLUMNS)
        lines.append(f"\n{about}\n\n")
        lines.append(
            "| signal | bits | step | range | unit | meaning |\n|---|---|---|---|---|---|\n"
        )
        signals = sorted(message.signals, key=lambda signal: signal.start)
        lines.extend(
            signal_row(signal) for signal in signals if signal.name not in ("crc", "counter")
        )
    return "".join(lines)


def readme(database: Database, text: str) -> str:
    """Return the README with its tables made new."""
    before, _, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise SystemExit(
            f"{README.name}: the lines {BEGIN.strip()} and {END.strip()} that enclose the message"
            " table are missing"
        )
    return f"{before}{BEGIN}\n{tables(database)}\n{END}{after}"


def base_of(text: str) -> int:
    """Return a base of the identifiers, within the range of config.h."""
    base = int(text, 0)
    if base % 32 or not 0 <= base <= 0x740:
        raise argparse.ArgumentTypeError(f"{text}, accepted: a multiple of 32, up to 0x740")
    return base


def write(path: Path, text: str) -> None:
    """Replace a file as a whole or not at all."""
    path.parent.mkdir(exist_ok=True)
    descriptor, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as file:
            file.write(text)
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def main() -> int:
    """Write or check everything."""
    parser = argparse.ArgumentParser(description="C code and message table from hubfoc.dbc")
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing; fail if something is out of date",
    )
    parser.add_argument("--output", type=Path, help="write the DBCs there, and nothing else")
    parser.add_argument(
        "--base", type=base_of, default=protection.BASE, help="[vehicle] can_base of those DBCs"
    )
    options = parser.parse_args()
    if options.base != protection.BASE and options.output is None:
        parser.error("--base: with --output DIR")
    try:
        dbc = with_protection(with_value_tables(DBC.read_text(encoding="utf-8")))
        database = load_text(dbc)
        if options.output is not None:
            options.output.mkdir(parents=True, exist_ok=True)
            of_vehicle = moved(dbc, options.base)
            write(options.output / DBC.name, of_vehicle)
            write(options.output / FOUR_WHEELS.name, four_wheels(of_vehicle))
            return 0
        wanted = {DBC: dbc, FOUR_WHEELS: four_wheels(dbc)}
        wanted |= {MODULE / "generated" / name: text for name, text in c_code(database).items()}
        wanted[MODULE / "generated/protection.h"] = protection.header()
        wanted[PYTHON] = protection.python_module(database, MODULE)
        wanted[README] = readme(database, README.read_text(encoding="utf-8"))
    except (OSError, ValueError, cantools.Error) as error:
        print(f"{DBC.name}: {' '.join(str(error).split())}", file=sys.stderr)
        return 1
    stale = [
        path
        for path, text in wanted.items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    ]
    if options.check:
        for path in stale:
            print(
                f"{path.relative_to(MODULE.parents[1])} is not what hubfoc.dbc makes; run tools/dev"
                " python firmware/comms/generate.py",
                file=sys.stderr,
            )
        return 1 if stale else 0
    for path in stale:
        write(path, wanted[path])
        print(f"wrote {path.relative_to(MODULE.parents[1])}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
