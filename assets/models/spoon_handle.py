#!/usr/bin/env python3
"""Makes spoon-handle.json, our own model of a spoon handle: 100 mm long, 12 mm wide (9 mm at the neck), 5 mm thick.

A tube, periodic and cubic in u with 16 control points on a superellipse, clamped and cubic in v, closed by a pole
at either end. Between its ends a control column lies at the mean of its three inner knots, so that v is the distance
along the handle in millimetres (x = v) and every ring of constant v lies in a plane. The first and last rings lie in
their pole's own plane, which makes the ends smooth domes.

Usage: spoon_handle.py > spoon-handle.json
"""
import math

from documents import material, tube, write

COLUMNS_U = 16
DEGREE = 3
LENGTH = 100.0
EXPONENT = 3.0  # of the superellipse: 2 is an ellipse, more is squarer


def periodic_cubic_extent(values):
    """The largest value that a uniform periodic cubic reaches, sampled."""
    count, largest = len(values), 0.0
    for span in range(count):
        for step in range(32):
            t = step / 32
            weights = ((1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6)
            largest = max(largest, sum(w * values[(span + k) % count] for k, w in enumerate(weights)))
    return largest


def section():
    """Control points of a section one unit in half width (z) and half thickness (y)."""
    y, z = [], []
    for i in range(COLUMNS_U):
        angle = 2 * math.pi * i / COLUMNS_U
        c, s = math.cos(angle), math.sin(angle)
        radius = (abs(c) ** EXPONENT + abs(s) ** EXPONENT) ** (-1 / EXPONENT)
        # u runs so that du x dv points outward when v runs along +x.
        z.append(radius * c)
        y.append(-radius * s)
    scale_y, scale_z = periodic_cubic_extent(y), periodic_cubic_extent(z)
    return [v / scale_y for v in y], [v / scale_z for v in z]


def smooth_step(t):
    t = min(max(t, 0.0), 1.0)
    return t * t * (3 - 2 * t)


def main():
    first = [0.0, 1.5, 3.5, 7.0]
    breaks = first + [7.0 + 86.0 * k / 22 for k in range(1, 22)] + [LENGTH - b for b in reversed(first)]
    knots = [0.0] * DEGREE + breaks + [LENGTH] * DEGREE
    columns = len(knots) - DEGREE - 1
    y, z = section()
    points = [[] for _ in range(COLUMNS_U)]
    for j in range(columns):
        x = sum(knots[j + 1 : j + 1 + DEGREE]) / DEGREE
        end = min(j, columns - 1 - j)
        scale = {0: 0.0, 1: 0.8, 2: 0.97}.get(end, 1.0)
        if end == 1:
            x = 0.0 if j == 1 else LENGTH
        half_width = 6.0 - 1.5 * smooth_step((x - 45.0) / 55.0)
        half_thickness = 2.5
        for i in range(COLUMNS_U):
            points[i].append([round(x, 6), round(scale * half_thickness * y[i], 6), round(scale * half_width * z[i], 6)])
    document = {
        "spoonbill_document": 3,
        "name": "spoon-handle",
        "body": {
            "name": "handle",
            "surface": tube(DEGREE, [round(k, 6) for k in knots], points),
            "material": material("modelling-clay"),
            "lattice": {"node_budget": 2000},
        },
        "fixing_planes": [],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 12.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 60.0},
        "view": {
            "camera": {"yaw_deg": 22, "pitch_deg": 16, "target_mm": [57, -7, 0], "distance_mm": 250},
        },
    }
    write(document)


main()
