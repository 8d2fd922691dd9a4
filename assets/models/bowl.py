#!/usr/bin/env python3
"""Makes bowl.json: the oval bowl of a spoon, a shell of modelling clay 2 mm thick, open upwards.

Its surface is the inside, which food touches, periodic and cubic in u, clamped and cubic in v from a pole at the
bottom to the rim. A plane holds the rim.

Usage: bowl.py > bowl.json
"""
import math

from documents import material, tube, write

COUNT_U, COUNT_V, DEGREE = 16, 9, 3
HALF_LENGTH, HALF_WIDTH, DEPTH = 30.0, 21.0, 12.0


def surface():
    spans = COUNT_V - DEGREE
    knots = [0.0] * DEGREE + [round(k / spans, 6) for k in range(spans + 1)] + [1.0] * DEGREE
    points = []
    for i in range(COUNT_U):
        angle = 2 * math.pi * i / COUNT_U
        row = []
        for j in range(COUNT_V):
            share = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
            out = 0.0 if j == 0 else math.sin(0.5 * math.pi * share)
            # The first ring lies in the pole's tangent plane, so that the bottom is smooth.
            rise = 0.0 if j <= 1 else 1 - math.cos(0.5 * math.pi * share)
            row.append([round(v, 6) for v in (HALF_LENGTH * out * math.cos(angle), DEPTH * rise,
                                              HALF_WIDTH * out * math.sin(angle))])
        points.append(row)
    return tube(DEGREE, knots, points)


def main():
    document = {
        "spoonbill_document": 3,
        "name": "bowl",
        "body": {
            "name": "bowl",
            "surface": surface(),
            "material": material("modelling-clay"),
            "lattice": {"node_budget": 2000},
            "shell_thickness_mm": 2,
        },
        "fixing_planes": [{"point_mm": [0, 10.5, 0], "normal": [0, -1, 0]}],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8, "substeps": 6},
        "sculpting": {"drag_per_s": 24.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 60.0},
        "view": {"camera": {"yaw_deg": 30, "pitch_deg": 32}},
    }
    write(document)


main()
