#!/usr/bin/env python3
"""step_surface.py STEP UNIT_M POINTS: measures how far the surfaces of a STEP file are from the points of a table.

Reads only the entities B_SPLINE_SURFACE_WITH_KNOTS and the CARTESIAN_POINTs that they name, and evaluates with scipy.
Each line of the table is surface,u,v,x_m,y_m,z_m; surfaces are counted from 0 in the order of the file. Prints the
largest distance in metres."""
import re
import sys

import numpy as np
from scipy.interpolate import BSpline


def entities(text):
    """Returns a dict from entity number to (name, arguments as text). Entities with several names are skipped."""
    data = text[text.index("DATA;"):]
    data = re.sub(r"\s+", " ", data)
    found = {}
    for number, name, arguments in re.findall(r"#(\d+) ?= ?([A-Z_0-9]+) ?\((.*?)\) ?;", data):
        found[int(number)] = (name, arguments)
    return found


def values(text):
    """Returns an argument list as nested lists of texts: numbers, references such as '#12', and other words."""
    text = re.sub(r"'(?:[^']|'')*'", "''", text)
    stack = [[]]
    for token in re.findall(r"[()]|[^(),\s]+", text):
        if token == "(":
            stack.append([])
        elif token == ")":
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(token)
    assert len(stack) == 1, "unbalanced parentheses"
    return stack[0]


def flat_knots(multiplicities, knots):
    return np.repeat([float(knot) for knot in knots], [int(count) for count in multiplicities])


def surfaces(text):
    known = entities(text)

    def point(reference):
        name, arguments = known[int(reference[1:])]
        assert name == "CARTESIAN_POINT"
        return [float(coordinate) for coordinate in values(arguments)[-1]]

    for number in sorted(known):
        name, arguments = known[number]
        if name != "B_SPLINE_SURFACE_WITH_KNOTS":
            continue
        _, u_degree, v_degree, net, _, _, _, _, u_counts, v_counts, u_knots, v_knots, _ = values(arguments)
        net = np.array([[point(reference) for reference in row] for row in net])
        yield int(u_degree), int(v_degree), net, flat_knots(u_counts, u_knots), flat_knots(v_counts, v_knots)


def evaluate(surface, u, v):
    u_degree, v_degree, net, u_knots, v_knots = surface
    along_u = BSpline(u_knots, np.eye(net.shape[0]), u_degree)(u)
    along_v = BSpline(v_knots, np.eye(net.shape[1]), v_degree)(v)
    return np.einsum("ki,ijc,kj->kc", along_u, net, along_v)


def main():
    step, unit_m, table = sys.argv[1:]
    with open(step, encoding="ascii") as file:
        found = list(surfaces(file.read()))
    points = np.loadtxt(table, delimiter=",", ndmin=2)
    count = int(points[:, 0].max()) + 1
    if len(found) != count:
        sys.exit(f"{step}: {len(found)} surfaces, {count} expected")
    largest = 0.0
    for k, surface in enumerate(found):
        rows = points[points[:, 0] == k]
        at = evaluate(surface, rows[:, 1], rows[:, 2]) * float(unit_m)
        largest = max(largest, np.abs(np.linalg.norm(at - rows[:, 3:], axis=1)).max())
    print(largest)


main()
