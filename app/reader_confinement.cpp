#include "app/reader_confinement.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

namespace spoonbill {

#ifdef SPOONBILL_SANITIZED

Status confine_reader() {
  return {};
}

#else

namespace {

Error no_filter(const std::string& reason) {
  return {ErrorCode::unavailable,
          "is refused, because this system cannot confine the process that handles foreign files (" + reason +
              "); use a kernel with seccomp filters"};
}

}  // namespace

#if defined(__x86_64__) || defined(__aarch64__)

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t processor = AUDIT_ARCH_X86_64;
#else
constexpr std::uint32_t processor = AUDIT_ARCH_AARCH64;
#endif

// System calls from this number on are those of the x32 interface, which denied_calls does not cover.
constexpr std::uint32_t first_foreign_call = 0x40000000;

constexpr std::uint32_t denied = SECCOMP_RET_ERRNO | EPERM;

// io_uring_setup is denied because io_uring can open sockets without the call `socket`. clone3 is handled
// separately.
constexpr std::uint32_t denied_calls[] = {
#if defined(__x86_64__)
    __NR_fork,
    __NR_vfork,
#endif
    __NR_socket,
    __NR_socketpair,
    __NR_execve,
    __NR_execveat,
    __NR_ptrace,
    __NR_process_vm_readv,
    __NR_process_vm_writev,
    __NR_io_uring_setup};

sock_filter load(std::size_t offset) {
  return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}

sock_filter answer(std::uint32_t action) {
  return BPF_STMT(BPF_RET | BPF_K, action);
}

// Skips the next instruction if the comparison is false.
sock_filter next_if(std::uint16_t comparison, std::uint32_t value) {
  return BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | BPF_K | comparison), value, 0, 1);
}

std::vector<sock_filter> reader_filter() {
  std::vector<sock_filter> filter = {load(offsetof(seccomp_data, arch)),
                                     BPF_JUMP(BPF_JMP | BPF_K | BPF_JEQ, processor, 1, 0), answer(denied),
                                     load(offsetof(seccomp_data, nr))};
  const auto deny = [&](std::uint16_t comparison, std::uint32_t value, std::uint32_t action) {
    filter.push_back(next_if(comparison, value));
    filter.push_back(answer(action));
  };
  deny(BPF_JGE, first_foreign_call, denied);
  for (const std::uint32_t call : denied_calls) deny(BPF_JEQ, call, denied);
  deny(BPF_JEQ, __NR_clone3, SECCOMP_RET_ERRNO | ENOSYS);
  deny(BPF_JEQ, __NR_clone, SECCOMP_RET_ALLOW);
  // `clone` is allowed only for threads. Both processor families pass its flags in the low half of the first
  // argument.
  filter.back() = BPF_JUMP(BPF_JMP | BPF_JA, 1, 0, 0);
  filter.push_back(answer(SECCOMP_RET_ALLOW));
  filter.push_back(load(offsetof(seccomp_data, args)));
  deny(BPF_JSET, CLONE_THREAD, SECCOMP_RET_ALLOW);
  filter.push_back(answer(denied));
  return filter;
}

}  // namespace

Status confine_reader() {
  std::vector<sock_filter> filter = reader_filter();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return no_filter(std::generic_category().message(errno));
  const long failed = syscall(__NR_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program);
  if (failed > 0) return no_filter("thread " + std::to_string(failed) + " has a filter of its own");
  if (failed != 0) return no_filter(std::generic_category().message(errno));
  return {};
}

#else

Status confine_reader() {
  return no_filter("its processor is not known to the filter");
}

#endif
#endif

}  // namespace spoonbill
