#include "app/files/foreign_child.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace spoonbill {
namespace {

double parse_thousandths(const std::string& thousandths) {
  int number = 0;
  std::from_chars(thousandths.data(), thousandths.data() + thousandths.size(), number);
  return std::clamp(number, 0, 1000) / 1000.0;
}

std::string time_limit_text(std::chrono::milliseconds time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

std::string ForeignTask::printable(const std::string& reason) {
  std::string line = reason;
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  return line;
}

Result<ForeignChild> ForeignChild::start(ForeignTask task, const std::vector<std::string>& arguments,
                                         std::chrono::milliseconds patience, int input) {
  auto output = ChildOutput::start(arguments, patience, input);
  if (!output) return output.error().in(task.file.string());
  return ForeignChild(std::move(task), std::move(output).value(), patience);
}

ForeignChild::ForeignChild(ForeignTask task, ChildOutput output, std::chrono::milliseconds patience)
    : task_(std::move(task)), output_(std::move(output)), patience_(patience) {}

void ForeignChild::watch(Progress progress) {
  progress_ = std::move(progress);
}

Result<FrameHead> ForeignChild::next() {
  for (;;) {
    FrameHead head;
    if (Status got = read(&head, sizeof head); !got) return got.error();
    if (!is_known(head.kind)) return invalid_answer();
    if (head.kind == FrameKind::failure) return failure(head);
    if (head.kind != FrameKind::progress) return head;
    const auto thousandths = content(head);
    if (!thousandths) return thousandths.error();
    fraction_ = parse_thousandths(thousandths.value());
    if (!progress_.report(fraction_)) return error(ErrorCode::cancelled, "stopped");
  }
}

Result<std::string> ForeignChild::content(const FrameHead& head) {
  if (head.bytes > frame_bytes_limit) return invalid_answer();
  std::string content(head.bytes, '\0');
  if (Status got = read(content.data(), content.size()); !got) return got.error();
  return content;
}

Status ForeignChild::read(void* to, std::size_t bytes) {
  bool stopped = false;
  const auto stops = [&] { return stopped = !progress_.report(fraction_); };
  if (output_.read(to, bytes, progress_.is_watched() ? stops : std::function<bool()>())) return {};
  return stopped ? error(ErrorCode::cancelled, "stopped") : missing_answer();
}

Error ForeignChild::error(ErrorCode code, const std::string& message) const {
  return Error{code, task_.file.string() + ": " + message};
}

Error ForeignChild::missing_answer() {
  const ChildEnd end = output_.wait();
  const bool reads = task_.work == ForeignTask::Work::reading;
  if (end.out_of_time) {
    return error(ErrorCode::process_failed, (reads ? "reading" : "writing") +
                                                (" it took longer than " + time_limit_text(patience_)) +
                                                "; " + task_.remedy);
  }
  if (end.signal != 0) {
    const std::string signal = "(signal " + std::to_string(end.signal) + "); ";
    return error(ErrorCode::process_failed,
                 reads ? "the reader crashed on it " + signal + "the file is damaged; export it again"
                       : "the writer crashed " + signal + task_.remedy);
  }
  return error(ErrorCode::process_failed,
               (reads ? "the reader" : "the writer") + (" ended without a " + task_.thing) + " (exit code " +
                   std::to_string(end.exit_code) + "); " + (reads ? "export it again" : task_.remedy));
}

Error ForeignChild::failure(const FrameHead& head) {
  const auto reason = content({head.kind, std::min<std::uint64_t>(head.bytes, failure_bytes_limit)});
  if (!reason) return reason.error();
  if (reason->find("bad alloc") != std::string::npos || reason->find("bad_alloc") != std::string::npos) {
    return error(ErrorCode::too_many,
                 task_.too_much + std::to_string(ChildOutput::memory_limit >> 30) + " GiB; " + task_.remedy);
  }
  // `unavailable` means that confine_reader() failed in the child. All other reasons are about the file.
  const Error sent = parse_failure(reason.value());
  if (sent.code == ErrorCode::unavailable) return error(sent.code, ForeignTask::printable(sent.message));
  return error(ErrorCode::malformed, task_.refusal(sent.message));
}

}  // namespace spoonbill
