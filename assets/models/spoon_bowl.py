#!/usr/bin/env python3
"""Makes spoon-bowl.json, the bowl of a spoon: 60 mm long, 38 mm wide, 8 mm deep, with a rim of 2 mm. Its back faces the
handle of spoon-handle.json, which ends 4 mm before it; merged they make a spoon. The program makes the surface:

    app/run new bowl --length 60mm --width 38mm --depth 8mm --rim 2mm --out made-bowl.json
    spoon_bowl.py made-bowl.json > spoon-bowl.json
"""
import json
import sys

from documents import material, write

CENTRE_X_MM = 134.0


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        made = json.load(file)["body"]
    surface = made["surface"]
    surface["control_points_mm"] = [
        [[round(float(x) + CENTRE_X_MM, 6), round(float(y), 6), round(float(z), 6)] for x, y, z in row]
        for row in surface["control_points_mm"]
    ]
    for direction in "uv":
        surface[direction]["knots"] = [round(knot, 9) for knot in surface[direction]["knots"]]
    document = {
        "spoonbill_document": 3,
        "name": "spoon-bowl",
        "body": {
            "name": "bowl",
            "surface": surface,
            "rim_uv": made["rim_uv"],
            "material": material("modelling-clay"),
            "lattice": {"node_budget": 2000},
        },
        "fixing_planes": [],
        "tool": {"kind": "sphere", "action": "push", "radius_mm": 8.0, "substeps": 6},
        "sculpting": {"drag_per_s": 12.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 60.0},
        "view": {
            "camera": {"yaw_deg": 30, "pitch_deg": 35, "target_mm": [134, -4, 0], "distance_mm": 170},
        },
    }
    write(document)


main()
