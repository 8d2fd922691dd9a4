// The bodies that a CAD file is to hold: surfaces by themselves, and solids joined of their faces.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/cad/cad_writer.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct WrittenBody {
  std::string name;  // that no other has
  TopoDS_Shape shape;
  bool solid = false;
  const CadSurface* surface = nullptr;  // of the model; null where several are joined
};

// Solids stand where the first of their faces does. `content` is told how many there are of each kind, and
// what is no solid that one expects to be one.
Result<std::vector<WrittenBody>> written_bodies(const CadModel& model, const Progress& progress,
                                                CadFileContent& content);

}  // namespace spoonbill
