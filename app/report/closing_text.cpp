#include "app/report/closing_text.h"

#include "engine/base/text.h"

namespace spoonbill {

const char* name_of(Closedness closedness) {
  switch (closedness) {
    case Closedness::solid:
      return "solid";
    case Closedness::tube:
      return "tube";
    case Closedness::sheet:
      return "sheet";
  }
  return "";
}

std::string closing_text(const Closing& closing) {
  switch (closing.closedness) {
    case Closedness::solid:
      return "closed";
    case Closedness::tube:
      return "a tube, open by " + short_length_text(closing.gap_m) + " at an end";
    case Closedness::sheet:
      return "open both ways";
  }
  return "";
}

}  // namespace spoonbill
