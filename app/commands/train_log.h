// The parts of `train` that use the log of a person.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "app/console.h"
#include "app/session/training_session.h"
#include "app/training/person_log.h"
#include "engine/base/result.h"

namespace spoonbill {

// Returns the log of a person in the state folder.
Result<PersonLog> find_person_log(const std::string& person);

// Logs an attempt that ends now.
Status log_attempt(const PersonLog& log, const TrainingSetting& setting, const TaskResult& result,
                   std::uint64_t state_hash);

// Returns the strength of the guidance with which the person should try the task next.
Result<double> choose_guidance(const PersonLog& log, const std::filesystem::path& task);

// Prints the attempts of a person, and writes their page if `page` is not empty.
Status show_progress(const std::string& person, const std::filesystem::path& page, const OutputOptions& how,
                     bool as_json, Console& console);

// Deletes the log of a person.
Status forget_person(const std::string& person, bool as_json, Console& console);

}  // namespace spoonbill
