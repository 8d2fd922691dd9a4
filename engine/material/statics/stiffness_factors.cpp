#include "engine/material/statics/stiffness_factors.h"

#include <utility>
#include <vector>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Number of multiplications between two calls of may_continue(). So many multiplications take some
// milliseconds.
constexpr double work_between_calls = 5e6;

}  // namespace

// Working memory for the next row of the factor L.
struct StiffnessFactors::Workspace {
  explicit Workspace(int size)
      : values(static_cast<std::size_t>(size)),
        pattern(values.size()),
        path(values.size()),
        visited(values.size(), -1) {}

  std::vector<double> values;  // values of the row by column; 0 outside the pattern
  // From index `top` on: the columns of the row's entries, each before the columns that depend on it.
  std::vector<int> pattern;
  std::vector<int> path;     // path up the elimination tree
  std::vector<int> visited;  // for each column: the last row with an entry in the column
  std::size_t top = 0;
  double multiplications = 0.0;
};

// Follows the elimination tree from each entry of the matrix's row, as in T. A. Davis, Algorithm 849 (LDL),
// ACM Transactions on Mathematical Software 31 (2005).
void StiffnessFactors::find_row_pattern(const StaticSystem::Stiffness& upper, int row,
                                        Workspace& work) const {
  work.top = work.pattern.size();
  work.visited[static_cast<std::size_t>(row)] = row;
  for (StaticSystem::Stiffness::InnerIterator entry(upper, row); entry; ++entry) {
    auto column = static_cast<int>(entry.index());
    if (column > row) continue;
    work.values[static_cast<std::size_t>(column)] += entry.value();
    std::size_t length = 0;
    for (; work.visited[static_cast<std::size_t>(column)] != row; column = m_parent[column]) {
      work.path[length++] = column;
      work.visited[static_cast<std::size_t>(column)] = row;
    }
    while (length > 0) work.pattern[--work.top] = work.path[--length];
  }
}

// Solves for the row's entries, appends them to the columns of L and returns the row's pivot.
double StiffnessFactors::eliminate_row(int row, Workspace& work) {
  const int* start = m_matrix.outerIndexPtr();
  int* rows = m_matrix.innerIndexPtr();
  double* factor = m_matrix.valuePtr();
  double pivot = std::exchange(work.values[static_cast<std::size_t>(row)], 0.0);
  for (std::size_t at = work.top; at < work.pattern.size(); ++at) {
    const int column = work.pattern[at];
    const double value = std::exchange(work.values[static_cast<std::size_t>(column)], 0.0);
    const int end = start[column] + m_nonZerosPerCol[column];
    for (int p = start[column]; p < end; ++p)
      work.values[static_cast<std::size_t>(rows[p])] -= factor[p] * value;
    const double entry = value / m_diag[column];
    pivot -= entry * value;
    rows[end] = row;
    factor[end] = entry;
    work.multiplications += ++m_nonZerosPerCol[column];
  }
  return pivot;
}

bool StiffnessFactors::factor(const StaticSystem::Stiffness& matrix,
                              const std::function<bool()>& may_continue) {
  SPOONBILL_ASSERT(m_analysisIsOk && matrix.rows() == m_parent.size());
  const auto size = static_cast<int>(matrix.rows());
  StaticSystem::Stiffness upper(size, size);
  upper.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
  m_diag.resize(size);
  m_factorizationIsOk = false;
  m_info = Eigen::NumericalIssue;
  Workspace work(size);
  double next_call = 0.0;
  for (int row = 0; row < size; ++row) {
    if (work.multiplications >= next_call) {
      if (!may_continue()) return false;
      next_call = work.multiplications + work_between_calls;
    }
    find_row_pattern(upper, row, work);
    m_nonZerosPerCol[row] = 0;
    m_diag[row] = eliminate_row(row, work);
    if (m_diag[row] == 0.0) break;
    if (row + 1 == size) m_info = Eigen::Success;
  }
  m_factorizationIsOk = true;
  return true;
}

}  // namespace spoonbill
