# SPDX-License-Identifier: Apache-2.0
"""The one exception a user of this package has to expect."""

from collections.abc import Sequence


class HubsimError(ValueError):
    """Something about the input or the run is wrong.

    ``str()`` is one line with the error, its place and the accepted values.
    """


class DoesNotApplyError(HubsimError):
    """A scenario is not for a drive: ``needs`` says what that one would have to have."""

    def __init__(self, scenario: str, drive: str, needs: Sequence[str]) -> None:
        super().__init__(
            f"{scenario} does not apply to {drive}, needs: {', '.join(needs)}; "
            "--set 'needs={}' runs it all the same"
        )
        self.scenario, self.drive, self.needs = scenario, drive, list(needs)
