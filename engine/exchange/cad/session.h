// OpenCASCADE's settings, which belong to the whole process: the reason why CAD files are handled in a
// process of their own.
#pragma once

#include <string_view>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// Makes OpenCASCADE print nothing, compute in millimetres, and change no geometry by its own choice. Call
// once, before anything is read or written.
void prepare_occt();

// Of the files written from now on.
void choose_schema(StepSchema schema);
void choose_unit(std::string_view unit);  // mm, cm, m or in

}  // namespace spoonbill
