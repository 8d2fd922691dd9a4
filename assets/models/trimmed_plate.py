#!/usr/bin/env python3
"""Makes trimmed-plate.json: a curved plate of modelling clay 3 mm thick, its corners trimmed round, with a round
hole and a slot. The surface itself is whole: trim loops keep a part of it. A plane holds the plate's end.

Usage: trimmed_plate.py > trimmed-plate.json
"""
import math

from documents import material, write

LENGTH, WIDTH, RISE = 120.0, 70.0, 8.0
COUNT_U, COUNT_V, DEGREE = 9, 13, 3


def knots(count):
    spans = count - DEGREE
    return [0.0] * DEGREE + [round(k / spans, 6) for k in range(spans + 1)] + [1.0] * DEGREE


def surface():
    """u runs across the plate, along z, and v along it, along x, so that the normals point up."""
    def averages(count):
        return [sum(knots(count)[j + 1 : j + 1 + DEGREE]) / DEGREE for j in range(count)]

    return {
        "u": {"degree": DEGREE, "periodic": False, "knots": knots(COUNT_U)},
        "v": {"degree": DEGREE, "periodic": False, "knots": knots(COUNT_V)},
        "control_points_mm": [[[round(LENGTH * v, 6), round(RISE * math.sin(math.pi * v), 6),
                                round(WIDTH * (u - 0.5), 6)] for v in averages(COUNT_V)] for u in averages(COUNT_U)],
        "trims": [outline(), round_hole(0.5, 0.68, 15.0), slot()],
    }


def outline():
    """Straight sides and round corners, as a quadratic: counter-clockwise."""
    rim, corner = 2.0, 14.0
    a, b = rim / WIDTH, rim / LENGTH
    s, t = (rim + corner) / WIDTH, (rim + corner) / LENGTH
    points = [[s, b], [1 - s, b], [1 - a, b], [1 - a, t], [1 - a, 1 - t], [1 - a, 1 - b], [1 - s, 1 - b], [s, 1 - b],
              [a, 1 - b], [a, 1 - t], [a, t], [a, b]]
    # Every corner is a Bezier piece between the middles of two sides that a straight piece joins.
    control = []
    for k in range(0, 12, 3):
        start, corner_point, end = points[k + 1], points[k + 2], points[(k + 3) % 12]
        control += [start, corner_point, end]
        following = points[(k + 4) % 12]
        control.append([(end[0] + following[0]) / 2, (end[1] + following[1]) / 2])
    control.append(control[0])
    pieces = len(control) // 2
    rounded = [[round(u, 9), round(v, 9)] for u, v in control]
    return {"degree": 2, "periodic": False,
            "knots": [0, 0] + [k for k in range(pieces + 1) for _ in range(2 if 0 < k < pieces else 1)] + [pieces] * 2,
            "control_points_uv": rounded}


def round_hole(u, v, radius):
    """A periodic cubic; its control points lie outside of it, by a factor that its knots have on a circle."""
    count = 12
    out = 3 / (2 + math.cos(2 * math.pi / count))
    return {"degree": 3, "periodic": True, "knots": list(range(count + 1)),
            "control_points_uv": [[round(u + out * radius / WIDTH * math.cos(-2 * math.pi * k / count), 9),
                                   round(v + out * radius / LENGTH * math.sin(-2 * math.pi * k / count), 9)]
                                  for k in range(count)]}


def slot():
    """A polygon, clockwise."""
    corners = [[0.3, 0.28], [0.3, 0.36], [0.7, 0.36], [0.7, 0.28], [0.3, 0.28]]
    return {"degree": 1, "periodic": False, "knots": [0, 0, 1, 2, 3, 4, 4], "control_points_uv": corners}


def main():
    document = {
        "spoonbill_document": 3,
        "name": "trimmed plate",
        "body": {
            "name": "plate",
            "surface": surface(),
            "material": material("modelling-clay"),
            "lattice": {"node_budget": 2000},
            "shell_thickness_mm": 3,
        },
        "fixing_planes": [{"point_mm": [15, 0, 0], "normal": [1, 0, 0]}],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8, "substeps": 6},
        "sculpting": {"drag_per_s": 24.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 60.0},
        "view": {"camera": {"yaw_deg": 30, "pitch_deg": 40}},
    }
    write(document)


main()
