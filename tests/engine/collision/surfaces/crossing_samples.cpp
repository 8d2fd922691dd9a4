#include "tests/engine/collision/surfaces/crossing_samples.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {
namespace {

struct Piece {
  Triangle triangle;
  Box box;
  int i, j;  // indices of the grid's finest cell that contains the triangle
};

std::vector<double> cut(const std::vector<double>& parameters, int parts) {
  std::vector<double> finer;
  for (std::size_t k = 0; k + 1 < parameters.size(); ++k) {
    for (int p = 0; p < parts; ++p) {
      finer.push_back(parameters[k] + (parameters[k + 1] - parameters[k]) * p / parts);
    }
  }
  finer.push_back(parameters.back());
  return finer;
}

std::vector<Piece> pieces_of(const Surface& surface, const NestedGrid& nested, int parts) {
  const std::vector<double> u = cut(nested.grid.u.parameters, parts),
                            v = cut(nested.grid.v.parameters, parts);
  std::vector<Vector3> at;
  for (const double a : u) {
    for (const double b : v) at.push_back(position(surface, a, b));
  }
  std::vector<Piece> pieces;
  const int columns = static_cast<int>(v.size());
  for (int i = 0; i + 1 < static_cast<int>(u.size()); ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int k = i * columns + j;
      for (const Triangle& t : {Triangle{at[k], at[k + columns], at[k + 1]},
                                Triangle{at[k + columns + 1], at[k + 1], at[k + columns]}}) {
        const Box box{t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
        pieces.push_back({t, box, i / parts, j / parts});
      }
    }
  }
  return pieces;
}

bool beside(const GridDirection& direction, int one, int other) {
  const int cells = static_cast<int>(direction.parameters.size()) - 1, apart = std::abs(one - other);
  return apart <= 1 || (direction.knots.is_periodic() && cells - apart <= 1);
}

}  // namespace

bool samples_cross(const Surface& surface, const NestedGrid& nested, int parts) {
  std::vector<Piece> pieces = pieces_of(surface, nested, parts);
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece& a, const Piece& b) { return a.box.low.x() < b.box.low.x(); });
  for (std::size_t a = 0; a < pieces.size(); ++a) {
    for (std::size_t b = a + 1; b < pieces.size() && pieces[b].box.low.x() <= pieces[a].box.high.x(); ++b) {
      if (!pieces[a].box.is_near(pieces[b].box, 0.0)) continue;
      if (beside(nested.grid.u, pieces[a].i, pieces[b].i) &&
          beside(nested.grid.v, pieces[a].j, pieces[b].j)) {
        continue;
      }
      if (triangles_meet(pieces[a].triangle, pieces[b].triangle)) return true;
    }
  }
  return false;
}

}  // namespace spoonbill
