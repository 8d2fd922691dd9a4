// What a CAD file has and OpenCASCADE could not make: it leaves that out and calls the transfer done.
#pragma once

#include <XSControl_WorkSession.hxx>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct LossCount {
  int faces = 0, lost_faces = 0;          // that the file defines, and of them those that became no shape
  int instances = 0, lost_instances = 0;  // of parts that an IGES file defines once
  int unread = 0;                         // IGES entities that could not be parsed, those without a type too
};

// After the transfer.
LossCount count_losses(const opencascade::handle<XSControl_WorkSession>& session, FileFormat format);

}  // namespace spoonbill
