#!/usr/bin/env python3
"""Makes soft-press.json: a cushion of gelatin on a board, and a soft fingertip of silicone to press it with.

Both are tubes, periodic and cubic in u with 16 control points on a superellipse, clamped and cubic in v, closed by a
pole at either end where the first and last rings lie in the pole's own plane. The cushion lies along x, its lower
side held by the board; the fingertip lies along x too and is held by its upper part.

Usage: soft_press.py > soft-press.json
"""
import math

from documents import material, tube, write

COUNT_U = 16
DEGREE = 3


def pillow(length, half_height, half_width, exponent, spans):
    """A surface about the origin, rounded at its ends like a pillow."""
    breaks = [length * (k / spans - 0.5) for k in range(spans + 1)]
    knots = [breaks[0]] * DEGREE + breaks + [breaks[-1]] * DEGREE
    columns = len(knots) - DEGREE - 1
    points = [[] for _ in range(COUNT_U)]
    for j in range(columns):
        x = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
        end = min(j, columns - 1 - j)
        if end <= 1:
            x = math.copysign(length / 2, x)
        share = min(abs(x) / (length / 2), 1.0)
        scale = 0.0 if end == 0 else max((1 - share**4) ** 0.5, 0.35)
        for i in range(COUNT_U):
            angle = 2 * math.pi * i / COUNT_U
            c, s = math.cos(angle), math.sin(angle)
            radius = (abs(c) ** exponent + abs(s) ** exponent) ** (-1 / exponent)
            point = [x, -scale * half_height * radius * s, scale * half_width * radius * c]
            points[i].append([round(value, 6) for value in point])
    return tube(DEGREE, [round(k, 6) for k in knots], points)


def main():
    document = {
        "spoonbill_document": 3,
        "name": "soft-press",
        "body": {
            "name": "cushion",
            "surface": pillow(70, 12, 24, 3, 14),
            "material": material("gelatin-10-1"),
            "lattice": {"node_budget": 2500},
        },
        "fixing_planes": [{"point_mm": [0, -9, 0], "normal": [0, 1, 0]}],
        "tool": {
            "kind": "solid",
            "action": "push",
            "radius_mm": 8,
            "substeps": 4,
            "solid": {"shape": "surface", **pillow(26, 9, 9, 2, 8)},
            "soft": {
                "material": material("silicone-soft"),
                "lattice": {"node_budget": 700},
                "grip": {"point_mm": [0, 3, 0], "normal": [0, -1, 0]},
            },
        },
        "sculpting": {"drag_per_s": 32.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 1.0},
        "view": {
            "camera": {"yaw_deg": 28, "pitch_deg": 14, "target_mm": [0, 8, 0], "distance_mm": 215},
        },
    }
    write(document)


main()
