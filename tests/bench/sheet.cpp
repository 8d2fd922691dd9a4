#include "tests/bench/sheet.h"

#include <cmath>

namespace spoonbill {

Surface wavy_sheet(int side) {
  const KnotVector knots = KnotVector::clamped_uniform(3, side).value();
  ControlNet net(side, side);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const double a = static_cast<double>(i) / (side - 1), b = static_cast<double>(j) / (side - 1);
      net.set_point(i, j, {a, 0.1 * std::sin(7.0 * a) * std::cos(5.0 * b), b});
    }
  }
  return make_surface(knots, knots, std::move(net)).value();
}

Grid sheet_grid(const Surface& sheet, int samples) {
  return make_grid(sheet.u, sheet.v, uniform_parameters(sheet.u, samples),
                   uniform_parameters(sheet.v, samples))
      .value();
}

std::vector<float> dense_table(const BlendingMatrix& matrix) {
  std::vector<float> table(static_cast<std::size_t>(matrix.rows) * matrix.columns);
  for (int row = 0; row < matrix.rows; ++row) {
    for (int k = 0; k < matrix.bandwidth; ++k) {
      table[static_cast<std::size_t>(row) * matrix.columns + matrix.column(row, k)] +=
          static_cast<float>(matrix.values[static_cast<std::size_t>(row) * matrix.bandwidth + k]);
    }
  }
  return table;
}

std::vector<float> in_single(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

}  // namespace spoonbill
