// main() of the test programs. If SPOONBILL_CASE_REPORT names a file, each case appends a line to it when it
// starts and another line when it has ended. If the process dies during a case, the file therefore shows the
// name of that case. tests/run_suite reads the file.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace {

double processor_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Returns the processor time of this process and of its children that have ended, in seconds.
double processor_seconds() {
  return processor_seconds(RUSAGE_SELF) + processor_seconds(RUSAGE_CHILDREN);
}

class CaseReport final : public testing::EmptyTestEventListener {
 public:
  explicit CaseReport(const char* path)
      : file_(open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644)), owner_(getpid()) {}

  void OnTestStart(const testing::TestInfo& test) override {
    before_s_ = processor_seconds();
    write_line("started", 0.0, test);
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const char* verdict = test.result()->Failed()    ? "failed"
                          : test.result()->Skipped() ? "skipped"
                                                     : "passed";
    write_line(verdict, processor_seconds() - before_s_, test);
  }

 private:
  // Writes the line in one call, without a buffer: a crash could lose a buffered line, and a forked child
  // could write it a second time.
  void write_line(const char* verdict, double seconds, const testing::TestInfo& test) const {
    if (file_ < 0 || getpid() != owner_) return;
    const std::string line = std::string(verdict) + " " + std::to_string(seconds) + " " +
                             test.test_suite_name() + "." + test.name() + "\n";
    [[maybe_unused]] const ssize_t written = write(file_, line.data(), line.size());
  }

  int file_;
  pid_t owner_;
  double before_s_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (const char* path = std::getenv("SPOONBILL_CASE_REPORT")) {
    testing::UnitTest::GetInstance()->listeners().Append(new CaseReport(path));  // GoogleTest deletes it
  }
  return RUN_ALL_TESTS();
}
