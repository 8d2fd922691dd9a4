#!/usr/bin/env python3
"""Makes jelly-on-plate.json, a trial beside that of jelly-on-spoon.json: the same helping of soft gelatin is lowered onto
a flat, round plate of ABS, 92 mm across and 4 mm thick, which then tilts. On a plate nothing but friction holds the
gelatin.

The plate is a tube, periodic and cubic in u, clamped and cubic in v, from the pole below to the pole above. Its faces
are exactly flat, because their control points are in one plane.

Usage: jelly_on_plate.py > jelly-on-plate.json
"""
import math

from documents import tube, write
from helping import DEGREE, trial

FRICTION = 0.3  # a choice: no trustworthy coefficient of gelatin on plastic is published
AROUND = 24
LOWER = [(0.0, -4.0), (8.0, -4.0), (20.0, -4.0), (32.0, -4.0), (41.0, -4.0), (45.0, -3.6)]  # radius, height
RIM = [(46.0, -2.0)]
UPPER = [(radius, -4.0 - height) for radius, height in reversed(LOWER)]


def plate():
    profile = LOWER + RIM + UPPER
    spans = len(profile) - DEGREE
    knots = [0.0] * DEGREE + [k / spans for k in range(spans + 1)] + [1.0] * DEGREE
    angles = [2 * math.pi * i / AROUND for i in range(AROUND)]
    points = [
        [[round(r * math.cos(a), 6), h, round(-r * math.sin(a), 6)] for r, h in profile] for a in angles
    ]
    return tube(DEGREE, knots, points)


bearer = {"name": "plate", "surface": plate(), "material": "abs"}
write(trial("jelly-on-plate", {"nodes": [10, 6, 12]}, (0.0, 8.0, 0.0), bearer, (0, 0, 0), FRICTION))
