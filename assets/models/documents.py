"""What the scripts that make the bundled models share: shipped files, the JSON form of a tube, the file on standard
output."""
import json
import os
import sys

sys.dont_write_bytecode = True  # the folder is the user's
HERE = os.path.dirname(os.path.abspath(__file__))


def material(name):
    """A shipped material, as its file has it."""
    with open(os.path.join(HERE, "..", "materials", name + ".json"), encoding="utf-8") as file:
        return json.load(file)


def model(name):
    """A document beside the scripts."""
    with open(os.path.join(HERE, name + ".json"), encoding="utf-8") as file:
        return json.load(file)


def tube(degree, v_knots, points):
    """The surface through rows of control points, one row for each of the even knots around; clamped along v."""
    count = len(points)
    return {
        "u": {"degree": degree, "periodic": True, "knots": [k / count for k in range(count + 1)]},
        "v": {"degree": degree, "periodic": False, "knots": v_knots},
        "control_points_mm": points,
    }


def write(document, file=None):
    """Writes the document, to standard output by default."""
    print(json.dumps(document, separators=(",", ":")), file=file)
