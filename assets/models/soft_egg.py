#!/usr/bin/env python3
"""Makes soft-egg.json: the cushion of soft-press.json, and the egg of egg.stl to press it with.

The egg is a mesh with a lattice of its own, held by its upper part. The materials are exchanged: here the tool is of
gelatin and the body of silicone, which the board holds nearly to its top, so that the egg gives way. Both files are
read from beside this one.

Usage: soft_egg.py > soft-egg.json
"""
import os
import struct

from documents import model, write

HERE = os.path.dirname(os.path.abspath(__file__))


def egg():
    """Its corners, each once, and its triangles as places among them."""
    data = open(os.path.join(HERE, "egg.stl"), "rb").read()
    places, triangles = {}, []
    for t in range(struct.unpack_from("<I", data, 80)[0]):
        values = struct.unpack_from("<12f", data, 84 + 50 * t)[3:]
        corners = [tuple(round(value, 4) for value in values[3 * c : 3 * c + 3]) for c in range(3)]
        triangles.append([places.setdefault(corner, len(places)) for corner in corners])
    return {"shape": "mesh", "vertices_mm": [list(corner) for corner in places], "triangles": triangles}


def main():
    document = model("soft-press")
    document["name"] = "soft-egg"
    document["tool"]["solid"] = egg()
    body, soft = document["body"], document["tool"]["soft"]
    body["material"], soft["material"] = soft["material"], body["material"]
    document["fixing_planes"][0]["point_mm"] = [0, 8, 0]
    soft["lattice"] = {"node_budget": 2500}
    soft["grip"] = {"point_mm": [0, 10, 0], "normal": [0, -1, 0]}
    document["view"]["camera"].update({"target_mm": [0, 20, 0], "distance_mm": 280})
    write(document)


main()
