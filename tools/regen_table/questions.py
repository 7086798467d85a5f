# SPDX-License-Identifier: Apache-2.0
"""Asks on a terminal for the numbers of a label that the options do not give."""

from collections.abc import Callable, Mapping

from regen_table import boards, label

NEEDED_ONCE = (
    {"pole_pairs", "magnets"},
    {"kv", "flux_linkage", "no_load_rpm"},
    {"rated_torque", "rated_current", "rated_power"},
)


def ask(
    given: Mapping[str, float | str], answer: Callable[[str], str] = input
) -> dict[str, float | str]:
    """Return the answers; an empty one leaves the number to be estimated, or the word as it is.

    ``answer`` shows a question and returns a line. A line that is not accepted is asked again.
    """
    print("Empty: not known.")
    found: dict[str, float | str] = {}
    for quantity in label.QUANTITIES:
        known = {*given, *found}
        alternatives = next((names for names in NEEDED_ONCE if quantity.name in names), set())
        if quantity.name in known or alternatives & known:
            continue
        value = _number(quantity, answer)
        if value is not None:
            found[quantity.name] = value
    choices = (
        *label.CHOICES,
        label.Choice("--board", ("", *boards.known(), label.OWN_BOARD), "empty: proposed"),
    )
    for choice in choices:
        if choice.name in given:
            continue
        word = _word(choice, answer)
        if word:
            found[choice.name] = word
    return found


def _number(quantity: label.Quantity, answer: Callable[[str], str]) -> float | None:
    unit = f", {quantity.unit}" if quantity.unit else ""
    while True:
        text = answer(f"{quantity.option.removeprefix('--')} ({quantity.text}{unit}): ").strip()
        if not text:
            return None
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        fits = quantity.lowest <= value <= quantity.highest
        if fits and not (quantity.whole and value % 1.0):
            return value
        what = "a whole number" if quantity.whole else "a number"
        print(f"  accepted: {what} from {quantity.lowest:g} to {quantity.highest:g}")


def _word(choice: label.Choice, answer: Callable[[str], str]) -> str:
    words = ", ".join(word for word in choice.words if word)
    while True:
        name = choice.option.removeprefix("--")
        text = answer(f"{name} ({choice.text}; {words}; empty: {choice.words[0] or 'any'}): ")
        if not text.strip():
            return choice.words[0]
        if text.strip() in choice.words:
            return text.strip()
        print(f"  accepted: {words}")
