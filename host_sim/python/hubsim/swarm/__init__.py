# SPDX-License-Identifier: Apache-2.0
"""Runs of which a seed draws everything, judged by invariants alone (``hubsim swarm``)."""
