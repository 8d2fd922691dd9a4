#!/usr/bin/env python3
"""Makes the spoons of section 5.1 of Pungotra et al. 2013 with the program, from the handle, the bowl and recordings:

    spoons.py [--out DIR] [NAME...]

writes the documents of these names (default: all) into a folder (default: beside this script). The environment variable
SPOONBILL_PROGRAM names the program; the default is app/run.

    spoon-original    handle and bowl, merged
    spoon-bent        the original, whose handle a sphere has lifted, for a wrist that hardly bends
    spoon-grip-bulge  a handle with four finger ridges that a sphere has pulled out
    spoon-grip-dent   a handle with four dents that a sphere has pressed in
    spoon-thick       a round handle of 38 mm, for a hand that closes with little force
    spoon-rough       the original with a grip of high friction
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from documents import HERE, write

ROOT = os.path.dirname(os.path.dirname(HERE))
RECORDINGS = os.path.join(ROOT, "assets", "recordings")
VIEW = {"camera": {"yaw_deg": 30, "pitch_deg": 28}}
# Radius and place along the handle, in mm, of the thick handle. It ends in a neck that the bowl continues.
THICK_PROFILE = [(0, 0), (8, 0.5), (14.8, 4), (18.1, 14), (18.8, 25), (18.6, 50), (15.5, 70), (9.5, 84), (5.5, 93), (4, 100)]
ROUGH = {"region": {"along": [0.02, 0.6]}, "friction": 1.2}


def run(folder, *arguments):
    """Runs the program in a folder."""
    program = os.environ.get("SPOONBILL_PROGRAM", os.path.join(ROOT, "app", "run"))
    done = subprocess.run([program, *arguments], cwd=folder, stdout=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        sys.exit(f"spoons: 'spoonbill {' '.join(arguments)}' failed")


def shipped(name):
    return os.path.join(HERE, name + ".json")


def merge_with_bowl(folder, handle):
    run(folder, "merge", handle, shipped("spoon-bowl"), "--continuity", "C2", "--out", "spoon.json")


def replay(folder, recording, saved):
    run(folder, "replay", os.path.join(RECORDINGS, recording + ".recording.jsonl"), "--no-frames", "--save", saved)


def original(folder):
    merge_with_bowl(folder, shipped("spoon-handle"))


def bent(folder):
    replay(folder, "spoon-bent", "spoon.json")


def gripped(recording):
    def make_spoon(folder):
        replay(folder, recording, "handle.json")
        merge_with_bowl(folder, "handle.json")

    return make_spoon


def thick(folder):
    with open(os.path.join(folder, "profile.csv"), "w", encoding="utf-8") as file:
        file.write("radius_mm,height_mm\n")
        file.writelines(f"{radius},{height}\n" for radius, height in THICK_PROFILE)
    run(folder, "new", "lathe", "--profile", "profile.csv", "--tolerance", "0.1mm", "--out", "lathe.json")
    run(folder, "change", "lathe.json", "rotate", "z", "-90deg", "--about", "0,0,0", "--out", "lying.json")
    run(folder, "change", "lying.json", "align", "x", "high", "98mm", "--out", "handle.json")
    merge_with_bowl(folder, "handle.json")


def finish(name, document):
    """The document with rounded numbers, a view and the name of the concept."""
    document["name"] = document["body"]["name"] = name
    surface = document["body"]["surface"]
    surface["control_points_mm"] = [
        [[round(float(value), 4) + 0.0 for value in point] for point in row] for row in surface["control_points_mm"]
    ]
    for direction in "uv":
        surface[direction]["knots"] = [round(knot, 9) for knot in surface[direction]["knots"]]
    document["view"] = VIEW
    return document


MAKERS = {
    "spoon-original": original,
    "spoon-bent": bent,
    "spoon-grip-bulge": gripped("grip-bulge"),
    "spoon-grip-dent": gripped("grip-dent"),
    "spoon-thick": thick,
}


def make(name, out):
    """Makes the document of a name. The rough spoon is made from the original in the folder `out`."""
    if name == "spoon-rough":
        with open(os.path.join(out, "spoon-original.json"), encoding="utf-8") as file:
            document = json.load(file)
        document["body"]["regions"] = [ROUGH]
        return finish(name, document)
    with tempfile.TemporaryDirectory() as folder:
        MAKERS[name](folder)
        with open(os.path.join(folder, "spoon.json"), encoding="utf-8") as file:
            return finish(name, json.load(file))


def main():
    names = [*MAKERS, "spoon-rough"]
    parser = argparse.ArgumentParser(description="Makes the spoons of section 5.1 of Pungotra et al. 2013.")
    parser.add_argument("--out", metavar="DIR", default=HERE, help="folder of the documents; default: beside this script")
    parser.add_argument("names", metavar="NAME", nargs="*", help=f"default: all of {', '.join(names)}")
    options = parser.parse_args()
    for name in options.names:
        if name not in names:
            parser.error(f"'{name}' is unknown; choose from {', '.join(names)}")
    os.makedirs(options.out, exist_ok=True)

    def make_file(name):
        document = make(name, options.out)
        with open(os.path.join(options.out, name + ".json"), "w", encoding="utf-8") as file:
            write(document, file)

    wanted = options.names or names
    with ThreadPoolExecutor(os.cpu_count()) as crew:
        list(crew.map(make_file, (name for name in wanted if name != "spoon-rough")))
    if "spoon-rough" in wanted:
        make_file("spoon-rough")


main()
