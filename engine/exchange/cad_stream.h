// Conversion of CAD surfaces and solids to and from the contents of frames (frame_stream.h).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// cad_surface_to_json() and cad_surface_from_json() convert a surface to JSON and back. The geometry has the
// same form as in a document (document.h). `source` names the CAD file in messages. Refused: a surface that a
// document could not contain.
Json cad_surface_to_json(const CadSurface& surface);
Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source);

// cad_solid_to_bytes() and cad_solid_from_bytes() convert a solid to bytes and back. The bytes are a line of
// JSON, the mesh's vertices as doubles and its triangles as 32-bit indices. `surfaces` is the number of
// surfaces of the model, `source` names the file in messages. Refused: malformed bytes, numbers out of range.
std::string cad_solid_to_bytes(const CadSolid& solid);
Result<CadSolid> cad_solid_from_bytes(std::string_view bytes, std::size_t surfaces,
                                      const std::string& source);

// Reads a list of indices less than `surfaces`; the reader refuses other values.
std::vector<std::size_t> read_surface_indices(FieldReader& reader, std::string_view field,
                                              std::size_t surfaces);

}  // namespace spoonbill
