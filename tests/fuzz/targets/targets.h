// Functions that pass bytes to one reader each.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

void take_document(std::string_view bytes);
void take_recording(std::string_view bytes);
void take_script(std::string_view bytes);
void take_points(std::string_view bytes);
void take_ply(std::string_view bytes);
void take_stl(std::string_view bytes);
void take_obj(std::string_view bytes);
void take_cad_stream(std::string_view bytes);
void take_values(std::string_view bytes);
void take_table(std::string_view bytes);

// Checks that the error's message is one line and not empty.
void must_be_one_line(const Error& error);

}  // namespace spoonbill
