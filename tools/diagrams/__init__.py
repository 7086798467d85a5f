# SPDX-License-Identifier: Apache-2.0
"""The diagrams of ``firmware/README.md``, drawn as SVG: ``tools/dev python -m diagrams``."""
