#include "engine/exchange/cad/session.h"

#include <IGESControl_Controller.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPControl_Controller.hxx>

namespace spoonbill {

void prepare_occt() {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();
  STEPCAFControl_Controller::Init();
  IGESControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
  Interface_Static::SetIVal("read.iges.bspline.continuity", 0);
}

void choose_schema(StepSchema schema) {
  Interface_Static::SetCVal("write.step.schema", schema == StepSchema::ap242 ? "AP242DIS" : "AP214IS");
}

void choose_unit(std::string_view unit) {
  const char* name = unit == "cm" ? "CM" : unit == "m" ? "M" : unit == "in" ? "INCH" : "MM";
  Interface_Static::SetCVal("write.step.unit", name);
  Interface_Static::SetCVal("write.iges.unit", name);
}

}  // namespace spoonbill
