// Solids as bytes between the program and its child (frame_stream.h): a line of JSON, then the mesh's
// vertices as doubles and its triangles as indices of 32 bits.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_solid.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {

std::string cad_solid_to_bytes(const CadSolid& solid);
// `source` names the file in messages, of whose model the solid is, which has so many surfaces. Refused:
// bytes that are no such solid, numbers out of their ranges.
Result<CadSolid> cad_solid_from_bytes(std::string_view bytes, std::size_t surfaces,
                                      const std::string& source);

// Places among so many surfaces; the reader is told of what is none.
std::vector<std::size_t> read_places(FieldReader& reader, std::string_view field, std::size_t surfaces);

}  // namespace spoonbill
