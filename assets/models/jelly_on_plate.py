#!/usr/bin/env python3
"""Makes jelly-on-plate.json, a trial beside that of jelly-on-spoon.json: the same helping of soft gelatin is lowered onto
a flat, round plate of ABS, 92 mm across and 4 mm thick, which then tilts. On a plate nothing but friction holds the
gelatin.

The plate is a tube, periodic and cubic in u, clamped and cubic in v, from the pole below to the pole above. Its faces
are exactly flat, because their control points are in one plane.

Usage: jelly_on_plate.py > jelly-on-plate.json
"""
import math

from documents import material, tube, write
from helping import DEGREE, helping

HELPING_MM = (28.0, 14.0, 22.0)  # along, up, across
CENTRE_MM = (0.0, 8.0, 0.0)
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


def main():
    document = {
        "spoonbill_document": 3,
        "name": "jelly-on-plate",
        "body": {
            "name": "jelly",
            "surface": helping(HELPING_MM, CENTRE_MM),
            "material": dict(material("gelatin-20-1"), friction=FRICTION),
            "lattice": {"nodes": [10, 6, 12]},
        },
        "other_bodies": [
            {
                "name": "plate",
                "kind": "fixed",
                "surface": plate(),
                "material": dict(material("abs"), friction=FRICTION),
            }
        ],
        "fixing_planes": [],
        "tool": {"kind": "point", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 0.0, "gravity_m_per_s2": [0.0, -9.81, 0.0], "force_scale": 1.0},
        "trial": {"lowered_body": "jelly", "turned_body": "plate", "point_mm": [0, 0, 0], "axis": [0, 0, 1]},
        "view": {
            "camera": {"yaw_deg": 25, "pitch_deg": 22},
            "overlays": {"tool": False, "touched_nodes": False},
        },
    }
    write(document)


main()
