# SPDX-License-Identifier: Apache-2.0
"""The exceptions that a user of this package has to expect."""


class ConfigurationError(ValueError):
    """Something about the input is wrong.

    ``str()`` is a line for everything that is wrong: the file, the key and what is accepted.
    """


class OutputError(ConfigurationError):
    """A file cannot be written; ``str()`` is one line that begins with its name."""


class CheckFailedError(RuntimeError):
    """The input is valid, but a property that was to be checked does not hold.

    An outdated generated file, for example.
    """
