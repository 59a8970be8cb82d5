#!/usr/bin/env python3
"""The Jacksboro fault elevation model of matplotlib's sample data as a float TIFF, metres, north up.

dem_from_npz.py SAMPLE.npz OUT.tif     prints its texel spacing in metres, EASTxSOUTH, for --spacing
"""
import math
import sys

import numpy as np
from PIL import Image

EARTH = 6371008.8  # mean radius, metres


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with np.load(sys.argv[1]) as dem:
        heights = dem["elevation"].astype(np.float32)
        dx, dy = abs(float(dem["dx"])), abs(float(dem["dy"]))
        latitude = (float(dem["ymin"]) + float(dem["ymax"])) / 2
    Image.fromarray(heights, mode="F").save(sys.argv[2])
    metres = math.radians(1) * EARTH
    print(f"{dx * metres * math.cos(math.radians(latitude)):.2f}x{dy * metres:.2f}")


if __name__ == "__main__":
    main()
