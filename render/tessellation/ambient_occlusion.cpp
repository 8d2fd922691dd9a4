#include "render/tessellation/ambient_occlusion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Pairs of a vertex and a disc in one update, and the discs that result from it. Beyond the second number, an
// update would take a second or more.
constexpr std::size_t wanted_pairs = 8'000'000, most_pairs = 400'000'000;
constexpr std::size_t fewest_discs = 64, most_discs = 1024;

// Returns the number of discs that each body gets: a power of two, so that it changes rarely.
std::size_t choose_disc_count(std::size_t vertices, std::size_t bodies) {
  const std::size_t all =
      std::clamp(wanted_pairs / std::max<std::size_t>(vertices, 1), fewest_discs, most_discs);
  return std::bit_floor(std::max<std::size_t>(all / std::max<std::size_t>(bodies, 1), 1));
}

Eigen::Vector3f point(const GridSamples<float>& samples, std::uint32_t at) {
  return {samples.x[at], samples.y[at], samples.z[at]};
}

}  // namespace

void AmbientOcclusion::Discs::clear() {
  for (auto* values : {&x, &y, &z, &nx, &ny, &nz, &area_m2, &two_sided}) values->clear();
}

void AmbientOcclusion::Discs::add(const Eigen::Vector3f& centre_m, const Eigen::Vector3f& area_normal_m2,
                                  bool is_two_sided) {
  const float area = area_normal_m2.norm();
  if (!(area > 0.0f)) return;
  const Eigen::Vector3f normal = area_normal_m2 / area;
  x.push_back(centre_m.x());
  y.push_back(centre_m.y());
  z.push_back(centre_m.z());
  nx.push_back(normal.x());
  ny.push_back(normal.y());
  nz.push_back(normal.z());
  area_m2.push_back(area);
  two_sided.push_back(is_two_sided ? 1.0f : 0.0f);
}

void AmbientOcclusion::update(const std::vector<TessellatedSurface>& surfaces, std::size_t parts) {
  SPOONBILL_ASSERT(parts >= 1);
  std::size_t vertices = 0;
  for (const TessellatedSurface& surface : surfaces) vertices += surface.vertex_count();
  const std::size_t wanted = choose_disc_count(vertices, surfaces.size());
  if (have_moved(surfaces, wanted)) {
    discs_.clear();
    for (std::size_t b = 0; b < surfaces.size(); ++b) {
      Groups& groups = bodies_[b].groups;
      if (!groups.fit(surfaces[b], wanted)) group(surfaces[b], wanted, groups);
      append_discs(surfaces[b], groups);
    }
    if (vertices * discs_.count() > most_pairs) discs_.clear();
    parts_left_ = parts;
  }
  if (parts_left_ == 0) return;
  --parts_left_;
  if (!fits(surfaces)) {
    for (std::size_t b = 0; b < surfaces.size(); ++b)
      bodies_[b].visibility.assign(surfaces[b].vertex_count());
    parts = 1;
    parts_left_ = 0;
  }
  part_ = (part_ + 1) % parts;
  for (std::size_t b = 0; b < surfaces.size(); ++b)
    find_visibility(surfaces[b], part_, parts, bodies_[b].visibility);
}

bool AmbientOcclusion::fits(const std::vector<TessellatedSurface>& surfaces) const {
  return std::equal(surfaces.begin(), surfaces.end(), bodies_.begin(), bodies_.end(),
                    [](const TessellatedSurface& surface, const Body& body) {
                      return body.visibility.front.size() == surface.vertex_count();
                    });
}

void AmbientOcclusion::find_visibility(const TessellatedSurface& surface, std::size_t first, std::size_t step,
                                       BothSides& visibility) const {
  const GridSamples<float>& samples = surface.samples();
  const auto seen_from = [&](const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal) {
    const float seen = 1.0f - hidden(point_m, normal);
    return std::isfinite(seen) ? std::clamp(seen, 0.0f, 1.0f) : 1.0f;
  };
  for (std::size_t v = first; v < surface.vertex_count(); v += step) {
    const Eigen::Vector3f point_m = point(samples, static_cast<std::uint32_t>(v));
    const Eigen::Vector3f normal(samples.nx[v], samples.ny[v], samples.nz[v]);
    visibility.front[v] = seen_from(point_m, normal);
    visibility.back[v] = surface.is_closed() ? visibility.front[v] : seen_from(point_m, -normal);
  }
}

