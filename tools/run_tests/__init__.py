# SPDX-License-Identifier: Apache-2.0
"""Choosing and running the tests of several build directories in one run of ctest."""
