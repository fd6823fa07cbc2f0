// SPDX-License-Identifier: Apache-2.0
#include "lab/system_call_filter.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>

namespace quintet::lab {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;
#endif

// Numbers from 424 on are the same for all architectures; the headers of Debian 12 lack the last ones.
constexpr std::uint32_t kDenied[] = {
    // Other processes.
    __NR_ptrace,
    __NR_process_vm_readv,
    __NR_process_vm_writev,
    __NR_kcmp,
    __NR_perf_event_open,
    __NR_migrate_pages,
    __NR_move_pages,
    424 /* pidfd_send_signal */,
    434 /* pidfd_open */,
    438 /* pidfd_getfd */,
    440 /* process_madvise */,
    448 /* process_mrelease */,
    // System V and POSIX IPC.
    __NR_shmget,
    __NR_shmat,
    __NR_msgget,
    __NR_semget,
    __NR_mq_open,
    // Attributes of files, which Landlock does not cover.
    __NR_fchmod,
    __NR_fchmodat,
    __NR_fchown,
    __NR_fchownat,
    __NR_setxattr,
    __NR_lsetxattr,
    __NR_fsetxattr,
    __NR_removexattr,
    __NR_lremovexattr,
    __NR_fremovexattr,
    __NR_utimensat,
    __NR_truncate,
    452 /* fchmodat2 */,
    463 /* setxattrat */,
    466 /* removexattrat */,
    469 /* file_setattr */,
#if defined(__x86_64__)
    __NR_chmod,
    __NR_chown,
    __NR_lchown,
    __NR_utime,
    __NR_utimes,
    __NR_futimesat,
    __NR_modify_ldt,
    __NR_iopl,
    __NR_ioperm,
#endif
    // Mounts, namespaces, and the rest of the system.
    __NR_mount,
    __NR_umount2,
    __NR_pivot_root,
    __NR_chroot,
    __NR_setns,
    __NR_unshare,
    428 /* open_tree */,
    429 /* move_mount */,
    430 /* fsopen */,
    431 /* fsconfig */,
    432 /* fsmount */,
    433 /* fspick */,
    442 /* mount_setattr */,
    467 /* open_tree_attr */,
    __NR_open_by_handle_at,
    __NR_name_to_handle_at,
    __NR_fanotify_init,
    __NR_bpf,
    __NR_userfaultfd,
    __NR_add_key,
    __NR_request_key,
    __NR_keyctl,
    __NR_init_module,
    __NR_finit_module,
    __NR_delete_module,
    __NR_kexec_load,
    __NR_kexec_file_load,
    __NR_reboot,
    __NR_swapon,
    __NR_swapoff,
    __NR_acct,
    __NR_quotactl,
    __NR_syslog,
    __NR_settimeofday,
    __NR_clock_settime,
    __NR_clock_adjtime,
    __NR_adjtimex,
    __NR_sethostname,
    __NR_setdomainname,
    __NR_vhangup,
    __NR_personality,
    __NR_lookup_dcookie,
};

// Their arguments are in memory, which a filter cannot read, or they do the work of other calls. Callers use the older calls.
constexpr std::uint32_t kMissing[] = {
    425 /* io_uring_setup */, 426 /* io_uring_enter */, 427 /* io_uring_register */,
    435 /* clone3 */,         437 /* openat2 */,
};

constexpr std::uint32_t kSocketTypes = 0xf;  // without flags
constexpr std::uint32_t kNamespaces =
    CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET;

class Filter {
 public:
  void load(std::size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }
  void loadNumber() { load(offsetof(seccomp_data, nr)); }
  // The lower half: all arguments that are compared have 32 bits.
  void loadArgument(std::size_t index) { load(offsetof(seccomp_data, args) + index * sizeof(std::uint64_t)); }
  void mask(std::uint32_t bits) { add(BPF_ALU | BPF_AND | BPF_K, bits); }

  void returns(std::uint32_t action) { add(BPF_RET | BPF_K, action); }
  void returnsIfEqual(std::uint32_t value, std::uint32_t action) {
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    returns(action);
  }
  void returnsIfDifferent(std::uint32_t value, std::uint32_t action) {
    add(BPF_JMP | BPF_JEQ | BPF_K, value, 1, 0);
    returns(action);
  }
  void returnsIfAtLeast(std::uint32_t value, std::uint32_t action) {
    add(BPF_JMP | BPF_JGE | BPF_K, value, 0, 1);
    returns(action);
  }
  // Applies `rules` to the calls of this number; the number is loaded before and after it.
  template <class Rules>
  void forCall(std::uint32_t number, const Rules& rules) {
    const std::size_t jump = code_.size();
    add(BPF_JMP | BPF_JEQ | BPF_K, number, 0, 0);
    rules();
    loadNumber();
    code_[jump].jf = static_cast<std::uint8_t>(code_.size() - jump - 1);
  }

