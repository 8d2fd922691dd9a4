#!/usr/bin/env python3
"""Makes jelly-on-spoon.json, a trial after Fig. 11 of Pungotra et al. (2013): a helping of soft gelatin, 28 x 22 x 14 mm,
is lowered into the bowl of a steel spoon, which then tilts about an axis across the spoon. A positive angle lifts the
rim that is away from the handle.

Usage: jelly_on_spoon.py > jelly-on-spoon.json
"""
from documents import material, model, write
from helping import helping

HELPING_MM = (28.0, 14.0, 22.0)  # along, up, across
CENTRE_MM = (137.0, 9.0, 0.0)
AXIS_POINT_MM = (137.0, 0.0, 0.0)
FRICTION = 0.1  # a choice: no trustworthy coefficient of gelatin on steel is published


def main():
    spoon = model("spoon-bowl")["body"]
    document = {
        "spoonbill_document": 3,
        "name": "jelly-on-spoon",
        "body": {
            "name": "jelly",
            "surface": helping(HELPING_MM, CENTRE_MM),
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
