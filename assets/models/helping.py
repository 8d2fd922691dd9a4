"""A helping of the bundled jelly, and a trial that lowers it onto a fixed body."""
from documents import material, model, tube

DEGREE = 3
SIZE_MM = (28.0, 14.0, 22.0)  # along, up, across


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


def helping(centre_mm):
    """The bundled jelly, scaled to SIZE_MM and moved to a centre. Its control net is about as fine as the
    lattice of a trial, so that the drawn surface follows the lattice closely and lies on what bears it."""
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
                point[axis] = round(centre_mm[axis] + point[axis] * SIZE_MM[axis] / size[axis], 6)
    return surface


def trial(name, lattice, centre_mm, bearer, axis_point_mm, friction):
    """A document in which a helping of soft gelatin is lowered from a centre onto a fixed body, given by its name, surface,
    material and, if it has one, rim. The body then turns about an axis along z. Both bodies get the friction."""
    return {
        "spoonbill_document": 3,
        "name": name,
        "body": {
            "name": "jelly",
            "surface": helping(centre_mm),
            "material": dict(material("gelatin-20-1"), friction=friction),
            "lattice": lattice,
        },
        "other_bodies": [
            {
                "name": bearer["name"],
                "kind": "fixed",
                "surface": bearer["surface"],
                **({"rim_uv": bearer["rim_uv"]} if "rim_uv" in bearer else {}),
                "material": dict(material(bearer["material"]), friction=friction),
            }
        ],
        "fixing_planes": [],
        "tool": {"kind": "point", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 0.0, "gravity_m_per_s2": [0.0, -9.81, 0.0], "force_scale": 1.0},
        "trial": {
            "lowered_body": "jelly",
            "turned_body": bearer["name"],
            "point_mm": list(axis_point_mm),
            "axis": [0, 0, 1],
        },
        "view": {
            "camera": {"yaw_deg": 25, "pitch_deg": 22},
            "overlays": {"tool": False, "touched_nodes": False},
        },
    }
