// Colours: the palette of the overlays and the looks of the materials.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

namespace spoonbill {

// An sRGB colour with straight alpha.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
};

// Returns the linear value, 0 to 1, of an 8-bit sRGB value.
float srgb8_to_linear(int value);

// Colours with a meaning, shared by the scene and the legend. Meanings whose colours could be confused also
// differ in shape or label, so that nothing depends on distinguishing red from green.
namespace palette {

inline constexpr Colour fixed_node{28, 150, 84};       // drawn as squares
inline constexpr Colour fixed_part{28, 150, 84, 165};  // a tint of the skin
inline constexpr Colour touched_node{214, 40, 46};     // drawn as discs
inline constexpr Colour lattice{52, 62, 74, 150};      // drawn as the thinnest lines
inline constexpr Colour cell_edge{178, 30, 52};        // drawn as thick lines
inline constexpr Colour far_cell_edge{178, 30, 52, 170};
inline constexpr Colour control_net{38, 66, 128, 190};  // drawn as thin lines and diamonds
inline constexpr Colour force{226, 116, 14};            // drawn as an arrow
inline constexpr Colour contact_normal{136, 36, 170};   // drawn as short lines
inline constexpr Colour fixing_plane{28, 150, 84, 40};
inline constexpr Colour fixing_plane_border{22, 122, 70, 210};
inline constexpr Colour symmetry_plane{38, 92, 168, 210};  // drawn dash-dotted
inline constexpr Colour tool{52, 118, 204};
inline constexpr Colour hull{96, 58, 160, 170};             // drawn as thin lines
inline constexpr Colour parameter_range{0, 124, 132};       // drawn as thick borders on the surface
inline constexpr Colour active_sphere{178, 34, 116};        // drawn as translucent shells
inline constexpr Colour active_second_sphere{20, 92, 168};  // drawn like active_sphere, for a second surface
inline constexpr Colour rejected_sphere{92, 100, 112, 90};  // drawn as faint shells
inline constexpr Colour active_triangle{246, 196, 24, 205};
inline constexpr Colour triangle_edge{120, 84, 0};
inline constexpr Colour tangent_u{0, 118, 196};  // drawn as an arrow with a label
inline constexpr Colour tangent_v{0, 132, 104};
inline constexpr Colour goal{0, 110, 150};  // drawn as thick rings and dashed paths
inline constexpr Colour reached_goal{22, 122, 70};
inline constexpr Colour text{38, 43, 50};

}  // namespace palette

// The cause of an uneven skin: finger marks, wood grain, pores, or brush marks.
enum class SurfacePattern { none, smeared, grain, pores, brushed };

// The look of a material. Affects drawing only, not the physics.
struct SurfaceLook {
  Eigen::Vector3f base_colour = {0.5f, 0.5f, 0.5f};  // linear reflectance; metals: tint of the reflection
  float roughness = 0.6f;                            // 0: mirror, 1: chalk
  float metalness = 0.0f;                            // 0 or 1
  // 0: opaque, up to clear_translucency: light enters the skin, beyond: the other side shows, 1: clear.
  float translucency = 0.0f;
  SurfacePattern pattern = SurfacePattern::none;

  bool is_clear() const;
};

inline constexpr float clear_translucency = 0.4f;
inline bool SurfaceLook::is_clear() const {
  return translucency > clear_translucency;
}

// Returns the look of a material. A table lists words such as "clay" and "steel"; the first of them that the
// name contains ("modelling-clay", "steel-304") selects the look. Upper and lower case are equal. Other names
// get a neutral matt grey.
SurfaceLook find_material_look(std::string_view name);

}  // namespace spoonbill