bool AmbientOcclusion::have_moved(const std::vector<TessellatedSurface>& surfaces, std::size_t wanted) {
  bool moved = bodies_.size() != surfaces.size();
  bodies_.resize(surfaces.size());
  for (std::size_t b = 0; b < surfaces.size(); ++b) {
    const GridSamples<float>& samples = surfaces[b].samples();
    const std::size_t count = samples.x.size();
    std::vector<float>& last = bodies_[b].positions_m;
    moved |= last.size() != 3 * count || !bodies_[b].groups.fit(surfaces[b], wanted);
    last.resize(3 * count);
    std::size_t start = 0;
    for (const auto* plane : {&samples.x, &samples.y, &samples.z}) {
      const auto into = last.begin() + static_cast<std::ptrdiff_t>(start);
      if (!moved) moved = !std::equal(plane->begin(), plane->end(), into);
      std::copy(plane->begin(), plane->end(), into);
      start += count;
    }
  }
  return moved;
}

namespace {

// The group of a triangle: cells of a grid, and the direction that it faces.
using GroupKey = std::array<int, 4>;

// Groups the triangles of a surface by blocks of its samples, whatever its shape is.
class BlockGrouping {
 public:
  BlockGrouping(const TessellatedSurface& surface, std::size_t wanted)
      : surface_(&surface), columns_(surface.columns()), rows_(surface.rows()) {
    const double ratio = static_cast<double>(rows_) / static_cast<double>(columns_);
    const double down =
        std::clamp(std::sqrt(static_cast<double>(wanted) * ratio), 1.0, static_cast<double>(wanted));
    block_rows_ = block_size(rows_, down);
    block_columns_ = block_size(columns_, static_cast<double>(wanted) / down);
  }

  // Vertices on trim loops come after the samples. Returns nothing for a triangle with no other vertices.
  std::optional<GroupKey> operator()(std::size_t triangle) const {
    const auto* corners = &surface_->indices()[triangle];
    const std::size_t first = *std::min_element(corners, corners + 3);
    if (first >= rows_ * columns_) return std::nullopt;
    return GroupKey{static_cast<int>(first / columns_ / block_rows_),
                    static_cast<int>(first % columns_ / block_columns_), 0, 0};
  }

 private:
  static std::size_t block_size(std::size_t samples, double blocks) {
    return std::max<std::size_t>(1,
                                 static_cast<std::size_t>(std::ceil(static_cast<double>(samples) / blocks)));
  }

  const TessellatedSurface* surface_;
  std::size_t columns_, rows_, block_rows_ = 1, block_columns_ = 1;
};

// Groups the triangles of a mesh by the cells of a regular grid that hold their centres, and by the direction
// that they face, so that both sides of a thin wall become discs of their own.
class CellGrouping {
 public:
  CellGrouping(const TessellatedSurface& surface, std::size_t wanted) : surface_(&surface) {
    float area_m2 = 0.0f;
    for (std::size_t i = 0; i + 2 < surface.indices().size(); i += 3) {
      const float size = 0.5f * double_area(i).norm();
      if (std::isfinite(size)) area_m2 += size;
    }
    cell_m_ = std::sqrt(std::max(area_m2, 1e-12f) / static_cast<float>(wanted));
  }

  // Returns nothing for a triangle that is not finite.
  std::optional<GroupKey> operator()(std::size_t triangle) const {
    const Eigen::Vector3f normal = double_area(triangle);
    const Eigen::Vector3f cell =
        ((corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / (3.0f * cell_m_))
            .array()
            .floor();
    constexpr float most_cells = 1e6f;
    if (!normal.allFinite() || !(cell.cwiseAbs().maxCoeff() < most_cells)) return std::nullopt;
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return GroupKey{static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z()),
                    2 * axis + (normal[axis] > 0.0f ? 1 : 0)};
  }

