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

// A surface is JSON in the form of documents. `source` names the CAD file in messages. Refused: a surface
// that no document could contain.
Json cad_surface_to_json(const CadSurface& surface);
Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source);

// A solid is a line of JSON, then the mesh's vertices as doubles and its triangles as indices of 32 bits.
// `surfaces` is the number of surfaces of the model, `source` names the file in messages. Refused: bytes that
// are no such solid, numbers out of their ranges.
std::string cad_solid_to_bytes(const CadSolid& solid);
Result<CadSolid> cad_solid_from_bytes(std::string_view bytes, std::size_t surfaces,
                                      const std::string& source);

// Reads a list of indices into `surfaces` surfaces; other values are refused through the reader.
std::vector<std::size_t> read_surface_indices(FieldReader& reader, std::string_view field,
                                              std::size_t surfaces);

}  // namespace spoonbill
