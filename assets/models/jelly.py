#!/usr/bin/env python3
"""Makes jelly.json: a helping of jelly as in Fig. 11 of Pungotra et al. (2013), a B-spline surface of 8 x 8 control
points, filled with a lattice of 12 x 12 x 12 nodes.

The surface is a tube along x, periodic and cubic in u on a rounded rectangle, clamped and cubic in v, closed by a pole
at either end, where the first and last rings lie in the pole's own plane.

Usage: jelly.py > jelly.json
"""
from documents import material, tube, write

COUNT, DEGREE = 8, 3
LENGTH, HALF_HEIGHT, HALF_WIDTH = 32.0, 9.0, 13.0
CORNERS = [(0, 1.25), (-1.12, 1.12), (-1.25, 0), (-1.12, -1.12), (0, -1.25), (1.12, -1.12), (1.25, 0), (1.12, 1.12)]
SCALE = [0.0, 0.62, 0.98, 1.04, 1.04, 0.98, 0.62, 0.0]


def surface():
    spans = COUNT - DEGREE
    knots = [0.0] * DEGREE + [round(k / spans, 6) for k in range(spans + 1)] + [1.0] * DEGREE
    points = []
    for y, z in CORNERS:
        row = []
        for j in range(COUNT):
            share = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
            x = -0.5 * LENGTH if j <= 1 else 0.5 * LENGTH if j >= COUNT - 2 else LENGTH * (share - 0.5) * 1.25
            row.append([round(v, 6) for v in (x, HALF_HEIGHT * SCALE[j] * y, HALF_WIDTH * SCALE[j] * z)])
        points.append(row)
    return tube(DEGREE, knots, points)


def main():
    document = {
        "spoonbill_document": 3,
        "name": "jelly",
        "body": {
            "name": "jelly",
            "surface": surface(),
            "material": material("gelatin-10-1"),
            "lattice": {"nodes": [12, 12, 12]},
        },
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8, "substeps": 4},
        "sculpting": {"drag_per_s": 32.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 1.0},
        "view": {
            "camera": {"yaw_deg": 32, "pitch_deg": 24},
            "overlays": {"cells": True, "tool": False},
        },
    }
    write(document)


main()
