// The surfaces of CAD models as frames hold them (frame_stream.h): JSON in the form that documents have.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/json.h"

namespace spoonbill {

Json cad_surface_to_json(const CadSurface& surface);
// `source` names the CAD file in messages. Refused: what no document could hold.
Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source);

}  // namespace spoonbill
