# SPDX-License-Identifier: Apache-2.0
"""The one exception a user of this package has to expect."""


class ConfigurationError(ValueError):
    """Something about the input is wrong.

    ``str()`` is one line that names the file, the key and what is accepted.
    """


class CheckFailedError(RuntimeError):
    """The input is fine, but what was asked to hold does not (an outdated generated file, for example)."""
