// Volumes of the layers of a lattice, and cell fractions that correct these volumes. A layer consists of the
// cells between the nodes of two consecutive k.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/bspline/tube_rings.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

// Returns the filled volume of each layer, m^3: the sum over its cells of the fraction times the volume.
std::vector<double> layer_volumes_m3(const LatticeMesh& mesh);

// Scales the cell fractions so that each layer has its wanted volume, m^3. If a layer would need a factor
// below 1/2 or above 2, scales all cells by one factor instead, so that only the total volume is as wanted.
// Does nothing if the total wanted volume is not positive.
void scale_layers_to(std::span<const double> wanted_m3, LatticeMesh& mesh);

// Distributes the layer volumes of one lattice over the layers of another lattice of the same body, which has
// `layers` layers along k. The layers of each lattice are taken to be equally thick.
std::vector<double> redistribute_layers(std::span<const double> volumes_m3, int layers);

// Surface parameters of the slices of a lattice in a tube: v of each slice, and u of the nodes around it. For
// the first and the last slice, `v` holds the v of the poles instead of their own, because the volume between
// a pole and the nearest slice belongs to the outermost layer.
struct TubeStations {
  std::vector<double> v;
  RingParameters ring;
};

// Returns the volumes of a closed tube between consecutive slices of its lattice, m^3. Their sum is the
// volume of the tube. Each slice is extended to the surface by triangles between its outer edges and the
// surface's curve of constant v.
std::vector<double> tube_layer_volumes_m3(const Surface& surface, const TubeStations& stations,
                                          const LatticeMesh& mesh);

}  // namespace spoonbill
