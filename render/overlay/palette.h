// The colours with a meaning, in sRGB, shared by the marks in the scene and by the legend. Every meaning also
// has a shape of its own, so that nothing rests on telling red from green.
#pragma once

#include <cstdint>

namespace spoonbill {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
};

namespace palette {

inline constexpr Colour fixed_node{28, 150, 84};    // squares
inline constexpr Colour touched_node{214, 40, 46};  // discs
inline constexpr Colour lattice{52, 62, 74, 150};   // the thinnest lines
inline constexpr Colour cell_edge{178, 30, 52};     // thick lines
inline constexpr Colour far_cell_edge{178, 30, 52, 170};
inline constexpr Colour control_net{38, 66, 128, 190};  // thin lines and diamonds
inline constexpr Colour force{226, 116, 14};            // the arrow
inline constexpr Colour contact_normal{112, 46, 134};   // short lines
inline constexpr Colour fixing_plane{28, 150, 84, 40};
inline constexpr Colour fixing_plane_border{22, 122, 70, 210};
inline constexpr Colour symmetry_plane{38, 92, 168, 210};  // dash-dotted
inline constexpr Colour tool{52, 118, 204};
inline constexpr Colour ground_line{70, 78, 88};
inline constexpr Colour scale_bar{48, 54, 62};
inline constexpr Colour hull{96, 58, 160, 170};            // thin lines from point to point
inline constexpr Colour parameter_range{0, 124, 132};      // thick borders on the surface
inline constexpr Colour kept_sphere{178, 34, 116};         // translucent shells
inline constexpr Colour kept_second_sphere{20, 92, 168};   // of the other surface
inline constexpr Colour dropped_sphere{92, 100, 112, 90};  // faint ones
inline constexpr Colour active_triangle{246, 196, 24, 205};
inline constexpr Colour triangle_edge{120, 84, 0};
inline constexpr Colour tangent_u{0, 118, 196};  // an arrow, named in the picture
inline constexpr Colour tangent_v{0, 132, 104};
inline constexpr Colour text{38, 43, 50};

}  // namespace palette
}  // namespace spoonbill
