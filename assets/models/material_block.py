#!/usr/bin/env python3
"""Makes a block of a material to press: 44 x 20 x 40 mm with rounded edges, its lower side held by the board it
lies on.

A tube along x, periodic and cubic in u with 32 control points on a superellipse, clamped and cubic in v, closed by a
pole at either end where the first rings lie in the pole's own plane.

Usage: material_block.py MATERIAL > MATERIAL-block.json, for modelling-clay, silicone-00-30 and gelatin-20-1
"""
import json
import math
import sys

from documents import tube, write

COUNT_U = 32
DEGREE = 3
LENGTH, HEIGHT, WIDTH = 44.0, 20.0, 40.0
EXPONENT = 6.0
SPANS = 20
# Newtons at the hand for each newton of contact: what lets a hand of a few newtons press 5 mm deep.
FORCE_SCALES = {"modelling-clay": 0.2, "silicone-00-30": 0.05, "gelatin-20-1": 1.0}


def ring():
    """Control points of a ring one unit in half height (y) and half width (z), evenly spaced along it."""
    def at(angle):
        c, s = math.cos(angle), math.sin(angle)
        radius = (abs(c) ** EXPONENT + abs(s) ** EXPONENT) ** (-1 / EXPONENT)
        return radius * s * HEIGHT / 2, radius * c * WIDTH / 2

    fine = [at(2 * math.pi * k / 4096) for k in range(4097)]
    lengths = [0.0]
    for a, b in zip(fine, fine[1:]):
        lengths.append(lengths[-1] + math.dist(a, b))
    points, k = [], 0
    for i in range(COUNT_U):
        while lengths[k] < lengths[-1] * i / COUNT_U:
            k += 1
        points.append(fine[k])
    return points


def block():
    breaks = [LENGTH * (k / SPANS - 0.5) for k in range(SPANS + 1)]
    knots = [breaks[0]] * DEGREE + breaks + [breaks[-1]] * DEGREE
    columns = len(knots) - DEGREE - 1
    points = [[] for _ in range(COUNT_U)]
    for j in range(columns):
        x = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
        end = min(j, columns - 1 - j)
        if end <= 2:
            x = math.copysign(LENGTH / 2, x)
        scale = {0: 0.0, 1: 0.5, 2: 0.9, 3: 0.97}.get(end, 1.0)
        for i, (y, z) in enumerate(ring()):
            points[i].append([round(x, 4), round(-scale * y, 4), round(scale * z, 4)])
    return tube(DEGREE, [round(k, 6) for k in knots], points)


def main():
    name = sys.argv[1]
    folder = __file__.rsplit("/", 1)[0]
    document = {
        "spoonbill_document": 3,
        "name": name + "-block",
        "body": {
            "name": "block",
            "surface": block(),
            "material": json.load(open(f"{folder}/../materials/{name}.json")),
            "lattice": {"node_budget": 4500},
        },
        "fixing_planes": [{"point_mm": [0, -8.5, 0], "normal": [0, 1, 0]}],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 5, "substeps": 4},
        "sculpting": {"drag_per_s": 32.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": FORCE_SCALES[name]},
        "view": {
            "camera": {"yaw_deg": 30, "pitch_deg": 30, "target_mm": [0, 2, 0], "distance_mm": 150},
        },
    }
    write(document)


main()
