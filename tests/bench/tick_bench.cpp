// tick_bench ROUNDS CASE...: plays presses and trials, and prints as JSON how long each whole tick with
// contact took, as the median of the rounds. A case is the file of a recording, stiff:FILE,
// block:COUNT:SUBSTEPS, swap:FILE, or trial:DOCUMENT, whose ticks count from when the bodies have settled. Of
// swap:FILE count the ticks before which a refinement of knots is adopted, with the adoption. Every tick is
// timed with the steady clock and with the thread's own clock, which stops while another program has the
// processor.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/processor.h"
#include "engine/exchange/document.h"
#include "engine/exchange/json.h"
#include "engine/simulation/refiner.h"
#include "engine/trial/trial.h"
#include "haptic/tick.h"
#include "tests/bench/presses.h"

namespace spoonbill {
namespace {

double thread_time_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double steady_time_us() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct Times {
  std::vector<double> wall_us, thread_us;  // times of the ticks with contact
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// Times the calls of `advance`, which returns whether the tick counts.
template <class Advance>
void time_tick(Times& times, const Advance& advance) {
  const double wall = steady_time_us(), thread = thread_time_us();
  const bool counts = advance();
  const double thread_after = thread_time_us(), wall_after = steady_time_us();
  if (!counts) return;
  times.wall_us.push_back(wall_after - wall);
  times.thread_us.push_back(thread_after - thread);
}

bool play(const Press& press, Times& times) {
  auto made = Simulation::make(press.scene, best_instruction_set());
  if (!made) {
    std::cerr << made.error().message << '\n';
    return false;
  }
  Simulation simulation = std::move(made).value();
  CouplingState coupling;
  std::size_t next = 0;
  for (std::uint64_t t = 0; t < press.readings.size(); ++t) {
    for (; next < press.commands.size() && press.commands[next].tick <= t; ++next) {
      if (const auto command = command_from_json(press.commands[next].command, "recording")) {
        (void)simulation.apply(command.value());
      }
    }
    time_tick(times, [&] { return tick(simulation, coupling, press.device, press.readings[t]).touching; });
  }
  return true;
}

// A recording with refinements of knots, as a live session adopts them.
struct Swaps {
  Press press;
};

bool play(const Swaps& swaps, Times& times) {
  const Press& press = swaps.press;
  auto made = Simulation::make(press.scene, best_instruction_set());
  if (!made) {
    std::cerr << made.error().message << '\n';
    return false;
  }
  Simulation simulation = std::move(made).value();
  Refiner refiner(simulation);
  CouplingState coupling;
  std::size_t next = 0;
  for (std::uint64_t t = 0; t < press.readings.size(); ++t) {
    bool is_prepared = false;
    for (; next < press.commands.size() && press.commands[next].tick <= t; ++next) {
      const auto command = command_from_json(press.commands[next].command, "recording");
      if (!command) continue;
      if (const auto* const refine = std::get_if<RefineKnots>(&command.value())) {
        is_prepared = refiner.prepare(*refine).ok();
      } else {
        (void)simulation.apply(command.value());
      }
    }
    time_tick(times, [&] {
      if (is_prepared) simulation.adopt(refiner);
      (void)tick(simulation, coupling, press.device, press.readings[t]);
      return is_prepared;
    });
  }
  return true;
}

// Plays a trial that tilts by 10 degrees and goes on for two seconds.
bool play(const Scene& scene, Times& times) {
  auto made = Simulation::make(scene, best_instruction_set());
  if (!made) {
    std::cerr << made.error().message << '\n';
    return false;
  }
  Simulation simulation = std::move(made).value();
  Trial trial(simulation.scene(), {.seconds = 2.0});
  while (trial.phase() != TrialPhase::done) {
    while (const auto command = trial.next_command()) (void)simulation.apply(*command);
    const bool counts = trial.phase() == TrialPhase::turning || trial.phase() == TrialPhase::watching;
    Reaction reaction;
    time_tick(times, [&] {
      reaction = simulation.advance(trial_input());
      return counts;
    });
    if (const Status held = trial.follow(simulation, reaction.flags); !held) {
      std::cerr << held.error().message << '\n';
      return false;
    }
  }
  return true;
}

using Case = std::variant<Press, Swaps, Scene>;

Result<Case> trial_case(const std::string& file) {
  auto document = read_document(file);
  if (!document) return document.error();
  auto scene = make_trial_scene(std::move(document->scene), 10.0);
  if (!scene) return scene.error();
  return Case(std::move(scene).value());
}

Result<Press> press_of(const std::string& name) {
  int count = 0, substeps = 0;
  if (std::sscanf(name.c_str(), "block:%d:%d", &count, &substeps) == 2) {
    return block_press(count, substeps);
  }
  constexpr std::string_view stiff = "stiff:";
  if (name.starts_with(stiff)) return stiff_press(name.substr(stiff.size()));
  return recorded_press(name);
}

Result<Case> case_of(const std::string& name) {
  constexpr std::string_view trial = "trial:";
  if (name.starts_with(trial)) return trial_case(name.substr(trial.size()));
  constexpr std::string_view swap = "swap:";
  if (name.starts_with(swap)) {
    auto press = recorded_press(name.substr(swap.size()));
    if (!press) return press.error();
    return Case(Swaps{std::move(press).value()});
  }
  auto press = press_of(name);
  if (!press) return press.error();
  return Case(std::move(press).value());
}

// Returns the median time of each tick over the rounds. A tick does the same work in every round, bit for
// bit, so the median is its cost without disturbances by the machine.
std::vector<double> medians_of_ticks(const std::vector<std::vector<double>>& rounds) {
  std::vector<double> medians;
  medians.reserve(rounds[0].size());
  for (std::size_t t = 0; t < rounds[0].size(); ++t) {
    std::vector<double> same;
    same.reserve(rounds.size());
    for (const std::vector<double>& round : rounds) same.push_back(round[t]);
    medians.push_back(quantile(same, 0.5));
  }
  return medians;
}

double median_p99(const std::vector<std::vector<double>>& rounds) {
  std::vector<double> each;
  each.reserve(rounds.size());
  for (const std::vector<double>& round : rounds) each.push_back(quantile(round, 0.99));
  return quantile(each, 0.5);
}

Json report(const Case& played, int rounds) {
  std::vector<std::vector<double>> wall, thread;
  for (int round = 0; round < rounds; ++round) {
    Times times;
    const bool done = std::visit([&](const auto& each) { return play(each, times); }, played);
    if (!done || times.wall_us.empty()) return {};
    wall.push_back(std::move(times.wall_us));
    thread.push_back(std::move(times.thread_us));
  }
  const std::vector<double> wall_us = medians_of_ticks(wall), thread_us = medians_of_ticks(thread);
  return {{"ticks", wall_us.size()},
          {"median_us", quantile(wall_us, 0.5)},
          {"p99_us", quantile(wall_us, 0.99)},
          {"thread_median_us", quantile(thread_us, 0.5)},
          {"thread_p99_us", quantile(thread_us, 0.99)},
          {"thread_most_us", quantile(thread_us, 1.0)},
          {"one_round_thread_p99_us", median_p99(thread)}};
}

int run(int rounds, std::span<char*> cases) {
  Json all = Json::object();
  for (const std::string name : cases) {
    const auto played = case_of(name);
    if (!played) {
      std::cerr << played.error().message << '\n';
      return 1;
    }
    all[name] = report(played.value(), rounds);
    if (all[name].is_null()) {
      std::cerr << name << ": no tick counted\n";
      return 1;
    }
  }
  std::cout << all.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace spoonbill

int main(int count, char** arguments) {
  const std::span<char*> all(arguments, static_cast<std::size_t>(count));
  if (count < 3) {
    std::cerr << "usage: tick_bench ROUNDS CASE...\n";
    return 2;
  }
  const spoonbill::DenormalsFlushed flushed;
  return spoonbill::run(std::max(1, std::atoi(arguments[1])), all.subspan(2));
}
