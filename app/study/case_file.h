// The file of the cases that a study has done, from which a stopped study goes on.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "app/study/next_cases.h"
#include "engine/base/file.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Returns the folder of the parts of a study (study_parts.h).
std::filesystem::path parts_folder(const std::filesystem::path& folder);

// Returns the text of a file of cases: a line that identifies the plan, then a line for each case in the
// order of the keys.
std::string cases_text(const Json& plan, const CaseResults& results);
// Reads a file of cases. A last line without an end was torn by a crash and is left out. Fails if the file
// has the cases of another plan.
Result<CaseResults> read_cases(const std::filesystem::path& file, const Json& plan);
// Reads what runs of a plan have left in a folder: the cases of a run that has ended, and of those that were
// stopped.
Result<CaseResults> read_done_cases(const std::filesystem::path& folder, const Json& plan);

// cases.jsonl: a line that identifies the plan, then a line for each case. It grows as cases.jsonl.part, and
// a process that is killed leaves all whole lines there. Used by one thread.
class CaseFile {
 public:
  // Opens the file in a folder and reads what earlier runs of the same plan have left there. Fails if the
  // folder holds the cases of another plan, and with ErrorCode::in_use if another process is writing them. If
  // `restarts`, removes what earlier runs have left instead, whatever their plan.
  static Result<CaseFile> open(const std::filesystem::path& folder, const Json& plan, bool restarts);

  const CaseResults& results() const { return results_; }
  // Adds a case. It survives a crash of the program, and one of the machine after flush().
  Status add(const StudyCase& study_case, const CaseResult& result);
  Status flush() { return out_->flush(); }
  // Writes all cases in the order of their keys, so that the bytes do not depend on the order of the work.
  Status finish();

 private:
  CaseFile(std::filesystem::path file, Json plan, OutputFile out)
      : file_(std::move(file)), plan_(std::move(plan)), out_(std::move(out)) {}

  std::filesystem::path file_;
  Json plan_;
  std::optional<OutputFile> out_;
  CaseResults results_;
};

}  // namespace spoonbill
