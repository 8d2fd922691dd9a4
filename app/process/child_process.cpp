#include "app/process/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

namespace spoonbill {
namespace {

void give(posix_spawn_file_actions_t& actions, int from, int as, int mode) {
  if (from >= 0) {
    posix_spawn_file_actions_adddup2(&actions, from, as);
  } else {
    posix_spawn_file_actions_addopen(&actions, as, "/dev/null", mode, 0);
  }
}

}  // namespace

pid_t start_process(const std::vector<std::string>& arguments, int input, int output) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  give(actions, input, STDIN_FILENO, O_RDONLY);
  give(actions, output, STDOUT_FILENO, O_WRONLY);
  give(actions, -1, STDERR_FILENO, O_WRONLY);
  pid_t process = -1;
  const int error = posix_spawnp(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? process : -1;
}

int wait_for_process(pid_t process) {
  int state = 0;
  while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
  }
  return state;
}

}  // namespace spoonbill
