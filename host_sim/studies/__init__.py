# SPDX-License-Identifier: Apache-2.0
"""Studies: measurements in closed loop, each with its script, table, picture and page.

``./tools/dev study`` lists them and runs one. No part of the Python distribution; hubsim knows
nothing of them.
"""
