// How a study that takes seconds tells how far it is, and is asked to stop.
#pragma once

#include <functional>

namespace spoonbill {

// Called with the share that is done, 0 to 1; false stops the study, whose result then means nothing. May be
// empty.
using StudyWatch = std::function<bool(double share)>;

// For a part of a study that begins and ends at these shares of it. The whole watch must outlive it.
inline StudyWatch part_watch(const StudyWatch& watch, double from, double to) {
  if (!watch) return {};
  return [&watch, from, to](double share) { return watch(from + share * (to - from)); };
}

}  // namespace spoonbill
