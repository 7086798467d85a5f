# SPDX-License-Identifier: Apache-2.0
"""Mutation testing of the pure modules: which changes of the code no unit test notices."""
