# SPDX-License-Identifier: Apache-2.0
"""``python -m hubsim.faults_tables`` names the study that took its place."""

import sys

from hubsim import moved

if __name__ == "__main__":
    sys.exit(moved.answer("faults_tables"))
