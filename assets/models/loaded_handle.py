#!/usr/bin/env python3
"""Makes loaded-handle.json: the spoon handle in polypropylene, gripped by one end and pressed at the other.

Usage: loaded_handle.py > loaded-handle.json
"""
from documents import material, model, write


def main():
    document = model("spoon-handle")
    document["name"] = "loaded-handle"
    body = document["body"]
    body["material"] = material("polypropylene")
    body["supports"] = [{"region": {"along": [0, 0.2]}}]
    body["loads"] = [
        {"kind": "force", "region": {"along": [0.95, 1]}, "force_n": [0, -2, 0], "shared_by": "surface"},
        {"kind": "pressure", "region": {"along": [0.3, 0.5]}, "pressure_pa": 2000},
    ]
    document["sculpting"]["gravity_m_per_s2"] = [0, -9.81, 0]
    write(document)


main()
