#!/usr/bin/env python3
"""Makes soft-grip.json, our own model: the spoon handle, made 18 mm wide and 12 mm thick, of beech, with a skin of
soft silicone 2 mm thick over its rear half that does not slip.

Friction against skin: about 0.35 of dry wood, about 0.9 of silicone rubber.

Usage: soft_grip.py > soft-grip.json
"""
import os

from documents import material, model, write

WIDER, THICKER = 1.5, 2.4


def main():
    document = model("spoon-handle")
    document["name"] = "soft-grip"
    body = document["body"]
    for line in body["surface"]["control_points_mm"]:
        for point in line:
            point[1] = round(point[1] * THICKER, 6)
            point[2] = round(point[2] * WIDER, 6)
    body["material"] = dict(material("beech"), friction=0.35)
    body["lattice"] = {"node_budget": 4000}
    body["regions"] = [
        {
            "region": {"along": [0.0, 0.5], "depth_mm": [0.0, 2.0]},
            "material": material("silicone-soft"),
            "friction": 0.9,
        }
    ]
    document["fixing_planes"] = [{"point_mm": [92.0, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}]
    document["tool"]["radius_mm"] = 6.0
    document["sculpting"] = {"drag_per_s": 120.0, "gravity_m_per_s2": [0.0, 0.0, 0.0], "force_scale": 1.0}
    document["view"]["camera"] = {"yaw_deg": 22, "pitch_deg": 16, "target_mm": [50, -4, 0], "distance_mm": 260}
    write(document)


main()
