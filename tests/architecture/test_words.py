# SPDX-License-Identifier: Apache-2.0
"""Names and comments use the terms of motor control, not metaphors of the project's own."""

import io
import re
import tokenize

import pytest
from modules import code_only
from test_repository import found, own_text

# Refused in names and in text. Split so that this file does not contain them.
METAPHORS = re.compile(
    "|".join(
        rf"(?<![A-Za-z]){word}(?![A-Za-z])"
        for word in (
            *("riv" + "ers?", "hou" + "se", "wi" + "sh(?:es|ed)?", "verd" + "icts?"),
            *("pati" + "ence", "dou" + "bts?", "(?:slow|fast)[ _]rea" + "ch(?:es)?"),
            *("stands? in the w" + "ay", "counted o" + "n for", "get(?:s|ting)? to s" + "ee"),
            *("belie" + "ve[sd]?", "some" + "body(?:'s)?", "no" + "body(?:'s)?", "bi" + "tes"),
            *("to the last b" + "it", "to the let" + "ter", "next to noth" + "ing"),
        )
    ),
    re.IGNORECASE,
)
# The word for a torque enable that the project once used; hydraulic brakes have real ones.
HYDRAULIC = re.compile("(?<![A-Za-z])val" + "ves?(?![A-Za-z])", re.IGNORECASE)
HYDRAULIC_FILES = re.compile(
    r"(?:^|/)(?:test_)?(?:abs_unit|anti_lock|hydraulic_brake)\.[ch]$|^host_sim/plant/README\.md$"
    r"|^host_sim/bench/signals\.c$"
    r"|^host_sim/python/hubsim/(?:commands\.py|scenarios/mu_\w+\.toml)$"
)
# Ordinary words of a sentence, also of the sentence that is a test's name, but no parts of a name.
NOT_IN_NAMES = frozenset(
    ("told", "heard", "said", "held", "behind", "nearer", "nothing", "aids", "room")
)
# A test's name states the tested property; these words are of a narrative.
NOT_IN_TEST_NAMES = frozenset(
    (
        *("told", "heard", "said", "says", "speaks", "knows", "looks", "stands", "sees", "wants"),
        *("behind", "nearer", "beaten", "nothing", "mistake", "mistakes"),
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


def test_text_contains_no_private_metaphor() -> None:
    assert found(METAPHORS, own_text()) == []


def test_only_files_of_hydraulic_brakes_use_the_term_of_their_parts() -> None:
    texts = {name: text for name, text in own_text().items() if not HYDRAULIC_FILES.search(name)}
    assert found(HYDRAULIC, texts) == []


def test_names_are_terms_of_the_field() -> None:
    texts = {
        name: text for name, text in own_text().items() if re.search(r"\.(?:[ch]|[ch]pp|py)$", name)
    }
    places = {name: refused(identifiers(name, text)) for name, text in texts.items()}
    assert {name: names for name, names in places.items() if names} == {}


def test_names_of_tests_state_the_property() -> None:
    names = {
        match[1]
        for name, text in own_text().items()
        if name.startswith("tests/") and name.endswith((".c", ".py"))
        for match in re.finditer(r"\b(?:void|def) (test_\w+)", text)
    }
    assert len(names) > len(NOT_IN_TEST_NAMES)
    assert [name for name in sorted(names) if NOT_IN_TEST_NAMES & set(name.split("_"))] == []


@pytest.mark.parametrize(
    "line",
    [
        "the slow rea" + "ch",
        "SLOW_REA" + "CH",
        "a matter of pati" + "ence",
        "verd" + "ict_t x;",
        "what stands in the w" + "ay",
        "some" + "body's motor",
    ],
)
def test_the_search_finds_metaphors(line: str) -> None:
    assert METAPHORS.search(line)


@pytest.mark.parametrize("line", ["the limit is reached", "a driver", "doubtless", "a household"])
def test_the_search_permits_ordinary_words(line: str) -> None:
    assert not METAPHORS.search(line)


def test_the_search_reads_names_only_outside_comments_and_strings() -> None:
    text = 'int torque_told; /* as told_by */ char *s = "not_told"; int told_later(void);'
    assert refused(identifiers("x.c", text)) == ["told_later", "torque_told"]
    assert refused(identifiers("x.py", "held_n = 1  # held_m\n")) == ["held_n"]
    assert refused(["test_command_is_held", "ROOM_TEMPERATURE_cC", "withheld_n"]) == []


def test_every_permitted_file_exists() -> None:
    names = [name for name in own_text() if HYDRAULIC_FILES.search(name)]
    assert len(names) >= len({"abs_unit.c", "anti_lock.c", "hydraulic_brake.c"})
