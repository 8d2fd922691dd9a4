#include "app/live/autosave.h"

#include <system_error>

#include "app/report/quantity_text.h"
#include "engine/base/file.h"
#include "engine/exchange/field_reader.h"
#include "engine/simulation/simulation.h"
#include "haptic/recording_lines.h"

namespace spoonbill {
namespace {

// Largest size of an autosave: that of the largest document, and room for the autosave's own fields.
constexpr std::size_t bytes_limit = std::size_t{65} << 20;
constexpr int autosave_version = 1;
constexpr int windows_limit = 99;  // largest number of windows that can autosave the same document

// Returns the name of an autosave file. The hash of the path distinguishes documents of the same name in
// different folders.
std::string file_name_for(const std::filesystem::path& of, int number) {
  const std::string ending = (number > 1 ? "-" + std::to_string(number) : "") + ".autosave.json";
  if (of.empty()) return "untitled" + ending;
  StateHash hash;
  for (const char c : of.string()) hash.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return of.stem().string() + "-" + hash_text(hash.value()) + ending;
}

std::filesystem::path canonical_path(const std::filesystem::path& path) {
  std::error_code problem;
  const std::filesystem::path canonical = std::filesystem::weakly_canonical(path, problem);
  return problem ? path : canonical;
}

// Returns the first free file name of the form `file` + `before` + "-N" + `after`, such as
// a.autosave.json.kept-1.json. The lock of the AutosaveClaim prevents other windows from choosing the same
// name.
std::filesystem::path find_free_name(const std::filesystem::path& file, const std::string& before,
                                     const std::string& after) {
  for (int number = 1;; ++number) {
    std::filesystem::path name = file.string() + before + "-" + std::to_string(number) + after;
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, ignored))) return name;
  }
}

// Returns true if the file contains the same document, whatever its view. Modification times are not
// compared, because a copy, a checkout or a synchronisation makes a file newer without any work by the user.
bool holds_same(const std::filesystem::path& file, Document recovered) {
  auto saved = read_document(file);
  if (!saved) return false;
  saved->view = recovered.view = Json::object();
  return document_to_json(saved.value()) == document_to_json(recovered);
}

}  // namespace

Autosave::Autosave(const std::filesystem::path& folder, const std::filesystem::path& of, int number)
    : of_(of.empty() ? of : canonical_path(of)), file_(folder / file_name_for(of_, number)) {}

Status Autosave::write(const Document& document) const {
  Json json{{"spoonbill_autosave", autosave_version}, {"of", of_.string()}};
  json["document"] = document_to_json(document);
  return replace_file(file_, json_to_page(json));
}

Result<Document> Autosave::read() const {
  const auto text = read_file(file_, bytes_limit);
  if (!text) return text.error();
  const auto json = parse_json(text.value(), file_.string());
  if (!json) return json.error();
  FieldReader reader(json.value(), file_.string());
  reader.version("spoonbill_autosave", autosave_version);
  reader.ignore("of");
  const Json inner = reader.has("document") ? reader.object("document") : Json::object();
  reader.ignore("document");
  reader.finish();
  if (!reader.status()) return reader.status().error();
  return document_from_json(inner, file_.string() + ": document");
}

Result<std::optional<Document>> Autosave::recovered_document() const {
  std::error_code problem;
  if (!std::filesystem::exists(file_, problem)) return std::optional<Document>();
  auto document = read();
  if (!document) return document.error();
  if (!of_.empty() && holds_same(of_, document.value())) return std::optional<Document>();
  return std::optional<Document>(std::move(document).value());
}

Result<std::filesystem::path> Autosave::set_aside() const {
  if (const auto document = read()) {
    const std::filesystem::path kept = find_free_name(file_, ".kept", ".json");
    if (write_document(document.value(), kept, {NamedBy::program})) {
      remove();
      return kept;
    }
  }
  // A file that cannot be read or copied is renamed, which needs no space on the disk.
  const std::filesystem::path kept = find_free_name(file_, ".unread", "");
  std::error_code problem;
  std::filesystem::rename(file_, kept, problem);
  if (!problem) return kept;
  return Error{ErrorCode::unwritable, file_.string() + ": cannot be renamed: " + problem.message()};
}

void Autosave::remove() const {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  std::filesystem::remove(file_.string() + ".bak", ignored);
}

AutosaveClaim AutosaveClaim::acquire(const std::filesystem::path& folder, const std::filesystem::path& of) {
  std::optional<AutosaveClaim> left, first_free;
  bool is_open_elsewhere = false;
  for (int number = 1; number <= windows_limit; ++number) {
    Autosave autosave(folder, of, number);
    auto lock = FileLock::acquire(autosave.file().string() + ".lock");
    if (!lock) {
      // Untitled documents share a name but are different documents.
      is_open_elsewhere = is_open_elsewhere || (!of.empty() && lock.error().code == ErrorCode::in_use);
      continue;
    }
    std::error_code problem;
    std::optional<AutosaveClaim>& kind =
        std::filesystem::exists(autosave.file(), problem) ? left : first_free;
    if (!kind) kind = AutosaveClaim(std::move(autosave), std::move(lock).value());
  }
  AutosaveClaim claim = left         ? std::move(*left)
                        : first_free ? std::move(*first_free)
                                     : AutosaveClaim(Autosave(folder, of), std::nullopt);
  claim.is_open_elsewhere_ = is_open_elsewhere;
  return claim;
}

}  // namespace spoonbill
