# SPDX-License-Identifier: Apache-2.0
"""The commands of the command line, a module each: its arguments and what it does."""
