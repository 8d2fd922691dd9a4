// CAD models to the text of STEP and IGES files.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

// A share from 0 to 1 of the work that is done.
// Each surface becomes a product of its name in STEP (a MANIFOLD_SOLID_BREP where it closes, an open shell
// where not), a named entity in IGES: 186 where it closes, 128 where not, 144 for each of its faces where it
// is trimmed. The faces of a solid become one again, of its name, where they close. What
// find_closing() calls closed is written so exactly, and a note tells by how much it missed that. Notes tell,
// too, which would close and are no solid, and what gaps between the faces of a solid were bridged.
// prepare_occt() must have been called. The Error says what is wrong, without the file's name.
Result<CadFileContent> write_cad(const CadModel& model, const CadWriting& writing,
                                 const Progress& progress = {});

}  // namespace spoonbill
