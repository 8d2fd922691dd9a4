#!/usr/bin/env python3
"""Writes a CalculiX deck of half a gel that sags and is then pushed sideways by a thousandth of its weight.

If the top (the last result) moves against the push, the upright gel is unstable and would topple. Usage:
"make_sway_deck.py NAME SHEAR_MODULUS slips|sticks BASE_RADIUS TOP_RADIUS", then "ccx NAME". z = 0 is the plane
of symmetry, y the height; a half disc is the image of 6 x 3 elements.
"""
import math
import sys

HEIGHT, DENSITY, POISSON = 0.079375, 1320.0, 0.49
NX, NZ, NY = 6, 3, 8

name, base = sys.argv[1], sys.argv[3]
modulus, low, high = float(sys.argv[2]), float(sys.argv[4]), float(sys.argv[5])
bulk = 2.0 * modulus * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON))
number, lines = {}, ["*NODE, NSET=NALL"]
for k in range(2 * NY + 1):
    for j in range(2 * NZ + 1):
        for i in range(2 * NX + 1):
            if i % 2 + j % 2 + k % 2 > 1:
                continue
            number[i, j, k] = len(number) + 1
            u, v, y = i / NX - 1.0, j / (2 * NZ), HEIGHT * k / (2 * NY)
            radius = low + (high - low) * y / HEIGHT
            lines.append("%d, %.8f, %.8f, %.8f" % (number[i, j, k], radius * u * math.sqrt(1 - v * v / 2), y,
                                                   radius * v * math.sqrt(1 - u * u / 2)))
lines.append("*ELEMENT, TYPE=C3D20R, ELSET=GEL")
at = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2), (1, 0, 0), (2, 1, 0),
      (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
element = 0
for k in range(0, 2 * NY, 2):
    for j in range(0, 2 * NZ, 2):
        for i in range(0, 2 * NX, 2):
            element += 1
            nodes = [str(number[i + b, j + a, k + c]) for a, b, c in at]
            lines += ["%d, " % element + ", ".join(nodes[:15]) + ",", ", ".join(nodes[15:])]
for label, wanted in (("BASE", lambda i, j, k: k == 0), ("SYMMETRY", lambda i, j, k: j == 0),
                      ("CENTRE", lambda i, j, k: i == NX and j == 0 and k == 0),
                      ("TOP", lambda i, j, k: i == NX and j == 0 and k == 2 * NY)):
    lines.append("*NSET, NSET=" + label)
    lines.extend("%d," % n for key, n in number.items() if wanted(*key))
lines += ["*MATERIAL, NAME=GEL", "*HYPERELASTIC, NEO HOOKE", "%.8g, %.8g" % (0.5 * modulus, 2.0 / bulk),
          "*DENSITY", "%g" % DENSITY, "*SOLID SECTION, ELSET=GEL, MATERIAL=GEL", "*BOUNDARY", "SYMMETRY, 3, 3"]
lines += ["BASE, 1, 3"] if base == "sticks" else ["BASE, 2, 2", "CENTRE, 1, 1"]
for push, steps in ((0.0, "0.1, 1.0, 1e-5, 0.1"), (0.001, "1.0, 1.0")):
    lines += ["*STEP, NLGEOM, INC=1000", "*STATIC", steps, "*DLOAD, OP=NEW",
              "GEL, GRAV, 9.80665, %g, -1., 0." % push, "*NODE PRINT, NSET=TOP", "U", "*END STEP"]
open(name + ".inp", "w").write("\n".join(lines) + "\n")
