#include "app/frames/frame_events.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "app/report/quantity_text.h"
#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Returns the names of commands as plain words, each once: "place plane, undo".
std::string list_commands(const std::vector<std::string>& commands) {
  std::string list;
  for (auto command = commands.begin(); command != commands.end(); ++command) {
    if (std::find(commands.begin(), command, *command) != command) continue;
    list += (list.empty() ? "" : ", ") + *command;
  }
  std::replace(list.begin(), list.end(), '_', ' ');
  return list;
}

// Adds the index that halves the longest gap between those chosen. Returns false if there is no gap.
bool halve_longest_gap(std::set<std::size_t>& chosen) {
  std::size_t longest = 1, start = 0;
  for (auto at = chosen.begin(); std::next(at) != chosen.end(); ++at) {
    const std::size_t gap = *std::next(at) - *at;
    if (gap <= longest) continue;
    longest = gap;
    start = *at;
  }
  if (longest < 2) return false;
  chosen.insert(start + longest / 2);
  return true;
}

}  // namespace

void FrameEvents::add(std::uint64_t frame, double time_s, double force_n,
                      const std::vector<std::string>& commands) {
  SPOONBILL_ASSERT(seen_.empty() || frame > seen_.back().frame);
  const bool touched = !seen_.empty() && seen_.back().force_n > 0.0;
  Seen seen{frame, time_s, force_n, Kind::none, {}};
  if (!commands.empty()) {
    seen.kind = Kind::command;
    seen.text = list_commands(commands);
  }
  if ((force_n > 0.0) != touched) {
    seen.kind = touched ? Kind::release : Kind::touch;
    seen.text += (seen.text.empty() ? "" : ", ") + std::string(touched ? "release" : "touch");
  }
  seen_.push_back(std::move(seen));
}

std::vector<FrameEvents::Seen> FrameEvents::classified() const {
  std::vector<Seen> all = seen_;
  const auto largest = std::max_element(
      all.begin(), all.end(), [](const Seen& one, const Seen& other) { return one.force_n < other.force_n; });
  if (largest->force_n > 0.0) {
    largest->kind = Kind::largest_force;
    largest->text +=
        (largest->text.empty() ? "" : ", ") + ("largest force, " + decimals_text(largest->force_n, 2) + " N");
  }
  all.front().kind = all.back().kind = Kind::end;
  return all;
}

std::vector<SheetFrame> FrameEvents::choose(std::size_t count) const {
  SPOONBILL_ASSERT(count >= 2);
  if (seen_.empty()) return {};
  const std::vector<Seen> all = classified();
  std::set<std::size_t> chosen;
  for (const Kind kind : {Kind::end, Kind::largest_force, Kind::touch, Kind::release, Kind::command}) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].kind == kind) found.push_back(i);
    }
    const std::size_t room = std::min(count - chosen.size(), found.size());
    for (std::size_t k = 0; k < room; ++k) chosen.insert(found[k * found.size() / room]);
  }
  while (chosen.size() < count && halve_longest_gap(chosen)) {
  }
  std::vector<SheetFrame> frames;
  for (const std::size_t i : chosen) {
    std::string caption = decimals_text(all[i].time_s, 2) + " s";
    if (!all[i].text.empty()) caption += "  " + all[i].text;
    frames.push_back({all[i].frame, std::move(caption)});
  }
  return frames;
}

}  // namespace spoonbill
