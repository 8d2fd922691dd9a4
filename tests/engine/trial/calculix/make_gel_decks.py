#!/usr/bin/env python3
"""Writes the CalculiX decks of a gel that stands on its wide end under its own weight (gel_sag_test.cpp).

The gel is a truncated cone, modelled as axisymmetric: x is the radius, y the height. Run each deck with
"ccx NAME". The sag is the last y displacement of the node on the axis at the top, divided by the height.
"""
import sys

# The mould is a choice: no source was found for the diameters of the glass of the SAG test, only for its depth of
# 3.125 in. It is so wide that the gel stands upright on a base that sticks (make_sway_deck.py).
HEIGHT, BASE_RADIUS, TOP_RADIUS = 0.079375, 0.040, 0.026  # m
DENSITY, GRAVITY = 1320.0, 9.80665
COLUMNS, ROWS = 12, 30  # elements along the radius and the height


def deck(shear_modulus, poissons_ratio, sticks, columns=COLUMNS, rows=ROWS):
    bulk = 2.0 * shear_modulus * (1.0 + poissons_ratio) / (3.0 * (1.0 - 2.0 * poissons_ratio))
    number = {}
    lines = ["** Gel of shear modulus %g Pa, Poisson's ratio %g, base %s" %
             (shear_modulus, poissons_ratio, "sticks" if sticks else "slips"), "*NODE, NSET=NALL"]
    for j in range(2 * rows + 1):
        for i in range(2 * columns + 1):
            if i % 2 and j % 2:
                continue  # eight-node elements have no node in the middle
            number[i, j] = len(number) + 1
            y = HEIGHT * j / (2 * rows)
            x = (BASE_RADIUS + (TOP_RADIUS - BASE_RADIUS) * y / HEIGHT) * i / (2 * columns)
            lines.append("%d, %.7f, %.7f" % (number[i, j], x, y))
    lines.append("*ELEMENT, TYPE=CAX8R, ELSET=GEL")
    element = 0
    for j in range(0, 2 * rows, 2):
        for i in range(0, 2 * columns, 2):
            element += 1
            corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
            lines.append("%d, " % element + ", ".join(str(number[i + a, j + b]) for a, b in corners))

    def nodes(name, wanted):
        lines.append("*NSET, NSET=" + name)
        lines.extend("%d," % n for key, n in number.items() if wanted(*key))

    nodes("BASE", lambda i, j: j == 0)
    nodes("AXIS", lambda i, j: i == 0)
    nodes("SIDE", lambda i, j: i == 2 * columns)
    nodes("TOP", lambda i, j: i == 0 and j == 2 * rows)
    lines += ["*MATERIAL, NAME=GEL", "*HYPERELASTIC, NEO HOOKE",
              "%.8g, %.8g" % (0.5 * shear_modulus, 2.0 / bulk), "*DENSITY", "%g" % DENSITY,
              "*SOLID SECTION, ELSET=GEL, MATERIAL=GEL", "*BOUNDARY", "AXIS, 1, 1",
              "BASE, %d, 2" % (1 if sticks else 2), "*STEP, NLGEOM, INC=1000", "*STATIC",
              "0.05, 1.0, 1e-5, 0.05", "*DLOAD", "GEL, GRAV, %g, 0., -1., 0." % GRAVITY,
              "*NODE PRINT, NSET=TOP, FREQUENCY=1000", "U", "*NODE PRINT, NSET=SIDE, FREQUENCY=1000", "U",
              "*END STEP"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) == 7:
        _, name, modulus, ratio, base, wide, high = sys.argv
        open(name, "w").write(deck(float(modulus), float(ratio), base == "sticks", int(wide), int(high)))
    else:
        for base, modulus in (("slips", 429.0), ("sticks", 379.0)):
            open("gel_%s.inp" % base, "w").write(deck(modulus, 0.49, base == "sticks"))
