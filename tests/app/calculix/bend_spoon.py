#!/usr/bin/python3
"""bend_spoon.py STEP SIZE_MM: meshes a spoon with tetrahedra of ten nodes by gmsh, bends it with CalculiX (ccx) as the
program's bend_spoon() does, and prints the drop of the front of the rim. Needs Debian's python3-gmsh and calculix-ccx.

bent_spoon_results.csv is its output for

    spoonbill convert assets/models/spoon-bent.json bent.step
    bend_spoon.py bent.step 1.5

and again with 1.25. The hand, the loaded point and the measured point are those that bend_spoon() finds on spoon-bent."""
import subprocess
import sys
import tempfile
from pathlib import Path

import gmsh
import numpy

# Polypropylene in MPa and t/mm3; lengths in mm.
MODULUS, POISSON, DENSITY, GRAVITY = 1500.0, 0.42, 9e-10, 9806.65
FRONT = numpy.array([0.999999, 0.001401, 0.0])
HAND = 29.5831  # from the end of the handle
LOADED, MEASURED = numpy.array([131.2712, -7.8449, 0.0655]), numpy.array([163.0995, 0.4531, 0.1604])
FOODS_KG = (0.0, 0.0062)


def mesh(step, size):
    """Numbers and positions of the nodes, and the nodes of each tetrahedron in the order of CalculiX."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.importShapes(step)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.5 * size)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    tags, places, _ = gmsh.model.mesh.getNodes()
    _, elements, nodes = gmsh.model.mesh.getElements(3)
    tetrahedra = nodes[0].reshape(len(elements[0]), -1)[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]
    used = numpy.isin(tags, numpy.unique(tetrahedra))
    return tags[used], places.reshape(-1, 3)[used], tetrahedra


def deck(tags, places, tetrahedra):
    along = places @ FRONT
    nearest = [tags[numpy.argmin(((places - point) ** 2).sum(1))] for point in (LOADED, MEASURED)]
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{tag}, {x:.8f}, {y:.8f}, {z:.8f}" for tag, (x, y, z) in zip(tags, places)]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=SPOON"]
    lines += [f"{k + 1}, " + ", ".join(map(str, nodes)) for k, nodes in enumerate(tetrahedra)]
    lines += ["*NSET, NSET=HAND"] + [f"{tag}," for tag in tags[along <= along.min() + HAND]]
    lines += ["*NSET, NSET=FRONT", f"{nearest[1]},", "*MATERIAL, NAME=M", "*ELASTIC", f"{MODULUS}, {POISSON}", "*DENSITY",
              f"{DENSITY:g}", "*SOLID SECTION, ELSET=SPOON, MATERIAL=M", "*BOUNDARY", "HAND, 1, 3"]
    for food in FOODS_KG:
        lines += ["*STEP, NLGEOM", "*STATIC", "1.0, 1.0", "*DLOAD, OP=NEW", f"SPOON, GRAV, {GRAVITY}, 0., -1., 0.",
                  "*CLOAD, OP=NEW", f"{nearest[0]}, 2, {-1e-3 * food * GRAVITY:.8g}", "*NODE PRINT, NSET=FRONT", "U",
                  "*END STEP"]
    return "\n".join(lines) + "\n"


def main():
    step, size = sys.argv[1], float(sys.argv[2])
    tags, places, tetrahedra = mesh(step, size)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "spoon.inp").write_text(deck(tags, places, tetrahedra), encoding="utf-8")
        subprocess.run(["ccx", "spoon"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        results = Path(folder, "spoon.dat").read_text(encoding="utf-8")
    rows = [line.split() for line in results.splitlines()]
    drops = [-float(row[2]) for row in rows if len(row) == 4 and row[0].isdigit()]
    for food, drop in zip(FOODS_KG, drops):
        print(f"{size},{len(tags)},{HAND},{food},{drop}")


main()
