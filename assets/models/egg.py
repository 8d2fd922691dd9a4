#!/usr/bin/env python3
"""Makes egg.stl, our own mesh of an egg to push with: 50 mm high along y, 38 mm wide, blunt below, its middle at 0.

Rings of latitude closed by a corner at either end, in millimetres as STL files are, counter-clockwise from outside.

Usage: egg.py > egg.stl
"""
import math
import struct
import sys

RINGS = 24
AROUND = 36
HALF_HEIGHT = 25.0
HALF_WIDTH = 19.0
TAPER = 0.12  # how much wider the lower half is than the upper: 0 is an ellipsoid


def corner(ring, step):
    polar, turn = math.pi * ring / RINGS, 2 * math.pi * step / AROUND
    width = HALF_WIDTH * math.sin(polar) * (1 - TAPER * math.cos(polar))
    return tuple(round(value, 4) for value in (width * math.cos(turn), HALF_HEIGHT * math.cos(polar), -width * math.sin(turn)))


def triangles():
    for step in range(AROUND):
        for ring in range(RINGS):
            above, below = (ring, step), (ring + 1, step)
            beside_above, beside_below = (ring, (step + 1) % AROUND), (ring + 1, (step + 1) % AROUND)
            if ring > 0:
                yield corner(*above), corner(*below), corner(*beside_above)
            if ring < RINGS - 1:
                yield corner(*below), corner(*beside_below), corner(*beside_above)


def main():
    all_of_them = list(triangles())
    out = sys.stdout.buffer
    out.write(b"Spoonbill's egg, in millimetres".ljust(80) + struct.pack("<I", len(all_of_them)))
    for a, b, c in all_of_them:
        out.write(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0))


main()
