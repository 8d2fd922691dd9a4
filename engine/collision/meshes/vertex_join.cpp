#include "engine/collision/meshes/vertex_join.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr std::uint32_t none = 0xffffffffU;
// A cell this many tolerances wide is rarely near its neighbours and cannot hold many vertices that stay.
constexpr double cell_tolerances = 4.0;

// The finishing steps of MurmurHash3 (Appleby 2011), so that places of a regular pattern spread.
std::uint64_t mixed(std::uint64_t bits) {
  bits ^= bits >> 33;
  bits *= 0xff51afd7ed558ccdULL;
  bits ^= bits >> 33;
  bits *= 0xc4ceb9fe1a85ec53ULL;
  return bits ^ (bits >> 33);
}

std::uint64_t mixed(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return mixed(x + mixed(y + mixed(z)));
}

std::size_t table_size(std::size_t entries) {
  return std::bit_ceil(2 * entries + 2);
}

JoinedVertices join_equal(const std::vector<Vector3>& vertices) {
  JoinedVertices result;
  result.joined_into.reserve(vertices.size());
  std::vector<std::uint32_t> table(table_size(vertices.size()), none);
  const std::uint64_t mask = table.size() - 1;
  for (const Vector3& given : vertices) {
    const Vector3 vertex = given.array() + 0.0;  // one zero, not two
    const auto bits = [&](int axis) { return std::bit_cast<std::uint64_t>(vertex[axis]); };
    std::uint64_t slot = mixed(bits(0), bits(1), bits(2)) & mask;
    while (table[slot] != none && result.vertices_m[table[slot]] != vertex) slot = (slot + 1) & mask;
    if (table[slot] == none) {
      table[slot] = static_cast<std::uint32_t>(result.vertices_m.size());
      result.vertices_m.push_back(vertex);
    }
    result.joined_into.push_back(table[slot]);
  }
  return result;
}

// The vertices that stay, in chains by the cell of a grid; chains of cells that share a slot are mixed.
class NearVertices {
 public:
  NearVertices(std::size_t count, double tolerance)
      : tolerance_(tolerance), first_(table_size(count), none), mask_(first_.size() - 1) {
    next_.reserve(count);
  }

  std::uint32_t find(const Vector3& vertex, const std::vector<Vector3>& staying) const {
    const auto low = cell(vertex.array() - tolerance_), high = cell(vertex.array() + tolerance_);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          for (std::uint32_t at = first_[slot({x, y, z})]; at != none; at = next_[at]) {
            if ((staying[at] - vertex).squaredNorm() <= tolerance_ * tolerance_) return at;
          }
        }
      }
    }
    return none;
  }

  // The vertex that now stays as the last.
  void add(const Vector3& vertex) {
    std::uint32_t& first = first_[slot(cell(vertex))];
    next_.push_back(first);
    first = static_cast<std::uint32_t>(next_.size() - 1);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell(const Vector3& place) const {
    const Vector3 cells = place / (cell_tolerances * tolerance_);
    return {static_cast<std::int64_t>(std::floor(cells.x())),
            static_cast<std::int64_t>(std::floor(cells.y())),
            static_cast<std::int64_t>(std::floor(cells.z()))};
  }
  std::size_t slot(const Cell& cell) const {
    return mixed(static_cast<std::uint64_t>(cell[0]), static_cast<std::uint64_t>(cell[1]),
                 static_cast<std::uint64_t>(cell[2])) &
           mask_;
  }

  double tolerance_;
  std::vector<std::uint32_t> first_, next_;
  std::uint64_t mask_;
};

}  // namespace

JoinedVertices join_vertices(const std::vector<Vector3>& vertices_m, double tolerance_m) {
  SPOONBILL_ASSERT(tolerance_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(
      std::all_of(vertices_m.begin(), vertices_m.end(), [](const Vector3& at) { return at.allFinite(); }));
  JoinedVertices result = join_equal(vertices_m);
  const std::vector<Vector3> distinct = std::move(result.vertices_m);
  result.vertices_m.clear();
  NearVertices near(distinct.size(), tolerance_m);
  std::vector<std::uint32_t> joined;
  joined.reserve(distinct.size());
  for (const Vector3& vertex : distinct) {
    std::uint32_t into = near.find(vertex, result.vertices_m);
    if (into == none) {
      into = static_cast<std::uint32_t>(result.vertices_m.size());
      near.add(vertex);
      result.vertices_m.push_back(vertex);
    }
    joined.push_back(into);
  }
  for (std::uint32_t& into : result.joined_into) into = joined[into];
  return result;
}

}  // namespace spoonbill
