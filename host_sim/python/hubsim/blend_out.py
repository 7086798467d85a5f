# SPDX-License-Identifier: Apache-2.0
"""``python -m hubsim.blend_out`` names the study that took its place."""

import sys

from hubsim import moved

if __name__ == "__main__":
    sys.exit(moved.answer("blend_out"))
