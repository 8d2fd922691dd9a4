#include "app/live/exporter.h"

#include <string>
#include <utility>

#include "app/files/conversion.h"

namespace spoonbill {

Exporter::~Exporter() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

bool Exporter::writes(const std::filesystem::path& file) {
  return is_exported_to(file);
}

const char* Exporter::endings_text() {
  return ".step, .iges, .stl, .obj, .ply or .3mf";
}

void Exporter::begin(std::vector<Body> bodies, std::filesystem::path file) {
  if (busy_.exchange(true)) {
    return notices_->add(Notice::Kind::problem, "not exported: another export is under way");
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this, bodies = std::move(bodies), file = std::move(file)]() mutable {
    run(std::move(bodies), file);
    busy_.store(false);
  });
}

void Exporter::run(std::vector<Body> bodies, const std::filesystem::path& file) {
  const auto report =
      export_bodies(std::move(bodies), file, Progress([this](double) { return !stopping_.load(); }));
  if (!report) return notices_->add(Notice::Kind::problem, "not exported: " + report.error().message);
  notices_->add(Notice::Kind::information,
                "exported " + file.filename().string() + ", in " + report->unit_out);
  for (const std::string& note : report->notes) notices_->add(Notice::Kind::information, note);
}

}  // namespace spoonbill
