#!/usr/bin/env python3
"""Writes CalculiX decks of a flat punch and of a sphere on a round block (indented_gel_test.cpp).

"make_indented_gel_decks.py FOLDER" writes all decks; run each with "ccx NAME". Units are N, mm and MPa. The
blocks are axisymmetric (CAX8R), of a nearly incompressible neo-Hookean material, at finite strain, and fixed on
their base. CalculiX reports the force on a sector of two degrees of the circumference.
indented_gel_results.csv has this force at the end of each step, and 180 times it for the whole circumference.
"""
import math
import os
import sys

YOUNGS_MODULUS = 0.005


def graded(start, end, first, last):
    """Returns the points of an interval whose steps grow evenly from `first` to `last`."""
    count = max(1, round(2.0 * (end - start) / (first + last)))
    ratio = (last / first) ** (1.0 / max(1, count - 1))
    steps = [ratio**k for k in range(count)]
    points, at = [start], start
    for step in steps:
        at += step * (end - start) / sum(steps)
        points.append(at)
    points[-1] = end
    return points


class Grid:
    """Eight-node quadrilaterals between lines of constant r and z, mapped by `place`."""

    def __init__(self, first_node, first_element, r, z, place=lambda r, z: (r, z)):
        self.r, self.z = r, z
        self.nodes, self.elements = {}, {}
        self.node_at = {}
        number = first_node

        def midway(points, i):
            return points[i // 2] if i % 2 == 0 else 0.5 * (points[i // 2] + points[i // 2 + 1])

        for i in range(2 * len(r) - 1):
            for j in range(2 * len(z) - 1):
                if i % 2 and j % 2:
                    continue
                self.node_at[i, j] = number
                self.nodes[number] = place(midway(r, i), midway(z, j))
                number += 1
        at = self.node_at
        element = first_element
        self.element_at = {}
        for i in range(0, 2 * len(r) - 2, 2):
            for j in range(0, 2 * len(z) - 2, 2):
                self.element_at[i // 2, j // 2] = element
                self.elements[element] = [at[i, j], at[i + 2, j], at[i + 2, j + 2], at[i, j + 2],
                                          at[i + 1, j], at[i + 2, j + 1], at[i + 1, j + 2], at[i, j + 1]]
                element += 1

    def top(self):
        j = 2 * len(self.z) - 2
        return [self.node_at[i, j] for i in range(2 * len(self.r) - 1)]

    def bottom(self):
        return [self.node_at[i, 0] for i in range(2 * len(self.r) - 1)]

    def axis(self):
        return [self.node_at[0, j] for j in range(2 * len(self.z) - 1)]


def write_numbers(out, header, numbers):
    out.write(header + "\n")
    for k in range(0, len(numbers), 10):
        out.write(", ".join(str(n) for n in numbers[k:k + 10]) + ",\n")


def write_grid(out, grid, name):
    out.write("*NODE\n")
    for number, (r, z) in grid.nodes.items():
        out.write(f"{number}, {r:.9g}, {z:.9g}\n")
    out.write(f"*ELEMENT, TYPE=CAX8R, ELSET={name}\n")
    for number, corners in grid.elements.items():
        out.write(f"{number}, " + ", ".join(str(n) for n in corners) + "\n")


def write_gel(out, poissons_ratio):
    shear = YOUNGS_MODULUS / (2.0 * (1.0 + poissons_ratio))
    bulk = YOUNGS_MODULUS / (3.0 * (1.0 - 2.0 * poissons_ratio))
    out.write(f"*MATERIAL, NAME=GEL\n*HYPERELASTIC, NEO HOOKE\n{0.5 * shear:.12g}, {2.0 / bulk:.12g}\n")
    out.write("*SOLID SECTION, ELSET=GEL, MATERIAL=GEL\n")


def write_step(out, travel, nodes):
    out.write("*STEP, NLGEOM, INC=500\n*STATIC\n0.1, 1., 1e-6, 0.1\n")
    out.write(f"*BOUNDARY\nPUSHED, 2, 2, {-travel:.9g}\n")
    out.write("*NODE PRINT, NSET=PUSHED, TOTALS=ONLY, FREQUENCY=1000\nRF\n")
    out.write(f"*NODE PRINT, NSET={nodes}, FREQUENCY=1000\nU\n*END STEP\n")


def write_punch(path, radius, block, height, poissons_ratio, depths, is_bonded, finest, base_axes="1, 2"):
    """A flat punch: the nodes of the top within `radius` move down. Bonded: they do not move along r."""
    with open(path, "w") as out:
        r = graded(0.0, radius, 4.0 * finest, finest)
        if radius < block:
            r += graded(radius, block, finest, 5.0 * finest)[1:]
        z = graded(0.0, height, 8.0 * finest, finest)
        grid = Grid(1, 1, r, z)
        out.write(f"** Flat punch of radius {radius}, {'bonded' if is_bonded else 'slipping'}; ")
        out.write(f"block of radius {block}, height {height}, nu {poissons_ratio}; cells of {finest} at the edge\n")
        write_grid(out, grid, "GEL")
        pushed = [n for n in grid.top() if grid.nodes[n][0] < radius + 1e-9]
        write_numbers(out, "*NSET, NSET=PUSHED", pushed)
        write_numbers(out, "*NSET, NSET=EDGE", [pushed[-1]])
        write_numbers(out, "*NSET, NSET=BASE", grid.bottom())
        write_numbers(out, "*NSET, NSET=AXIS", grid.axis())
        write_gel(out, poissons_ratio)
        out.write(f"*BOUNDARY\nBASE, {base_axes}\nAXIS, 1, 1\n")
        if is_bonded:
            out.write("PUSHED, 1, 1\n")
        for depth in depths:
            write_step(out, depth, "EDGE")


def write_contact(path, what, profile, ends, near, block, height, poissons_ratio, depths, finest, fine_from=0.0,
                  stiffness=2000.0, kind="NODE TO SURFACE", thickness=0.2):
    """Presses a rigid shell, of which all nodes are moved, on the block. `profile(s, d)` is the point at the
    arc length s, from 0 to the last of `ends`, and the depth d in the shell, relative to the block's top.
    The top within `near` may touch it without friction. Its cells have the finest size from `fine_from` on and
    are up to four times as large within. The contact has `stiffness` times Young's modulus, 1/mm, and is of the
    given kind."""
    with open(path, "w") as out:
        r = graded(0.0, near, finest, finest)
        if fine_from > 0.0:
            r = graded(0.0, fine_from, 4.0 * finest, finest) + graded(fine_from, near, finest, finest)[1:]
        r += graded(near, block, finest, 8.0 * finest)[1:]
        z = graded(0.0, height, 8.0 * finest, finest)
        grid = Grid(1, 1, r, z)
        arc = [0.0]
        for k in range(len(ends)):
            start = ends[k - 1] if k else 0.0
            step = min(finest, (ends[k] - start) / 16.0)
            arc += graded(start, ends[k], step, step)[1:]
        shell = Grid(100001, 100001, arc, [0.0, thickness], lambda s, d: (
            profile(s, d)[0], height + profile(s, d)[1]))
        out.write(f"** {what}; block of radius {block}, height {height}, nu {poissons_ratio}; ")
        out.write(f"cells of {finest} at the contact\n")
        write_grid(out, grid, "GEL")
        write_grid(out, shell, "RIGID")
        write_numbers(out, "*NSET, NSET=PUSHED", list(shell.nodes))
        write_numbers(out, "*NSET, NSET=BASE", grid.bottom())
        write_numbers(out, "*NSET, NSET=AXIS", grid.axis())
        write_numbers(out, "*NSET, NSET=CENTRE", [grid.axis()[-1]])
        write_gel(out, poissons_ratio)
        out.write(f"*MATERIAL, NAME=STIFF\n*ELASTIC\n{1e4 * YOUNGS_MODULUS:.9g}, 0.3\n")
        out.write("*SOLID SECTION, ELSET=RIGID, MATERIAL=STIFF\n")
        out.write("*SURFACE, NAME=TOP\n")
        for i in range(len(r) - 1):
            if r[i] < near - 1e-9:
                out.write(f"{grid.element_at[i, len(z) - 2]}, S3\n")
        out.write("*SURFACE, NAME=FACE\n")
        for i in range(len(arc) - 1):
            out.write(f"{shell.element_at[i, 0]}, S1\n")
        out.write("*SURFACE INTERACTION, NAME=SLIP\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n")
        out.write(f"{stiffness * YOUNGS_MODULUS:.9g}, 1e-12\n")
        out.write(f"*CONTACT PAIR, INTERACTION=SLIP, TYPE={kind}\nTOP, FACE\n")
        out.write("*BOUNDARY\nBASE, 1, 2\nAXIS, 1, 1\nPUSHED, 1, 1\n")
        for depth in depths:
            write_step(out, depth, "CENTRE")


def write_sphere(path, radius, block, height, poissons_ratio, depths, finest):
    near = 1.6 * math.sqrt(radius * max(depths))
    write_contact(path, f"Sphere of radius {radius}, slipping", lambda s, d: (
        (radius - d) * math.sin(s / radius), radius - (radius - d) * math.cos(s / radius)),
        [near], near, block, height, poissons_ratio, depths, finest)


def write_rounded_punch(path, radius, rounding, block, height, poissons_ratio, depths, finest):
    """A flat punch without friction, whose edge is rounded. The gel slides outwards along its face and around
    its edge, and touches its side. Contact of nodes with a surface does not converge there.

    Contact of surfaces lets the cell at the axis pass through the face: by 0.4 mm at a depth of 4 mm with cells of
    0.4 mm, by 0.02 mm at 0.5 mm with cells of 0.15 mm. Where the nodes of the top within 4.35 mm are moved down
    with the punch instead, cells of 0.4 mm give 0.6 % more force at 0.5 mm and 0.7 % more at 4 mm."""
    flat = radius - rounding
    quarter = 0.5 * math.pi * rounding

    def profile(s, d):
        if s <= flat:
            return s, d
        angle = min((s - flat) / rounding, 0.5 * math.pi)
        beyond = max(0.0, s - flat - quarter)
        return flat + (rounding - d) * math.sin(angle), rounding - (rounding - d) * math.cos(angle) + beyond

    write_contact(path, f"Punch of radius {radius}, edge rounded by {rounding}, slipping",
                  profile, [flat, flat + quarter, flat + quarter + max(depths)], radius + 0.6, block, height,
                  poissons_ratio, depths, finest, fine_from=radius - 2.0, stiffness=100.0,
                  kind="SURFACE TO SURFACE", thickness=0.5 * rounding)


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)

    def at(name):
        return os.path.join(folder, name + ".inp")

    for finest in [0.4, 0.2, 0.1]:
        # Finer cells fold at the edge before 4 mm.
        depths = [0.5, 4.0] if finest > 0.1 else [0.5]
        write_punch(at(f"bonded-{finest}"), 6.35, 15.0, 20.0, 0.49, depths, True, finest)
    # With cells of 0.2 mm, CalculiX does not get to 4 mm.
    for finest in [0.4, 0.3]:
        write_rounded_punch(at(f"slipping-{finest}"), 6.35, 0.4, 15.0, 20.0, 0.49, [0.5, 4.0], finest)
    for finest in [0.2, 0.15]:
        write_rounded_punch(at(f"slipping-sharp-{finest}"), 6.35, 0.1, 15.0, 20.0, 0.49, [0.5], finest)
    for nu in [0.45, 0.49]:
        write_sphere(at(f"sphere-{nu}"), 10.0, 20.0, 20.0, nu, [0.5, 1.0, 2.0], 0.3)
        write_sphere(at(f"sphere-{nu}-fine"), 10.0, 20.0, 20.0, nu, [0.5, 1.0], 0.15)
    # Checks of the decks: a sphere on a wide layer (0.01119 N by Dimitriadis et al. 2002), and a slipping cylinder
    # under uniform pressure (0.0015708 N), which shows that forces are those of two degrees.
    write_sphere(at("sphere-layer"), 10.0, 80.0, 20.0, 0.49, [0.5], 0.3)
    write_punch(at("bar"), 10.0, 10.0, 20.0, 0.3, [0.02], False, 1.0, base_axes="2, 2")


main()
