# SPDX-License-Identifier: Apache-2.0
"""What a run must show: pass criteria of a scenario in engineering units, read and checked.

One section of the file is one criterion, of one of three kinds:

* ``value`` with ``at_least`` and/or ``at_most``: a formula (``expression``) that comes to one
  number;
* ``value`` with ``settles_to``, ``band`` and ``within_s``: the formula's last time outside the
  band, counted from the
  window's beginning;
* ``reasons`` (a signal) with ``must_appear`` and/or ``must_not_appear``: identifiers of reason.h,
  or ANY_FAULT.

``from_s``, ``until_s`` and ``where`` make the window; limits and times may be formulas of
parameters themselves, so that a criterion stays correct when a parameter is changed. A
window without a row fails its criterion.
"""

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field, model_validator

from hubsim import reasons
from hubsim.scenario import expression
from hubsim.scenario.expression import ExpressionError, Formula
from hubsim.scenario.keys import Section, listed, listing, number

# Keys that hold a formula.
FORMULAS = (
    *("value", "at_least", "at_most", "settles_to", "band", "within_s", "from_s", "until_s"),
    *("where", "reasons"),
)
Limit = float | str
_FORMULA = "a number or a formula in quotes"


def read_needs(needs: Mapping[str, str]) -> None:
    """Refuse a condition that cannot be read, with ValueError."""
    for words, text in needs.items():
        try:
            expression.read(text)
        except ExpressionError as error:
            raise ValueError(f"needs: {words}: {error}") from error


class Criterion(Section):
    """One thing that a run must show; the section's name is its name."""

    text: Annotated[str, Field(max_length=200, description="why, for people")] = ""
    unit: Annotated[str, Field(max_length=20, description="of value, for people")] = ""
    value: Annotated[str | None, listed("what is looked at", "a formula in quotes")] = None
    at_least: Annotated[Limit | None, listed("smallest value that passes", _FORMULA)] = None
    at_most: Annotated[Limit | None, listed("largest value that passes", _FORMULA)] = None
    settles_to: Annotated[Limit | None, listed("where the value must come to stay", _FORMULA)] = (
        None
    )
    band: Annotated[Limit | None, listed("how near to settles_to is there", _FORMULA)] = None
    within_s: Annotated[Limit | None, listed("how soon after from_s, s", _FORMULA)] = None
    from_s: Annotated[Limit, listed("beginning of the window, s", _FORMULA)] = 0.0
    until_s: Annotated[
        Limit | None, listed("end of the window, s; absent: the run's end", _FORMULA)
    ] = None
    where: Annotated[
        str | None,
        listed("condition on signals; other rows are not looked at", "a formula in quotes"),
    ] = None
    reasons: Annotated[
        str | None, listed("a signal of reason codes", "a signal, for example wheels.reason")
    ] = None
    must_appear: Annotated[
        tuple[str, ...], listing("identifiers of reason.h", "a list of identifiers")
    ] = ()
    must_not_appear: Annotated[
        tuple[str, ...], listing("identifiers of reason.h, or ANY_FAULT", "a list of identifiers")
    ] = ()
    needs: Annotated[
        dict[str, str],
        listed(
            "what the drive must have for it, in words: where that does not hold, the criterion"
            " does not apply",
            "a section of words and formulas",
        ),
    ] = Field(default_factory=dict)
    share: Annotated[
        float, number(0.0, 1.0, "of the window's rows that must show each reason that must appear")
    ] = 0.0

    @model_validator(mode="after")
    def _is_of_one_kind(self) -> "Criterion":
        limited = self.at_least is not None or self.at_most is not None
        settling = [self.settles_to, self.band, self.within_s]
        settles = any(part is not None for part in settling)
        names = bool(self.must_appear or self.must_not_appear)
        if (self.value is None) == (self.reasons is None):
            raise ValueError("accepted: either value or reasons")
        if self.value is not None and (
            limited == settles or names or (settles and None in settling)
        ):
            raise ValueError(
                "accepted with value: at_least and/or at_most, or settles_to with band and within_s"
            )
        if self.reasons is not None and (limited or settles or not names):
            raise ValueError("accepted with reasons: must_appear and/or must_not_appear")
        self._read_everything()
        return self

    def _read_everything(self) -> None:
        read_needs(self.needs)
        for key in FORMULAS:
            text = getattr(self, key)
            if isinstance(text, str):
                try:
                    expression.read(text)
                except ExpressionError as error:
                    raise ValueError(f"{key}: {error}") from error
        if (
            self.reasons is not None
            and expression.dotted(expression.read(self.reasons).tree) is None
        ):
            raise ValueError(
                f"reasons: {self.reasons!r} is not accepted, accepted: a signal, for example "
                "wheels.reason"
            )
        for key in ("must_appear", "must_not_appear"):
            for name in getattr(self, key):
                try:
                    reasons.meant(name)
                except ValueError as error:
                    raise ValueError(f"{key}: {error}") from error

    @property
    def formulas(self) -> dict[str, Formula]:
        """Every formula of the criterion by its key."""
        return {
            key: expression.read(str(text))
            for key in FORMULAS
            if (text := getattr(self, key)) is not None
        }
