"""measure_mesh.py FILE: prints the number of triangles and the enclosed volume of a mesh, as meshio reads it."""
import sys

import meshio
import numpy

mesh = meshio.read(sys.argv[1])
triangles = numpy.vstack([cells.data for cells in mesh.cells if cells.type == "triangle"])
a, b, c = (mesh.points[triangles[:, k]].astype(float) for k in range(3))
print(len(triangles), repr(float(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6)))
