// The faces of a CAD model, each where its assembly places it and with the name that says most about it.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

namespace spoonbill {

struct NamedFace {
  TopoDS_Face face;
  std::string name;   // its own, its body's or its product's; a number follows where several share it
  std::string solid;  // that it is one of several faces of, by a name that no other has; or empty
};

struct NamedFaces {
  std::vector<NamedFace> faces;
  int solids = 0;           // of more than one face
  int faces_of_solids = 0;  // of these
};

NamedFaces named_faces(const opencascade::handle<TDocStd_Document>& document);

}  // namespace spoonbill
