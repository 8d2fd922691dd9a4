#!/usr/bin/env python3
"""Makes jelly-on-spoon.json, a trial after Fig. 11 of Pungotra et al. (2013): a helping of soft gelatin, 28 x 22 x 14 mm,
is lowered into the bowl of a steel spoon, which then tilts about an axis across the spoon. A positive angle lifts the
rim that is away from the handle.

Usage: jelly_on_spoon.py > jelly-on-spoon.json
"""
from documents import material, model, tube, write

DEGREE = 3
HELPING_MM = (28.0, 14.0, 22.0)  # along, up, across
CENTRE_MM = (137.0, 9.0, 0.0)
AXIS_POINT_MM = (137.0, 0.0, 0.0)
FRICTION = 0.1  # a choice: no trustworthy coefficient of gelatin on steel is published


def blend(one, other, share):
    return [a + (b - a) * share for a, b in zip(one, other)]


def halve_around(rows):
    """Twice as many control points around a uniform periodic cubic; the shape stays."""
    finer = []
    for i, row in enumerate(rows):
        before, after = rows[i - 1], rows[(i + 1) % len(rows)]
        finer.append([[(a + 6 * b + c) / 8 for a, b, c in zip(*three)] for three in zip(before, row, after)])
        finer.append([blend(one, other, 0.5) for one, other in zip(row, after)])
    return finer


def insert_along(knots, row, knot):
    """The control points after a knot is inserted (Boehm 1980)."""
    span = max(k for k in range(len(knots)) if knots[k] <= knot)
    first = span - DEGREE + 1
    inner = [
        blend(row[i - 1], row[i], (knot - knots[i]) / (knots[i + DEGREE] - knots[i])) for i in range(first, span + 1)
    ]
    return row[:first] + inner + row[span:]


def helping():
    """The bundled jelly, scaled and moved over the bowl. Its control net is about as fine as the lattice, so that the
    drawn surface follows the lattice closely and lies on the spoon."""
    surface = model("jelly")["body"]["surface"]
    points, knots = halve_around(surface["control_points_mm"]), surface["v"]["knots"]
    breaks = sorted(set(knots))
    for knot in [round(0.5 * (a + b), 6) for a, b in zip(breaks, breaks[1:])]:
        points = [insert_along(knots, row, knot) for row in points]
        knots = sorted(knots + [knot])
    surface = tube(DEGREE, knots, points)
    size = [0.0] * 3
    for axis in range(3):
        values = [point[axis] for row in points for point in row]
        size[axis] = max(values) - min(values)
    for row in points:
        for point in row:
            for axis in range(3):
                point[axis] = round(CENTRE_MM[axis] + point[axis] * HELPING_MM[axis] / size[axis], 6)
    return surface


def main():
    spoon = model("spoon-bowl")["body"]
    document = {
        "spoonbill_document": 3,
        "name": "jelly-on-spoon",
        "body": {
            "name": "jelly",
            "surface": helping(),
            "material": dict(material("gelatin-20-1"), friction=FRICTION),
            "lattice": {"nodes": [10, 6, 12]},
        },
        "other_bodies": [
            {
                "name": "spoon",
                "kind": "fixed",
                "surface": spoon["surface"],
                "material": dict(material("steel-304"), friction=FRICTION),
            }
        ],
        "fixing_planes": [],
        "tool": {"kind": "point", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 0.0, "gravity_m_per_s2": [0.0, -9.81, 0.0], "force_scale": 1.0},
        "trial": {
            "lowered_body": "jelly",
            "turned_body": "spoon",
            "point_mm": list(AXIS_POINT_MM),
            "axis": [0, 0, 1],
        },
        "view": {
            "camera": {"yaw_deg": 25, "pitch_deg": 22},
            "overlays": {"tool": False, "touched_nodes": False},
        },
    }
    write(document)


main()
