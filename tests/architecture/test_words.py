# SPDX-License-Identifier: Apache-2.0
"""Names use the terms of motor control, not private words of the project."""

import io
import re
import tokenize

from modules import code_only
from test_repository import own_text

# Ordinary words of a sentence, also of the sentence that is a test's name, but no parts of a name.
NOT_IN_NAMES = frozenset(
    (
        *("behind", "doubt", "heard", "held", "nearer", "nothing", "said", "told"),
        *("house", "patience", "reach", "river", "room", "verdict", "wish"),
    )
)
PERMITTED_NAMES = re.compile(r"room_temperature|^test_", re.IGNORECASE)


def identifiers(name: str, text: str) -> list[str]:
    """Return the names in a C or Python file, without comments and strings."""
    if name.endswith(".py"):
        tokens = tokenize.generate_tokens(io.StringIO(text).readline)
        return [token.string for token in tokens if token.type == tokenize.NAME]
    return re.findall(r"\b[A-Za-z_]\w*", code_only(text))


def refused(names: list[str]) -> list[str]:
    """Return the names that have one of the refused words as a part."""
    return sorted(
        {
            name
            for name in names
            if NOT_IN_NAMES & set(name.lower().split("_")) and not PERMITTED_NAMES.search(name)
        }
    )


def test_names_are_terms_of_the_field() -> None:
    texts = {
        name: text for name, text in own_text().items() if re.search(r"\.(?:[ch]|[ch]pp|py)$", name)
    }
    places = {name: refused(identifiers(name, text)) for name, text in texts.items()}
    assert {name: names for name, names in places.items() if names} == {}


def test_the_search_reads_names_only_outside_comments_and_strings() -> None:
    text = 'int torque_told; /* as told_by */ char *s = "not_told"; int told_later(void);'
    assert refused(identifiers("x.c", text)) == ["told_later", "torque_told"]
    assert refused(identifiers("x.py", "held_n = 1  # held_m\n")) == ["held_n"]
    assert refused(["test_command_is_held", "ROOM_TEMPERATURE_cC", "withheld_n"]) == []