  void install() {
    sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    if (::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
      throw SandboxError(fmt::format("cannot limit the system calls of the process: {}", std::strerror(errno)));
  }

 private:
  void add(unsigned code, std::uint32_t value, std::uint8_t yes = 0, std::uint8_t no = 0) {
    code_.push_back({static_cast<std::uint16_t>(code), yes, no, value});
  }
  std::vector<sock_filter> code_;
};

constexpr std::uint32_t kAllow = SECCOMP_RET_ALLOW;
constexpr std::uint32_t denial(int error) { return SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error); }

// Reading a file must not empty it: Landlock before version 3 does not know that O_TRUNC writes.
void forbidTruncation(Filter& filter, std::uint32_t number, std::size_t flags) {
  filter.forCall(number, [&] {
    filter.loadArgument(flags);
    filter.mask(O_TRUNC | O_ACCMODE);
    filter.returnsIfEqual(O_TRUNC | O_RDONLY, denial(EPERM));
  });
}

}  // namespace

bool hasSystemCallFilter() {
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return kArchitecture != 0 && ::syscall(__NR_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

void filterSystemCalls(bool ownSignals) {
  Filter filter;
  filter.load(offsetof(seccomp_data, arch));
  filter.returnsIfDifferent(kArchitecture, SECCOMP_RET_KILL_PROCESS);
  filter.loadNumber();
#if defined(__x86_64__)
  constexpr std::uint32_t kX32 = 0x40000000;  // the same calls with other numbers
  filter.returnsIfAtLeast(kX32, denial(ENOSYS));
#endif
  for (const std::uint32_t number : kDenied) filter.returnsIfEqual(number, denial(EPERM));
  for (const std::uint32_t number : kMissing) filter.returnsIfEqual(number, denial(ENOSYS));
  filter.forCall(__NR_clone, [&] {
    filter.loadArgument(0);
    filter.mask(kNamespaces);
    filter.returnsIfDifferent(0, denial(EPERM));
  });
  // No network, and no Unix sockets that reach other programs of the user. NVIDIA's driver waits at a socket of this type, or creates
  // no device for ray tracing; it cannot send before it is connected.
  filter.forCall(__NR_socket, [&] {
    filter.loadArgument(0);
    filter.returnsIfDifferent(AF_UNIX, denial(EPERM));
    filter.loadArgument(1);
    filter.mask(kSocketTypes);
    filter.returnsIfDifferent(SOCK_SEQPACKET, denial(EPERM));
  });
  filter.returnsIfEqual(__NR_connect, denial(ENOENT));  // as if no program listened
  // A pair of datagram sockets could send to every socket of the user that has a path.
  filter.forCall(__NR_socketpair, [&] {
    filter.loadArgument(0);
    filter.returnsIfDifferent(AF_UNIX, denial(EPERM));
    filter.loadArgument(1);
    filter.mask(kSocketTypes);
    filter.returnsIfEqual(SOCK_DGRAM, denial(EPERM));
    filter.returnsIfEqual(SOCK_RAW, denial(EPERM));  // is one of datagrams, too
  });
  // A terminal, which standard error can be, would execute what is "typed" there.
  filter.forCall(__NR_ioctl, [&] {
    filter.loadArgument(1);
    filter.returnsIfEqual(TIOCSTI, denial(EPERM));
    filter.returnsIfEqual(TIOCLINUX, denial(EPERM));
  });
  forbidTruncation(filter, __NR_openat, 2);
#if defined(__x86_64__)
  forbidTruncation(filter, __NR_open, 1);
#endif
  // Limits of other processes.
  filter.forCall(__NR_prlimit64, [&] {
    filter.loadArgument(0);
    filter.returnsIfEqual(0, kAllow);
    filter.returnsIfDifferent(static_cast<std::uint32_t>(::getpid()), denial(EPERM));
  });
  if (ownSignals) {
    constexpr std::uint32_t kSignals[] = {__NR_kill, __NR_tgkill, __NR_rt_sigqueueinfo, __NR_rt_tgsigqueueinfo};
    for (const std::uint32_t number : kSignals)
      filter.forCall(number, [&] {
        filter.loadArgument(0);
        filter.returnsIfDifferent(static_cast<std::uint32_t>(::getpid()), denial(EPERM));
      });
    filter.returnsIfEqual(__NR_tkill, denial(EPERM));
  }
  filter.returns(kAllow);
  filter.install();
}

}  // namespace quintet::lab
