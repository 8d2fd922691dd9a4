#include <algorithm>

#include "engine/material/springs/spring_lattice.h"

namespace spoonbill {

void SpringLattice::write_shape(std::vector<float>& shape) const {
  shape.clear();
  visit_shape([&](const float* data, std::size_t count) { shape.insert(shape.end(), data, data + count); });
}

std::vector<float> SpringLattice::shape() const {
  std::vector<float> all;
  write_shape(all);
  return all;
}

std::vector<Vector3> SpringLattice::positions() const {
  std::vector<Vector3> all;
  all.reserve(mesh_.nodes.size());
  for (int n = 0; n < mesh_.node_count(); ++n) all.push_back(position(n));
  return all;
}

std::size_t SpringLattice::shape_size() const {
  std::size_t size = 0;
  visit_shape([&](const float*, std::size_t count) { size += count; });
  return size;
}

bool SpringLattice::set_shape(std::span<const float> shape) {
  if (shape_size() != shape.size()) return false;
  const float* from = shape.data();
  const auto take = [&](Floats& to) {
    std::copy(from, from + to.size(), to.begin());
    from += to.size();
  };
  for (Floats* a : {&dx_, &dy_, &dz_, &vx_, &vy_, &vz_}) take(*a);
  for (Floats& a : rest_length_) take(a);
  for (Floats& a : square_difference_) take(a);
  for (Floats& a : crept_) take(a);
  take(rest_volume_sum_);
  return true;
}

}  // namespace spoonbill