 private:
  Eigen::Vector3f corner(std::size_t triangle, std::size_t k) const {
    return point(surface_->samples(), surface_->indices()[triangle + k]);
  }
  Eigen::Vector3f double_area(std::size_t triangle) const {
    const Eigen::Vector3f a = corner(triangle, 0);
    return (corner(triangle, 1) - a).cross(corner(triangle, 2) - a);
  }

  const TessellatedSurface* surface_;
  float cell_m_ = 1.0f;
};

template <class Grouping>
std::map<GroupKey, std::vector<std::uint32_t>> group_triangles(std::size_t index_count,
                                                               const Grouping& grouping) {
  std::map<GroupKey, std::vector<std::uint32_t>> groups;
  for (std::size_t i = 0; i + 2 < index_count; i += 3) {
    if (const auto key = grouping(i)) groups[*key].push_back(static_cast<std::uint32_t>(i));
  }
  return groups;
}

}  // namespace

void AmbientOcclusion::group(const TessellatedSurface& surface, std::size_t wanted, Groups& groups) {
  groups.topology_version = surface.topology_version();
  groups.index_count = surface.indices().size();
  groups.wanted = wanted;
  groups.triangles.clear();
  groups.ends.clear();
  const auto found = surface.is_mesh() ? group_triangles(groups.index_count, CellGrouping(surface, wanted))
                                       : group_triangles(groups.index_count, BlockGrouping(surface, wanted));
  for (const auto& [key, triangles] : found) {
    groups.triangles.insert(groups.triangles.end(), triangles.begin(), triangles.end());
    groups.ends.push_back(static_cast<std::uint32_t>(groups.triangles.size()));
  }
}

void AmbientOcclusion::append_discs(const TessellatedSurface& surface, const Groups& groups) {
  const GridSamples<float>& samples = surface.samples();
  const std::vector<std::uint32_t>& indices = surface.indices();
  std::size_t t = 0;
  for (const std::uint32_t end : groups.ends) {
    Eigen::Vector3f centre = Eigen::Vector3f::Zero(), area_normal = Eigen::Vector3f::Zero();
    float weight = 0.0f;
    for (; t < end; ++t) {
      const std::uint32_t i = groups.triangles[t];
      const Eigen::Vector3f a = point(samples, indices[i]), b = point(samples, indices[i + 1]),
                            c = point(samples, indices[i + 2]);
      const Eigen::Vector3f twice = (b - a).cross(c - a);
      const float size = twice.norm();
      centre += size * (a + b + c) / 3.0f;
      area_normal += 0.5f * twice;
      weight += size;
    }
    if (weight > 0.0f) discs_.add(centre / weight, area_normal, !surface.is_closed());
  }
}

float AmbientOcclusion::hidden(const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal) const {
  const float px = point_m.x(), py = point_m.y(), pz = point_m.z();
  const float nx = normal.x(), ny = normal.y(), nz = normal.z();
  constexpr auto pi = std::numbers::pi_v<float>;
  constexpr int lanes = 16;
  std::array<float, lanes> sums{};
  const std::size_t count = discs_.count();
  const auto add = [&](std::size_t d, float& sum) {
    const float x = discs_.x[d] - px, y = discs_.y[d] - py, z = discs_.z[d] - pz;
    const float square = x * x + y * y + z * z + 1e-12f;
    const float above = std::max(nx * x + ny * y + nz * z, 0.0f);
    const float facing = -(discs_.nx[d] * x + discs_.ny[d] * y + discs_.nz[d] * z);
    const float seen = std::max(facing, -discs_.two_sided[d] * facing);
    const float area = discs_.area_m2[d];
    sum += area * above * std::max(seen, 0.0f) / (square * (pi * square + area));
  };
  std::size_t d = 0;
  for (; d + lanes <= count; d += lanes) {
    for (std::size_t k = 0; k < lanes; ++k) add(d + k, sums[k]);
  }
  for (; d < count; ++d) add(d, sums[0]);
  float sum = 0.0f;
  for (const float lane : sums) sum += lane;
  return sum;
}

}  // namespace spoonbill
