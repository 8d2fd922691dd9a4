// Joining of the loose faces of a file into solids, before the faces are converted. Lengths are millimetres.
#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>
#include <vector>

namespace spoonbill {

// Gap between two edges up to which they may be joined, because the faces of a solid are joined again up to
// this gap when they are exported.
inline constexpr double largest_sewn_gap_mm = 0.1;

// Returns the largest tolerance that the file states for an edge or a vertex of these faces, at most
// largest_sewn_gap_mm.
double find_file_tolerance_mm(const std::vector<TopoDS_Face>& faces);

// Joins faces whose edges are at most `tolerance_mm` apart. Returns the indices of the faces of each shell
// that encloses a volume, and turns the normals of these faces outwards.
std::vector<std::vector<std::size_t>> sew_closed_shells(std::vector<TopoDS_Face>& faces, double tolerance_mm);

}  // namespace spoonbill
