# SPDX-License-Identifier: Apache-2.0
"""Fills in the CRC-32 of an image, as hal/cmake/seal_image.cmake does, in a tenth of its time.

seal.py OBJCOPY ELF
"""

import subprocess
import sys
import zlib
from pathlib import Path

OUTSIDE = (".boot_vectors", ".hubfoc_config", ".hubfoc_config_mark", ".image_crc")


def main(objcopy: str, elf: str) -> None:
    """Seal in place."""
    image, crc = Path(f"{elf}.image"), Path(f"{elf}.crc")
    removed = [f"--remove-section={name}" for name in OUTSIDE]
    subprocess.run([objcopy, "-O", "binary", *removed, elf, image], check=True)
    crc.write_bytes(zlib.crc32(image.read_bytes()).to_bytes(4, "little"))
    subprocess.run([objcopy, f"--update-section=.image_crc={crc}", elf], check=True)
    image.unlink()
    crc.unlink()


if __name__ == "__main__":
    main(*sys.argv[1:])
