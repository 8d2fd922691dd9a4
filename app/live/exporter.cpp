#include "app/live/exporter.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "app/convert/conversion.h"
#include "app/files/state_folder.h"

namespace spoonbill {
namespace {

constexpr const char* endings[] = {".step", ".stp", ".iges", ".igs", ".stl", ".obj", ".ply", ".3mf"};

// The document as a file of its own for as long as it is exported.
class Copy {
 public:
  static Result<std::filesystem::path> place() {
    auto folder = state_folder();
    if (!folder) return folder;
    return folder.value() / ("export-" + std::to_string(getpid()) + ".json");
  }
  explicit Copy(std::filesystem::path file) : file_(std::move(file)) {}
  ~Copy() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
    std::filesystem::remove(file_.string() + ".bak", ignored);
  }
  Copy(const Copy&) = delete;
  Copy& operator=(const Copy&) = delete;

 private:
  std::filesystem::path file_;
};

}  // namespace

Exporter::~Exporter() {
  stopping_.store(true);
  if (thread_.joinable()) thread_.join();
}

bool Exporter::writes(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return std::find(std::begin(endings), std::end(endings), ending) != std::end(endings);
}

const char* Exporter::endings_text() {
  return ".step, .iges, .stl, .obj, .ply or .3mf";
}

void Exporter::begin(Document document, std::filesystem::path file) {
  if (busy_.exchange(true)) {
    return notices_->add(Notice::Kind::problem, "not exported: another export is under way");
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this, document = std::move(document), file = std::move(file)] {
    run(document, file);
    busy_.store(false);
  });
}

void Exporter::run(const Document& document, const std::filesystem::path& file) {
  const auto refuse = [&](const Error& error) {
    notices_->add(Notice::Kind::problem, "not exported: " + error.message);
  };
  const auto place = Copy::place();
  if (!place) return refuse(place.error());
  const Copy copy(place.value());
  if (Status written = write_document(document, place.value()); !written) return refuse(written.error());
  ConversionRequest request;
  request.in = place.value();
  request.out = file;
  const auto report = convert_file(request, {[](double) {}, [this] { return stopping_.load(); }});
  if (!report) return refuse(report.error());
  notices_->add(Notice::Kind::information,
                "exported " + file.filename().string() + ", in " + report->unit_out);
  for (const std::string& note : report->notes) notices_->add(Notice::Kind::information, note);
}

}  // namespace spoonbill
