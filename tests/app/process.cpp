#include "tests/app/process.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>

namespace spoonbill {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char letter : text) result += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return result + "'";
}

}  // namespace

Outcome run_process(const std::string& program, const std::vector<std::string>& arguments,
                    const std::string& settings) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "out";
  const auto err = folder.path() / "err";
  std::string line = settings + " " + quoted(program);
  for (const std::string& argument : arguments) line += " " + quoted(argument);
  line += " >" + quoted(out.string()) + " 2>" + quoted(err.string());
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(out), content_of(err)};
}

void run_and_kill(const std::string& program, const std::vector<std::string>& arguments,
                  const std::filesystem::path& file, std::uintmax_t bytes) {
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), program);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t process = -1;
  if (posix_spawn(&process, program.c_str(), nullptr, nullptr, pointers.data(), environ) != 0) return;
  std::error_code ignored;
  while (waitpid(process, nullptr, WNOHANG) == 0) {
    const auto size = std::filesystem::file_size(file, ignored);
    if (!ignored && size > bytes) {
      kill(process, SIGKILL);
      waitpid(process, nullptr, 0);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace spoonbill
