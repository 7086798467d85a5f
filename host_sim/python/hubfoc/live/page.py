# SPDX-License-Identifier: Apache-2.0
"""The page as one document: markup, style and scripts of the folder ``browser`` put together.

The scripts are ES modules there. Here they become one: in the order in which they need each other,
each a function that returns what it exports, so that a name is exported once only.
"""

import re
from functools import cache
from importlib.resources import files

from hubsim import report

IMPORT = re.compile(r'^import \{[^}]*\} from "\./([\w.]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:const|function|class) (\w+))", re.MULTILINE)
LIBRARY = "foreign/uPlot.js"


def _own(name: str) -> str:
    return (files(__package__) / "browser").joinpath(name).read_text(encoding="utf-8")


def modules(name: str = "main.js") -> list[str]:
    """Return the modules that one needs, it last, each after those that it needs itself."""
    order: list[str] = []
    for needed in IMPORT.findall(_own(name)):
        order += [found for found in modules(needed) if found not in order]
    return [*order, name]


def script() -> str:
    """Return all scripts as one module."""
    parts = []
    for name in modules():
        text = _own(name)
        exported = ", ".join(EXPORT.findall(text))
        body = EXPORT.sub("", IMPORT.sub("", text))
        parts.append(
            f"const {{ {exported} }} = (() => {{\n{body}return {{ {exported} }};\n}})();\n"
        )
    return "\n".join(parts)


@cache
def document() -> str:
    """Return the page."""
    palette = (files(report) / "palette.css").read_text(encoding="utf-8")
    style = palette + _own("foreign/uPlot.css") + _own("page.css")
    text = _own("index.html")
    for mark, content in (
        ("/* style */", style),
        ("/* library */", _own(LIBRARY)),
        ("/* script */", script()),
    ):
        text = text.replace(mark, content)
    return text
