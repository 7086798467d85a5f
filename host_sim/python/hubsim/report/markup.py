# SPDX-License-Identifier: Apache-2.0
"""Elements of HTML and SVG as text that is escaped exactly once.

A plain ``str`` is text, a ``Markup`` is an element.
"""

import html
import json

_VOID = frozenset({"meta", "link", "br", "hr", "col"})


class Markup(str):
    """Text that is already HTML."""

    __slots__ = ()


Attribute = str | float | None


def number(value: float) -> str:
    """Return a coordinate with at most two decimals and no superfluous zero."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def element(tag: str, *children: str, **attributes: Attribute) -> Markup:
    """Make an element. ``class_`` is class, ``data_x`` is data-x.

    An attribute of None is left out.
    """
    written = []
    for key, value in attributes.items():
        if value is not None:
            text = value if isinstance(value, str) else number(value)
            written.append(f' {key.rstrip("_").replace("_", "-")}="{html.escape(text)}"')
    head = f"<{tag}{''.join(written)}>"
    return Markup(head if tag in _VOID else f"{head}{join(*children)}</{tag}>")


def join(*children: str) -> Markup:
    """Put children behind each other."""
    return Markup(
        "".join(
            child if isinstance(child, Markup) else html.escape(child, quote=False)
            for child in children
        )
    )


def data(value: object) -> Markup:
    """Make an element that holds a value as JSON for a script.

    Nothing in it can end the element.
    """
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace(
        "<", "\\u003c"
    )
    return element("script", Markup(text), type="application/json")


def picture(
    identity: str,
    title: str,
    description: str,
    width: float,
    height: float,
    *children: str,
    class_: str,
) -> Markup:
    """Make an SVG that a screen reader announces by its title and description."""
    return element(
        "svg",
        element("title", title, id=f"{identity}-title"),
        element("desc", description, id=f"{identity}-desc"),
        *children,
        class_=class_,
        role="img",
        aria_labelledby=f"{identity}-title {identity}-desc",
        viewBox=f"0 0 {number(width)} {number(height)}",
    )
