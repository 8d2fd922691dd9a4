// The faces that a CAD file has and OpenCASCADE could not make: it leaves them out and calls the transfer
// done.
#pragma once

#include <XSControl_WorkSession.hxx>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct FaceCount {
  int all = 0;   // that the file defines
  int lost = 0;  // that became no shape
};

// After the transfer.
FaceCount count_faces(const opencascade::handle<XSControl_WorkSession>& session, CadFormat format);

}  // namespace spoonbill
