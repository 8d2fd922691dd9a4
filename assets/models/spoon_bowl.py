#!/usr/bin/env python3
"""Makes spoon-bowl.json, our own model of a spoon's bowl: 60 mm long, 38 mm wide, 8 mm deep, its neck towards the
handle of spoon-handle.json, which ends 4 mm before it. The two have other counts and knots on purpose: merged they
make a spoon.

A tube, periodic and cubic in u with 20 control points, clamped and cubic in v, closed by a pole at either end. A
section is a lens bent down in the middle. v is about the distance along the bowl in millimetres.

Usage: spoon_bowl.py > spoon-bowl.json
"""
import math

from documents import material, tube, write

COLUMNS_U = 20
DEGREE = 3
START, LENGTH = 104.0, 60.0
NECK_WIDTH, NECK_THICKNESS = 4.6, 2.2  # half of each
WIDTH, THICKNESS, DEPTH = 19.0, 1.4, 6.5
WIDEST = 0.58  # of the length


def smooth_step(t):
    t = min(max(t, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def half_width(t):
    if t < WIDEST:
        return NECK_WIDTH + (WIDTH - NECK_WIDTH) * smooth_step((t - 0.08) / (WIDEST - 0.08))
    return WIDTH * math.sqrt(max(0.0, 1 - ((t - WIDEST) / (1 - WIDEST)) ** 2))


def half_thickness(t):
    return NECK_THICKNESS + (THICKNESS - NECK_THICKNESS) * smooth_step((t - 0.05) / 0.4)


def depth(t):
    return DEPTH * smooth_step((t - 0.12) / 0.4) * (1 - (max(t - WIDEST, 0) / (1 - WIDEST)) ** 2)


def main():
    first = [0.0, 1.0, 2.4, 4.5]
    last = [4.5, 2.4, 1.1, 0.4, 0.0]
    inner = 24
    breaks = (
        first
        + [4.5 + (LENGTH - 9.0) * k / inner for k in range(1, inner)]
        + [LENGTH - b for b in last]
    )
    knots = [0.0] * DEGREE + breaks + [LENGTH] * DEGREE
    columns = len(knots) - DEGREE - 1
    points = [[] for _ in range(COLUMNS_U)]
    for j in range(columns):
        along = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
        left = columns - 1 - j
        t = along / LENGTH
        wide, thick, deep = half_width(t), half_thickness(t), depth(t)
        scale = {0: 0.0, 1: 0.8, 2: 0.97}.get(j, 1.0)
        if j == 1:
            along = 0.0
        if left == 0:
            scale = 0.0
        if left == 1:  # in the pole's plane
            along = LENGTH
        thick *= {0: 0.0, 1: 0.75, 2: 0.95}.get(left, 1.0)
        for i in range(COLUMNS_U):
            angle = 2 * math.pi * i / COLUMNS_U
            c, s = math.cos(angle), math.sin(angle)
            # u runs so that du x dv points outward when v runs along +x.
            z = scale * wide * c * 1.02
            y = -scale * thick * math.copysign(abs(s) ** 0.8, s) - scale * deep * (1 - c * c)
            points[i].append([round(START + along, 6), round(y, 6), round(z, 6)])
    document = {
        "spoonbill_document": 3,
        "name": "spoon-bowl",
        "body": {
            "name": "bowl",
            "surface": tube(DEGREE, [round(k, 6) for k in knots], points),
            "material": material("modelling-clay"),
            "lattice": {"node_budget": 2000},
        },
        "fixing_planes": [],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 12.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 60.0},
        "view": {
            "camera": {"yaw_deg": 30, "pitch_deg": 35, "target_mm": [134, -4, 0], "distance_mm": 170},
            "ground_mm": -46,
        },
    }
    write(document)


main()
