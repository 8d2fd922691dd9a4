#!/usr/bin/env python3
"""Makes bent-spoon.json, a spoon of spoon-handle.json and spoon-bowl.json whose handle a sphere has lifted. The program
merges and bends it; without a file, this script prints the script of the bend:

    app/run merge assets/models/spoon-handle.json assets/models/spoon-bowl.json --continuity C2 --out spoon.json
    bent_spoon.py > bend.script.json
    app/run record bend.script.json --out bend.recording.jsonl
    app/run replay bend.recording.jsonl --out bend --every 999
    bent_spoon.py bend/saved-bent.json > bent-spoon.json
"""
import json
import sys

from documents import write

BEND = {
    "spoonbill_script": 1,
    "note": "A plane holds the bowl, and a sphere lifts the handle.",
    "model": "spoon.json",
    "steps": [
        {"start_mm": [22, -26, 0]},
        {"command": "place_plane", "point_mm": [96, 0, 0], "normal": [-1, 0, 0]},
        {"move_to_mm": [22, -11.5, 0], "over_s": 0.7},
        {"move_to_mm": [26, 26, 0], "over_s": 5.0},
        {"hold_s": 0.6},
        {"move_to_mm": [26, -30, 0], "over_s": 0.8},
        {"hold_s": 0.8},
        {"command": "remove_planes"},
        {"hold_s": 0.01},
        {"command": "save", "name": "bent"},
        {"hold_s": 0.1},
    ],
}


def main():
    if len(sys.argv) < 2:
        write(BEND)
        return
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    document["name"] = "bent-spoon"
    surface = document["body"]["surface"]
    surface["control_points_mm"] = [
        [[round(float(value), 4) + 0.0 for value in point] for point in row] for row in surface["control_points_mm"]
    ]
    for direction in "uv":
        surface[direction]["knots"] = [round(knot, 9) for knot in surface[direction]["knots"]]
    document["view"] = {"camera": {"yaw_deg": 30, "pitch_deg": 28}}
    write(document)


main()
