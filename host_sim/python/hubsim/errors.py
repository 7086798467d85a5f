# SPDX-License-Identifier: Apache-2.0
"""The one exception a user of this package has to expect."""


class HubsimError(ValueError):
    """Something about the input or the run is wrong.

    ``str()`` is one line with the error, its place and the accepted values.
    """
