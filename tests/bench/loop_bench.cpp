// loop_bench SECONDS loop|none idle|drawing: runs the 1 kHz loop and prints as JSON how late its ticks began.
// Each tick simulates a block that a tool presses. With "drawing", another thread draws meanwhile. With
// "none", there is no loop: the program draws while another program measures lateness.
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>
#include <thread>

#include "engine/exchange/json.h"
#include "haptic/haptic_loop.h"
#include "haptic/tick.h"
#include "tests/bench/drawing_load.h"
#include "tests/bench/presses.h"

namespace spoonbill {
namespace {

constexpr int block_count = 12, block_substeps = 6;

// Repeats the press endlessly.
struct Hand {
  Press press = block_press(block_count, block_substeps);
  Simulation simulation = Simulation::make(press.scene, best_instruction_set()).value();
  CouplingState coupling;
  std::size_t next = 0;

  void tick_once() {
    tick(simulation, coupling, press.device, press.readings[next]);
    next = (next + 1) % press.readings.size();
  }
};

// Returns snapshots of the body at four moments of the press.
std::vector<Snapshot> moments_of_press() {
  Hand hand;
  std::vector<Snapshot> moments(4);
  for (Snapshot& moment : moments) {
    for (int t = 0; t < 250; ++t) hand.tick_once();
    hand.simulation.write_snapshot(moment);
  }
  return moments;
}

Json figures_of(const LoopFigures& figures) {
  return {{"ticks", figures.ticks},
          {"late", figures.late},
          {"missed", figures.missed},
          {"p50_us", 1e6 * figures.lateness_p50_s},
          {"p99_us", 1e6 * figures.lateness_p99_s},
          {"p999_us", 1e6 * figures.lateness_p999_s},
          {"work_p99_us", 1e6 * figures.work_p99_s},
          {"fifo", figures.fifo},
          {"notice", figures.notice}};
}

int run(double seconds, bool with_loop, bool drawing) {
  using clock = std::chrono::steady_clock;
  std::optional<DrawingLoad> load;
  if (drawing) load.emplace(moments_of_press());
  // Gives shaders time to compile and buffers time to grow.
  if (drawing) std::this_thread::sleep_for(std::chrono::seconds(1));
  Hand hand;
  Json report = Json::object();
  const int frames = load ? load->frames() : 0;
  const auto end =
      clock::now() + std::chrono::duration_cast<clock::duration>(std::chrono::duration<double>(seconds));
  if (with_loop) {
    auto loop = HapticLoop::start({}, [&hand](const LoopTick&) { hand.tick_once(); });
    if (!loop) {
      std::cerr << loop.error().message << '\n';
      return 1;
    }
    std::this_thread::sleep_until(end);
    loop->stop();
    report = figures_of(loop->figures());
  } else {
    std::this_thread::sleep_until(end);
  }
  if (load && !load->error().empty()) {
    std::cerr << load->error() << '\n';
    return 1;
  }
  report["frames_per_second"] = load ? (load->frames() - frames) / seconds : 0.0;
  std::cout << report.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace spoonbill

int main(int count, char** arguments) {
  const std::string loop = count == 4 ? arguments[2] : "", load = count == 4 ? arguments[3] : "";
  if ((loop != "loop" && loop != "none") || (load != "idle" && load != "drawing")) {
    std::cerr << "usage: loop_bench SECONDS loop|none idle|drawing\n";
    return 2;
  }
  return spoonbill::run(std::atof(arguments[1]), loop == "loop", load == "drawing");
}
