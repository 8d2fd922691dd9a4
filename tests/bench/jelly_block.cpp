#include "tests/bench/jelly_block.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

namespace spoonbill {
namespace {

constexpr int node_count = jelly_counts[0] * jelly_counts[1] * jelly_counts[2];
constexpr double nearest_m = 1e-6;  // the solution states positions to seven digits

Vector3 node_m(int i, int j, int k) {
  const auto at = [](int index, int axis) {
    return jelly_size_m[axis] * index / (jelly_counts[static_cast<std::size_t>(axis)] - 1);
  };
  return {at(i, 0) - 0.5 * jelly_size_m.x(), at(j, 1), at(k, 2) - 0.5 * jelly_size_m.z()};
}

// Calls visit(i, j, k) for every node.
template <class Visit>
void visit_nodes(const Visit& visit) {
  for (int i = 0; i < jelly_counts[0]; ++i) {
    for (int j = 0; j < jelly_counts[1]; ++j) {
      for (int k = 0; k < jelly_counts[2]; ++k) visit(i, j, k);
    }
  }
}

// Returns the fraction of a whole node's cells that meet at a node: 1 inside, 1/2 on a face.
double cell_share(int index, int count) {
  return index == 0 || index == count - 1 ? 0.5 : 1.0;
}

}  // namespace

Material jelly_material() {
  Material material;
  material.name = material.source = "benchmark";
  material.youngs_modulus_pa = 4300.0;
  material.poissons_ratio = 0.49;
  material.density_kg_per_m3 = 1030.0;
  material.damping_time_s = 0.0005;
  return material;
}

int jelly_node_index(int i, int j, int k) {
  const int above = (j + jelly_counts[1] - 1) % jelly_counts[1];  // the base, j = 0, comes last
  return (above * jelly_counts[0] + i) * jelly_counts[2] + k;
}

std::vector<Vector3> jelly_nodes_m() {
  std::vector<Vector3> nodes(node_count);
  visit_nodes([&](int i, int j, int k) {
    nodes[static_cast<std::size_t>(jelly_node_index(i, j, k))] = node_m(i, j, k);
  });
  return nodes;
}

int jelly_free_node_count() {
  return jelly_counts[0] * (jelly_counts[1] - 1) * jelly_counts[2];
}

std::vector<double> jelly_node_masses_kg() {
  const double cells = (jelly_counts[0] - 1) * (jelly_counts[1] - 1) * (jelly_counts[2] - 1);
  const double cell_kg = jelly_material().density_kg_per_m3 * jelly_size_m.prod() / cells;
  std::vector<double> masses(node_count);
  visit_nodes([&](int i, int j, int k) {
    masses[static_cast<std::size_t>(jelly_node_index(i, j, k))] = cell_kg * cell_share(i, jelly_counts[0]) *
                                                                  cell_share(j, jelly_counts[1]) *
                                                                  cell_share(k, jelly_counts[2]);
  });
  return masses;
}

Result<std::vector<Vector3>> read_jelly_solution_m(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);  // names of the columns
  std::vector<std::array<double, 6>> rows;
  while (std::getline(in, line)) {
    for (char& c : line) c = c == ',' ? ' ' : c;
    std::istringstream words(line);
    std::array<double, 6> row{};
    for (double& value : row) words >> value;
    if (words) rows.push_back(row);
  }
  std::vector<Vector3> solution(node_count);
  int found = 0;
  visit_nodes([&](int i, int j, int k) {
    const Vector3 at = node_m(i, j, k), side(at.x() < 0.0 ? -1.0 : 1.0, 1.0, at.z() < 0.0 ? -1.0 : 1.0);
    for (const auto& row : rows) {
      if ((Vector3(row[0], row[1], row[2]) - at.cwiseProduct(side)).norm() > nearest_m) continue;
      const Vector3 moved(row[3], row[4], row[5]);
      solution[static_cast<std::size_t>(jelly_node_index(i, j, k))] = moved.cwiseProduct(side);
      ++found;
    }
  });
  if (found == node_count) return solution;
  return Error{ErrorCode::missing, file + ": it does not have each node of the block once", "nodes"};
}

double relative_jelly_error(std::span<const Vector3> displacements_m, std::span<const Vector3> solution_m) {
  double differences = 0.0, squares = 0.0;
  for (std::size_t n = 0; n < solution_m.size(); ++n) {
    differences += (displacements_m[n] - solution_m[n]).squaredNorm();
    squares += solution_m[n].squaredNorm();
  }
  const double error = std::sqrt(differences / squares);
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

double jelly_sag_m(std::span<const Vector3> displacements_m) {
  double sum = 0.0;
  for (int i = 0; i < jelly_counts[0]; ++i) {
    for (int k = 0; k < jelly_counts[2]; ++k) {
      sum -= displacements_m[static_cast<std::size_t>(jelly_node_index(i, jelly_counts[1] - 1, k))].y();
    }
  }
  return sum / (jelly_counts[0] * jelly_counts[2]);
}

}  // namespace spoonbill
