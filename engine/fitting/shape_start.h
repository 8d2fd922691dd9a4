// Which kind of shape points are of, and their first parameters.
#pragma once

#include <optional>

#include "engine/base/result.h"
#include "engine/fitting/fit_points.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {

// By its rims: one that spans much of the shape makes a sheet, two as long as the shape is around make a
// tube, smaller ones are holes of a closed shape.
ShapeKind kind_of_shape(const FitPoints& island);

// Adds nodes over all holes and open ends.
void span_all_holes(FitPoints& island);

// Spans the holes of an island (adds nodes to it) and lays its nodes out in (u, v). Poles of a closed shape
// lie on its axis where it is round about one, else as far apart as its surface allows. Refused: a shape that
// cannot be laid out so.
Result<Parameterisation> first_parameters(FitPoints& island, ShapeKind kind);

}  // namespace spoonbill
