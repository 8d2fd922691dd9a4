// Volumes of the layers of a lattice, which are between nodes of consecutive k, and cell fractions that
// correct these volumes.
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

// Scales the cell fractions so that each layer has its wanted volume, m^3. If a layer's factor would be
// beyond 1/2 to 2, scales all cells alike to the wanted sum.
void scale_layers_to(std::span<const double> wanted_m3, LatticeMesh& mesh);

// Divides the volumes of the layers of one lattice among `layers` layers of equal thickness along k of
// another over the same body.
std::vector<double> redistribute_layers(std::span<const double> volumes_m3, int layers);

// Stations of a lattice in a tube: the parameters v between its layers, and the parameters u of its rings.
// The first and the last value of `v` are the poles, because the volume between a pole and the nearest slice
// belongs to the outermost layer.
struct TubeStations {
  std::vector<double> v;
  RingParameters ring;
};

// Returns the volume of a closed tube between consecutive slices of its lattice, m^3. Their sum is the volume
// of the tube. Triangles between the outer edges of a slice and the ring extend it to the surface.
std::vector<double> tube_layer_volumes_m3(const Surface& surface, const TubeStations& stations,
                                          const LatticeMesh& mesh);

}  // namespace spoonbill
