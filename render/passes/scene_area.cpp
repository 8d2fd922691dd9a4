#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"
#include "render/passes/scene_passes.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

constexpr int strip_width_px = 64;
constexpr double margin_px = 14.0;  // space for marks and line widths, at an interface scale of 1

// Vertical strips that grow to enclose the projected shapes. If a point cannot be projected, the strips cover
// the whole viewport.
class Strips {
 public:
  explicit Strips(const FrameView& view)
      : view_(view),
        margin_px_(static_cast<float>(margin_px) * view.interface_scale),
        heights_(static_cast<std::size_t>((view.viewport.width_px + strip_width_px - 1) / strip_width_px)) {}

  // Collects points. The destructor lets the strips grow to enclose the box around the projected points. The
  // box contains the projection of the points' convex hull.
  class Hull {
   public:
    explicit Hull(Strips& strips) : strips_(strips) {}
    ~Hull() { strips_.mark(box_.low, box_.high); }
    Hull(const Hull&) = delete;
    Hull& operator=(const Hull&) = delete;

    void include(const Eigen::Vector3f& point_m) { box_.include(strips_.project(point_m)); }

   private:
    Strips& strips_;
    FloatBox2 box_;
  };

  void include(const Box& box) {
    if (box.is_empty()) return;
    Hull hull(*this);
    for (int i = 0; i < 8; ++i) hull.include(box.corner(i).cast<float>());
  }
  void include_sphere(const Vector3& centre_m, double radius_m) {
    Box box;
    box.include(centre_m - Vector3::Constant(radius_m));
    box.include(centre_m + Vector3::Constant(radius_m));
    include(box);
  }
  void include_points(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z) {
    for (std::size_t i = 0; i < x.size(); ++i) Hull(*this).include({x[i], y[i], z[i]});
  }
  void include_triangles(const TessellatedSurface& surface) {
    const GridSamples<float>& at = surface.samples();
    const std::vector<std::uint32_t>& indices = surface.indices();
    if (surface.is_mesh() || surface.is_trimmed()) return include_each_triangle(at, indices);
    // Each cell of the grid has two triangles with the same first corner. The other three corners of the cell
    // are among these indices, whichever way the triangles face.
    for (std::size_t first = 0; first + 5 < indices.size(); first += 6) {
      Hull hull(*this);
      for (const std::size_t corner : {0, 1, 2, 4, 5}) {
        const std::uint32_t v = indices[first + corner];
        hull.include({at.x[v], at.y[v], at.z[v]});
      }
    }
  }

  std::vector<PixelArea> areas() const {
    const int width = view_.viewport.width_px;
    if (whole_) return {{0, 0, width, view_.viewport.height_px}};
    std::vector<PixelArea> areas;
    for (std::size_t s = 0; s < heights_.size(); ++s) {
      const int x = static_cast<int>(s) * strip_width_px;
      const auto [low, high] = heights_[s];
      if (low < high) areas.push_back({x, low, std::min(strip_width_px, width - x), high - low});
    }
    return areas;
  }

 private:
  void include_each_triangle(const GridSamples<float>& at, const std::vector<std::uint32_t>& indices) {
    for (std::size_t first = 0; first < indices.size(); first += 3) {
      Hull hull(*this);
      for (std::size_t corner = first; corner < first + 3; ++corner) {
        const std::uint32_t v = indices[corner];
        hull.include({at.x[v], at.y[v], at.z[v]});
      }
    }
  }

  struct Heights {
    int low = 1 << 20, high = 0;  // pixels from the bottom
  };

  Eigen::Vector2f project(const Eigen::Vector3f& point_m) {
    const Eigen::Vector4f clip = view_.world_to_clip * point_m.homogeneous();
    if (!(clip.w() > 1e-6F)) {
      whole_ = true;
      return Eigen::Vector2f::Zero();
    }
    const Eigen::Vector2f fraction = (clip.head<2>() / clip.w()).array() * 0.5F + 0.5F;
    return {fraction.x() * static_cast<float>(view_.viewport.width_px),
            fraction.y() * static_cast<float>(view_.viewport.height_px)};
  }

