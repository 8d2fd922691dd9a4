// Tests that a reader of foreign files is confined and ends with its parent.
#include "app/reader_confinement.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>

#include "app/child_process.h"
#include "app/program.h"
#include "tests/app/process.h"
#include "tests/app/workplace.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

using namespace std::chrono_literals;

#ifdef SPOONBILL_SANITIZED
constexpr bool are_readers_confined = false;
#else
constexpr bool are_readers_confined = true;
#endif

bool holds_within_5_s(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + 5s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

std::string content_of(const std::string& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

bool is_confined(pid_t process) {
  const std::string status = content_of("/proc/" + std::to_string(process) + "/status");
  return status.find("NoNewPrivs:\t1\n") != std::string::npos &&
         status.find("Seccomp:\t2\n") != std::string::npos;
}

// Starts a reader that waits forever, because nothing is written to its input and nobody reads its output.
// Expects its process to be confined.
void expect_confined(const std::vector<std::string>& arguments) {
  int in[2], out[2];
  ASSERT_EQ(pipe2(in, O_CLOEXEC) | pipe2(out, O_CLOEXEC), 0);
  const pid_t reader = start_reader(arguments, in[0], out[1]);
  ASSERT_GT(reader, 0);
  EXPECT_TRUE(holds_within_5_s([&] { return is_confined(reader); }))
      << content_of("/proc/" + std::to_string(reader) + "/status");
  kill(reader, SIGKILL);
  wait_for_process(reader);
  for (const int end : {in[0], in[1], out[0], out[1]}) close(end);
}

TEST(ReaderConfinement, EveryReaderShowsIt) {
  if (!are_readers_confined) GTEST_SKIP() << "sanitizers start processes";
  const TemporaryFolder folder;
  std::string points;
  for (int i = 0; i < 10000; ++i) points += std::to_string(i) + " 1 2\n";
  std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 10000; ++i) {
    const std::string first = std::to_string(3 * i + 1);
    mesh += "v " + std::to_string(i) + " 0 1\nv 1 " + std::to_string(i) + " 1\nv 0 1 2\nf " + first + " " +
            std::to_string(3 * i + 2) + " " + std::to_string(3 * i + 3) + "\n";
  }
  expect_confined({SPOONBILL_CAD_PROGRAM, "write", "step", "ap214", "mm"});
  expect_confined({SPOONBILL_PROGRAM, "read-points", "--", folder.write("a.xyz", points).string()});
  expect_confined({SPOONBILL_PROGRAM, "read-mesh", "--", folder.write("a.obj", mesh).string()});
}

// Confines this process, then makes system calls that must succeed and system calls that must fail. Returns a
// set bit for each unexpected result.
int wrong_results() {
  int wrong = 0, bit = 1;
  const auto expect = [&](bool right) {
    if (!right) wrong |= bit;
    bit *= 2;
  };
  const auto is_denied = [](long result, int error) { return result == -1 && errno == error; };
  expect(confine_reader().ok());
  expect(is_denied(socket(AF_INET, SOCK_STREAM, 0), EPERM));
  const pid_t child = fork();
  if (child == 0) _exit(0);
  expect(is_denied(child, EPERM));
  char* const nothing[] = {nullptr};
  expect(is_denied(execve("/bin/true", nothing, nothing), EPERM));
  expect(is_denied(ptrace(PTRACE_TRACEME, 0, nullptr, nullptr), EPERM));
  expect(is_denied(syscall(__NR_clone3, nullptr, 0), ENOSYS));
  bool ran = false;
  std::thread([&] { ran = true; }).join();
  expect(ran);
  return wrong;
}

TEST(ReaderConfinement, ThreadsStartButNoProcess) {
  if (!are_readers_confined) GTEST_SKIP() << "sanitizers start processes";
  const pid_t process = fork();
  if (process == 0) _exit(wrong_results());
  const int state = wait_for_process(process);
  ASSERT_TRUE(WIFEXITED(state));
  EXPECT_EQ(WEXITSTATUS(state), 0);
}

// Makes seccomp() fail in this thread and its children, as on an old kernel. A reader is confined with this
// system call.
bool forbid_filters() {
  sock_filter calls[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offsetof(seccomp_data, nr))),
      BPF_JUMP(BPF_JMP | BPF_K | BPF_JEQ, __NR_seccomp, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const sock_fprog program{static_cast<unsigned short>(std::size(calls)), calls};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

TEST(ReaderConfinement, NothingIsReadWithoutIt) {
  if (!are_readers_confined) GTEST_SKIP() << "sanitizers start processes";
  const Workplace place;
  place.write("a.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 1\n");
  place.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  place.write("a.step", "ISO-10303-21;\n");
  const std::vector<std::vector<std::string>> commands = {
      {"fit", place.text("a.xyz"), "--out", place.text("out.json")},
      {"fit", place.text("a.obj"), "--out", place.text("out.json")},
      {"convert", place.text("a.step"), place.text("out.json")},
      {"convert", place.text("model.json"), place.text("out.step")}};
  std::vector<Outcome> outcomes;
  std::thread([&] {
    if (!forbid_filters()) return;
    for (const auto& command : commands) outcomes.push_back(run_process(SPOONBILL_PROGRAM, command));
  }).join();
  ASSERT_EQ(outcomes.size(), commands.size());
  for (const Outcome& outcome : outcomes) {
    EXPECT_EQ(outcome.code, exit_failed);
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find("seccomp"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(place.path("out.json")) ||
               std::filesystem::exists(place.path("out.step")));
}

TEST(StartReader, GivesACleanEnvironmentAndNoDescriptors) {
  if (!are_readers_confined) GTEST_SKIP() << "sanitizers read their environment";
  int out[2];
  ASSERT_EQ(pipe2(out, O_CLOEXEC), 0);
  const int secret = dup2(out[0], 77);  // a descriptor without O_CLOEXEC
  setenv("SPOONBILL_SECRET", "1", 1);
  const pid_t reader =
      start_reader({"/bin/sh", "-c", "test -e /proc/self/fd/77 && echo 77; env"}, -1, out[1]);
  ASSERT_GT(reader, 0);
  close(out[1]);
  EXPECT_EQ(wait_for_process(reader), 0);
  char text[4096];
  const ssize_t count = read(out[0], text, sizeof text);
  const std::string said(text, count > 0 ? static_cast<std::size_t>(count) : 0);
  EXPECT_NE(said.find("LC_ALL=C\n"), std::string::npos) << said;
  EXPECT_EQ(said.find("SPOONBILL_SECRET"), std::string::npos) << said;
  EXPECT_EQ(said.find("HOME="), std::string::npos) << said;
  EXPECT_EQ(said.find("77\n"), std::string::npos) << said;
  unsetenv("SPOONBILL_SECRET");
  close(secret);
  close(out[0]);
}

TEST(StartReader, EndsWithAParentThatEndsAtOnce) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // the orphan becomes a child of this process
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    const pid_t reader = start_reader({"/bin/sleep", "20"}, -1, -1);
    _exit(write(ends[1], &reader, sizeof reader) == sizeof reader ? 0 : 1);
  }
  EXPECT_EQ(wait_for_process(parent), 0);
  pid_t reader = -1;
  ASSERT_EQ(read(ends[0], &reader, sizeof reader), static_cast<ssize_t>(sizeof reader));
  int state = 0;
  EXPECT_TRUE(holds_within_5_s([&] { return waitpid(reader, &state, WNOHANG) == reader; }));
  EXPECT_TRUE(WIFSIGNALED(state));
  EXPECT_EQ(WTERMSIG(state), SIGKILL);
  if (!WIFSIGNALED(state)) kill(reader, SIGKILL);
  prctl(PR_SET_CHILD_SUBREAPER, 0);
  close(ends[0]);
  close(ends[1]);
}

TEST(StartReader, SaysThatAProgramIsMissing) {
  EXPECT_EQ(start_reader({"/nowhere/reader"}, -1, -1), -1);
  EXPECT_EQ(start_process({"/nowhere/reader"}, -1, -1), -1);
}

}  // namespace
}  // namespace spoonbill
