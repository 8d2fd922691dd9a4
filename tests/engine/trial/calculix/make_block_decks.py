#!/usr/bin/env python3
"""Writes CalculiX decks of a block with rounded edges at rest on a slipping base (sag_test.cpp), and reads the
result.

The block is modelled as a cylinder of the same height and nearly the same ratio of outline to area, so that
the rounding of the upper and lower edge has the same effect. x is the radius, y the height. Usage:
"make_block_decks.py NAME ROUNDING POISSON" writes NAME.inp; after "ccx NAME",
"make_block_decks.py NAME" prints the area-weighted mean drop of the flat top over rho g H^2 / 2 E.
"""
import math
import sys

HEIGHT, RADIUS = 15.0, 13.3  # mm; 2 / 13.3 mm = 108 mm / 720 mm^2
YOUNGS, WEIGHT = 1.0, 1e-4   # N/mm^2; weight density, N/mm^3


def rows_of(rounding):
    """Heights and the radius there, from the base to the top, one for each half row of elements."""
    if rounding == 0.0:
        return [(HEIGHT * j / 80, RADIUS) for j in range(81)]
    arc = [(rounding * (1 - math.cos(a)), RADIUS - rounding * (1 - math.sin(a)))
           for a in (0.5 * math.pi * k / 16 for k in range(17))]
    corners = []  # the rows grow away from the rounding
    y, step = rounding, 0.15 * rounding
    while y < 0.5 * HEIGHT:
        corners.append(y)
        y, step = y + step, 1.25 * step
    last = corners[-1]
    corners = [rounding + (c - rounding) * (0.5 * HEIGHT - rounding) / (last - rounding) for c in corners]
    between = [(0.5 * (a + b), RADIUS) for a, b in zip(corners, corners[1:])]
    low = arc + [p for pair in zip(between, [(c, RADIUS) for c in corners[1:]]) for p in pair]
    return low + [(HEIGHT - y, r) for y, r in reversed(low[:-1])]


def columns_of(rounding):
    """Fractions of the radius, one for each half column, dense at the edge."""
    size = max(rounding, 0.3) / RADIUS
    ends, step = [1.0], 0.1 * size
    while ends[-1] > 1.5 * step and len(ends) < 200:
        ends.append(ends[-1] - step)
        step *= 1.2
    ends = [0.0] + sorted(ends)
    half = [0.5 * (a + b) for a, b in zip(ends, ends[1:])]
    return sorted(ends + half)


def write(name, rounding, poisson):
    rows, columns = rows_of(rounding), columns_of(rounding)
    number, lines = {}, ["*NODE, NSET=NALL"]
    for j, (y, r) in enumerate(rows):
        for i, x in enumerate(columns):
            if i % 2 and j % 2:
                continue
            number[i, j] = len(number) + 1
            lines.append("%d, %.9g, %.9g" % (number[i, j], x * r, y))
    lines.append("*ELEMENT, TYPE=CAX8R, ELSET=ALL")
    element = 0
    for j in range(0, len(rows) - 1, 2):
        for i in range(0, len(columns) - 1, 2):
            element += 1
            at = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
            lines.append("%d, " % element + ", ".join(str(number[i + a, j + b]) for a, b in at))
    for label, wanted in (("BASE", lambda i, j: j == 0), ("AXIS", lambda i, j: i == 0),
                          ("TOP", lambda i, j: j == len(rows) - 1)):
        lines.append("*NSET, NSET=" + label)
        lines.extend("%d," % n for key, n in number.items() if wanted(*key))
    lines += ["*MATERIAL, NAME=GEL", "*ELASTIC", "%g, %g" % (YOUNGS, poisson), "*DENSITY", "1.",
              "*SOLID SECTION, ELSET=ALL, MATERIAL=GEL", "*BOUNDARY", "AXIS, 1, 1", "BASE, 2, 2", "*STEP",
              "*STATIC", "*DLOAD", "ALL, GRAV, %g, 0., -1., 0." % WEIGHT, "*NODE PRINT, NSET=TOP", "U",
              "*NODE PRINT, NSET=TOP, GLOBAL=YES", "RF", "*END STEP"]
    open(name + ".inp", "w").write("\n".join(lines) + "\n")


def read(name):
    at, top, mode = {}, [], ""
    for line in open(name + ".inp"):
        if line.startswith("*"):
            mode = line.strip()
        elif mode.startswith("*NODE, "):
            n, x, _ = line.split(",")
            at[int(n)] = float(x)
        elif mode == "*NSET, NSET=TOP":
            top.append(int(line.split(",")[0]))
    drops, reading = {}, False
    for line in open(name + ".dat"):
        if "displacements" in line:
            reading = True
        elif "forces" in line:
            break
        elif reading and line.strip():
            words = line.split()
            drops[int(words[0])] = -float(words[2])
    top.sort(key=lambda n: at[n])
    total = area = 0.0
    for a, m, b in zip(top[0::2], top[1::2], top[2::2]):  # Simpson's rule
        half = (at[b] - at[a]) / 6.0
        area += half * (at[a] + 4 * at[m] + at[b])
        total += half * (at[a] * drops[a] + 4 * at[m] * drops[m] + at[b] * drops[b])
    print(name, total / area / (WEIGHT * HEIGHT ** 2 / (2.0 * YOUNGS)))


if len(sys.argv) == 2:
    read(sys.argv[1])
else:
    write(sys.argv[1], float(sys.argv[2]), float(sys.argv[3]))