  void mark(const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
    const float width = static_cast<float>(view_.viewport.width_px) - 1.0F;
    const float height = static_cast<float>(view_.viewport.height_px);
    const float left = low.x() - margin_px_, right = high.x() + margin_px_;
    const float bottom = std::max(low.y() - margin_px_, 0.0F), top = std::min(high.y() + margin_px_, height);
    if (!(left <= width && right >= 0.0F && bottom < top)) return;
    const int first = static_cast<int>(std::max(left, 0.0F)) / strip_width_px;
    const int last = static_cast<int>(std::min(right, width)) / strip_width_px;
    for (int s = first; s <= last; ++s) {
      Heights& heights = heights_[static_cast<std::size_t>(s)];
      heights.low = std::min(heights.low, static_cast<int>(bottom));
      heights.high = std::max(heights.high, static_cast<int>(std::ceil(top)));
    }
  }

  const FrameView& view_;
  const float margin_px_;
  std::vector<Heights> heights_;
  bool whole_ = false;
};

// Returns the box around a control net. The whole box must be drawn, because the lines of the net pass
// between the control points.
Box net_box(const SurfaceSnapshot& surface) {
  Box box;
  for (std::size_t i = 0; i < surface.x.size(); ++i) {
    box.include(Vector3(surface.x[i], surface.y[i], surface.z[i]));
  }
  return box;
}

void include_planes(const Snapshot& snapshot, const Overlays& on, const Box& body, Strips& strips) {
  if (on.fixing_planes) {
    for (const PlaneSnapshot& plane : snapshot.planes) {
      const PlaneCorners corners = fixing_plane_corners(plane, snapshot.bodies, body);
      Strips::Hull hull(strips);
      for (const Vector3& corner : corners) hull.include(corner.cast<float>());
      hull.include(plane_arrow_tip(corners, plane).cast<float>());
    }
  }
  if (on.symmetry_plane && snapshot.symmetric) {
    Strips::Hull hull(strips);
    for (const Vector3& corner : symmetry_plane_corners(snapshot.symmetry, body)) {
      hull.include(corner.cast<float>());
    }
  }
}

void include_tools(const Snapshot& snapshot, Strips& strips) {
  const ToolSnapshot& tool = snapshot.tool;
  const ToolBody* body = rigid_body(tool);
  const Box box = body != nullptr ? bounding_box(body->solid) : Box();
  const auto include = [&](const ToolFrame& frame) {
    if (body == nullptr) return strips.include_sphere(frame.origin_m, tool.radius_m);
    Strips::Hull hull(strips);
    for (int i = 0; i < 8; ++i) hull.include((frame.origin_m + frame.axes * box.corner(i)).cast<float>());
  };
  include(tool_frame(snapshot));
  if (snapshot.symmetric) include(mirrored_tool_frame(snapshot));
}

}  // namespace

std::vector<PixelArea> scene_area(const Snapshot& snapshot, const ViewSettings& settings,
                                  const FrameView& view, const std::vector<TessellatedSurface>& bodies) {
  const Overlays& on = settings.overlays;
  Strips strips(view);
  Box body;
  for (const TessellatedSurface& surface : bodies) {
    strips.include_triangles(surface);
    const Box box = surface.bounds();
    if (box.is_empty()) continue;
    body.join(box);
  }
  for (const BodySnapshot& each : snapshot.bodies) {
    const LatticeSnapshot& lattice = each.lattice;
    if (on.lattice || on.cells || on.fixed_nodes || on.touched_nodes) {
      strips.include_points(lattice.x, lattice.y, lattice.z);
    }
    if (on.control_net && !each.is_mesh()) strips.include(net_box(each.surface));
  }
  if (on.tool) include_tools(snapshot, strips);
  if (on.contact_normals) {
    for (const ContactSnapshot& contact : snapshot.contacts) {
      strips.include_sphere(contact.point_m, contact_normal_length_m(snapshot.tool));
    }
  }
  if (const auto arrow = force_arrow(snapshot, settings)) {
    Strips::Hull hull(strips);
    hull.include(arrow->start_m.cast<float>());
    hull.include(arrow->tip_m.cast<float>());
  }
  strips.include(bounding_box(stage_shapes(snapshot, settings)));
  include_planes(snapshot, on, body, strips);
  if (settings.goal) {
    std::vector<OverlayLine> lines;
    std::vector<OverlayMark> marks;
    append_goal(*settings.goal, lines, marks);
    for (const OverlayLine& line : lines) {
      Strips::Hull hull(strips);
      hull.include(line.start_m);
      hull.include(line.end_m);
    }
    for (const OverlayMark& mark : marks) Strips::Hull(strips).include(mark.position_m);
  }
  return strips.areas();
}

}  // namespace spoonbill
