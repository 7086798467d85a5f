# SPDX-License-Identifier: Apache-2.0
"""Reads written pages back: the page as a tree, SVG paths as points."""

import math
from dataclasses import dataclass, field
from html.parser import HTMLParser

VOID = {"meta", "link", "br", "hr", "col", "img"}


@dataclass
class Node:
    """An element with everything inside."""

    tag: str
    attributes: dict[str, str]
    children: list["Node"] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str = "", class_: str = "") -> list["Node"]:
        """Return every element below with a tag and a class."""
        found = []
        for child in self.children:
            if tag in ("", child.tag) and (
                not class_ or class_ in child.attributes.get("class", "").split()
            ):
                found.append(child)
            found += child.all(tag, class_)
        return found

    def words(self) -> str:
        """Return all text inside, children behind the element's own."""
        return " ".join([self.text, *[child.words() for child in self.children]]).strip()


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.root = Node("", {})
        self.open = [self.root]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert len({key for key, _ in attrs}) == len(attrs), f"{tag} says an attribute twice"
        node = Node(tag, {key: value or "" for key, value in attrs})
        self.open[-1].children.append(node)
        if tag not in VOID:
            self.open.append(node)

    def handle_endtag(self, tag: str) -> None:
        assert self.open[-1].tag == tag, f"</{tag}> closes <{self.open[-1].tag}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        self.open[-1].text += data


def read(text: str) -> Node:
    """Parse a page; elements must be closed in the correct order."""
    reader = _Reader()
    reader.feed(text)
    reader.close()
    assert len(reader.open) == 1, f"<{reader.open[-1].tag}> is never closed"
    return reader.root


@dataclass
class Step:
    """One command of a path: end point, and the radius of an arc."""

    command: str
    x: float
    y: float
    radius: float = math.nan


def steps(data: str) -> list[Step]:
    """Follow the pen along path data with the commands M L H V v A Z, numbers apart by spaces."""
    tokens = data.split()
    found: list[Step] = []
    x = y = 0.0
    place = 0

    def take(count: int) -> list[float]:
        nonlocal place
        values = [float(token) for token in tokens[place : place + count]]
        place += count
        assert all(map(math.isfinite, values))
        return values

    while place < len(tokens):
        command = tokens[place]
        place += 1
        radius = math.nan
        if command in "ML":
            x, y = take(2)
        elif command == "H":
            (x,) = take(1)
        elif command == "V":
            (y,) = take(1)
        elif command == "v":
            y += take(1)[0]
        elif command == "A":
            radius, _, _, _, _, x, y = take(7)
        else:
            assert command == "Z", f"{command} in {data}"
        found.append(Step(command, x, y, radius))
    return found
