#!/usr/bin/env python3
"""Writes a CalculiX deck of the block of `trial_vs_peer`, and reads its solution.

The block is 30 x 15 x 24 mm, with E 4.3 kPa, a Poisson's ratio of 0.49 and 1030 kg/m^3. It stands on a fixed base and
sags under its own weight. The material is neo-Hookean and the strain finite. Because of symmetry, the deck has only a
quarter of the block, of 20-node bricks with reduced integration, which do not lock. The bricks beside the edges of the
base are halved again and again, because the stress is singular there. The nodes of the lattice of 12 x 6 x 10 nodes are
nodes of the deck.

Usage: jelly.py deck REFINEMENT HALVINGS > jelly.inp    bricks per cell of the lattice along an edge: 2, 4, ...
       ccx -i jelly
       jelly.py solution < jelly.dat > jelly-sag.csv

jelly-sag.csv has a line for each node of the lattice in the quarter with x > 0 and z > 0: its position at rest and its
displacement, m. The origin is the centre of the base. It was made with a refinement of 2 and 5 halvings; with 4 halvings
it differs by 0.05 %, as the root of the mean square.
"""
import csv
import sys

NODES = (12, 6, 10)
SIZE_M = (0.030, 0.015, 0.024)
YOUNGS_MODULUS_PA, POISSONS_RATIO, DENSITY, GRAVITY = 4300.0, 0.49, 1030.0, 9.80665

# Corners of a brick, then midpoints of its edges, in the order of CalculiX. Counted in half edges.
BRICK = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2), (1, 0, 0), (2, 1, 0),
         (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
MIDDLE_X, BASE, MIDDLE_Z = 0, 1, 2  # the coordinate that is 0 there


def lattice_positions():
    """Returns the positions of the lattice's nodes in the quarter along x, y and z, in metres."""
    cells = [length / (count - 1) for length, count in zip(SIZE_M, NODES)]
    return ([(i + 0.5) * cells[0] for i in range(NODES[0] // 2)], [j * cells[1] for j in range(NODES[1])],
            [(k + 0.5) * cells[2] for k in range(NODES[2] // 2)])


def half_edges(axis, refinement, halvings):
    """Returns the coordinates of ends and midpoints of bricks along an axis. An even refinement halves an odd number of
    cells."""
    extent = SIZE_M[axis] if axis == BASE else SIZE_M[axis] / 2
    bricks = (NODES[axis] - 1) * refinement // (1 if axis == BASE else 2)
    ends = [extent * k / bricks for k in range(bricks + 1)]
    shortest = extent / bricks
    for _ in range(halvings):
        shortest /= 2
        ends.append(shortest if axis == BASE else extent - shortest)
    ends.sort()
    middles = [(a + b) / 2 for a, b in zip(ends, ends[1:])]
    return sorted(ends + middles)


def print_card(text, numbers, a_line=8):
    numbers = list(numbers)
    print(text)
    for k in range(0, len(numbers), a_line):
        print(",".join(map(str, numbers[k:k + a_line])))


def write_deck(refinement, halvings):
    axes = [half_edges(axis, refinement, halvings) for axis in range(3)]
    lattice = [[min(range(len(axis)), key=lambda k: abs(axis[k] - at)) for at in positions]
               for axis, positions in zip(axes, lattice_positions())]

    def number(i, j, k):
        return 1 + i + len(axes[0]) * (j + len(axes[1]) * k)

    used, bricks = {}, []
    for k in range(0, len(axes[2]) - 1, 2):
        for j in range(0, len(axes[1]) - 1, 2):
            for i in range(0, len(axes[0]) - 1, 2):
                points = [(i + a, j + b, k + c) for a, b, c in BRICK]
                used.update((number(*point), point) for point in points)
                bricks.append([number(*point) for point in points])
    print("*NODE, NSET=ALL")
    for node, point in sorted(used.items()):
        print(node, *(f"{axis[at]:.9g}" for axis, at in zip(axes, point)), sep=",")
    print("*ELEMENT, TYPE=C3D20R, ELSET=BLOCK")
    for index, nodes in enumerate(bricks):
        print(",".join(map(str, [index + 1, *nodes[:10]])) + ",\n" + ",".join(map(str, nodes[10:])))
    for name, axis in (("MIDDLEX", MIDDLE_X), ("BASE", BASE), ("MIDDLEZ", MIDDLE_Z)):
        print_card(f"*NSET, NSET={name}", (node for node, point in sorted(used.items()) if point[axis] == 0))
    print_card("*NSET, NSET=LATTICE",
               (number(i, j, k) for k in lattice[2] for j in lattice[1] for i in lattice[0]))
    shear = YOUNGS_MODULUS_PA / (2 * (1 + POISSONS_RATIO))
    bulk = YOUNGS_MODULUS_PA / (3 * (1 - 2 * POISSONS_RATIO))
    print(f"*MATERIAL, NAME=JELLY\n*HYPERELASTIC, NEO HOOKE\n{shear / 2:.9g},{2 / bulk:.9g}\n*DENSITY\n{DENSITY}")
    print("*SOLID SECTION, ELSET=BLOCK, MATERIAL=JELLY")
    print("*BOUNDARY\nBASE,1,3\nMIDDLEX,1\nMIDDLEZ,3")
    print(f"*STEP, NLGEOM\n*STATIC\n0.5,1.\n*DLOAD\nBLOCK,GRAV,{GRAVITY},0.,-1.,0.")
    print("*NODE PRINT, NSET=LATTICE, FREQUENCY=1000\nU\n*END STEP")


def write_solution():
    """Nodes come in the order of their numbers: x changes fastest, z slowest."""
    x, y, z = lattice_positions()
    words = [line.split() for line in sys.stdin]
    moved = [[float(word) for word in line[1:]] for line in words if len(line) == 4 and line[0].isdigit()]
    moved = moved[-len(x) * len(y) * len(z):]
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["x", "y", "z", "dx", "dy", "dz"])
    positions = [(i, j, k) for k in z for j in y for i in x]
    for position, displacement in zip(positions, moved):
        out.writerow([f"{value:.7g}" for value in (*position, *displacement)])


if __name__ == "__main__":
    if sys.argv[1] == "deck":
        write_deck(int(sys.argv[2]), int(sys.argv[3]))
    else:
        write_solution()
