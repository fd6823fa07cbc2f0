// SPDX-License-Identifier: Apache-2.0
#include "lab/sandbox.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <linux/securebits.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/parse.h"
#include "lab/system_call_filter.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

// ---- Landlock. The headers of Debian 12 know its first two versions only.

constexpr long kCreateRuleset = 444, kAddRule = 445, kRestrictSelf = 446;  // system calls
constexpr std::uint64_t kExecute = 1u << 0, kWriteFile = 1u << 1, kReadFile = 1u << 2, kReadDir = 1u << 3,
                        kRemoveDir = 1u << 4, kRemoveFile = 1u << 5, kMakeDir = 1u << 7, kMakeFile = 1u << 8,
                        kRefer = 1u << 13, kTruncate = 1u << 14, kIoctlDevice = 1u << 15;
constexpr std::uint64_t kFirstFileRights = (1u << 13) - 1;  // of version 1
constexpr std::uint64_t kNetwork = 3, kScopes = 3;          // TCP: bind, connect; abstract Unix sockets, signals

constexpr std::uint64_t kRead = kReadFile | kReadDir;
constexpr std::uint64_t kWrite =
    kRead | kWriteFile | kRemoveDir | kRemoveFile | kMakeDir | kMakeFile | kRefer | kTruncate;
constexpr std::uint64_t kDevice = kRead | kWriteFile | kIoctlDevice;
constexpr std::uint64_t kRightsOfFiles = kExecute | kWriteFile | kReadFile | kTruncate | kIoctlDevice;

struct RulesetAttributes {
  std::uint64_t files, network, scopes;
};
struct [[gnu::packed]] PathRule {
  std::uint64_t rights;
  std::int32_t folder;
};

int landlockVersion() {
  constexpr unsigned kVersion = 1;
  const long version = ::syscall(kCreateRuleset, nullptr, 0, kVersion);
  return version > 0 ? static_cast<int>(version) : 0;
}

std::uint64_t fileRights(int version) {
  return kFirstFileRights | (version >= 2 ? kRefer : 0) | (version >= 3 ? kTruncate : 0) |
         (version >= 5 ? kIoctlDevice : 0);
}

[[noreturn]] void fail(const char* what) {
  throw SandboxError(fmt::format("cannot restrict the process of the page ({}): {}", what, std::strerror(errno)));
}

class FileRules {
 public:
  explicit FileRules(int version) : handled_(fileRights(version)) {
    const RulesetAttributes attributes{handled_, kNetwork, kScopes};
    const std::size_t size = version >= 6   ? sizeof attributes
                             : version >= 4 ? offsetof(RulesetAttributes, scopes)
                                            : offsetof(RulesetAttributes, network);
    rules_ = static_cast<int>(::syscall(kCreateRuleset, &attributes, size, 0));
    if (rules_ < 0) fail("Landlock");
  }
  ~FileRules() { ::close(rules_); }
  FileRules(const FileRules&) = delete;
  FileRules& operator=(const FileRules&) = delete;

  // Without effect if the path does not exist.
  void allow(const fs::path& path, std::uint64_t rights) {
    const int folder = ::open(path.c_str(), O_PATH | O_CLOEXEC);
    if (folder < 0) return;
    struct stat status {};
    if (::fstat(folder, &status) == 0 && !S_ISDIR(status.st_mode)) rights &= kRightsOfFiles;
    const PathRule rule{rights & handled_, folder};
    constexpr int kPathBeneath = 1;
    if (rule.rights != 0) ::syscall(kAddRule, rules_, kPathBeneath, &rule, 0);
    ::close(folder);
  }
  void apply() {
    if (::syscall(kRestrictSelf, rules_, 0) != 0) fail("Landlock");
  }

 private:
  const std::uint64_t handled_;
  int rules_ = -1;
};

// ---- Paths

constexpr const char* kPrograms[] = {"/usr",  "/lib", "/lib32",     "/lib64",     "/libx32",           "/bin",
                                     "/sbin", "/opt", "/nix/store", "/gnu/store", "/run/opengl-driver"};
// Not the whole of /etc: for root, it has passwords. Not the whole of /proc: other processes are there.
constexpr const char* kSettings[] = {
    "/etc/vulkan",       "/etc/glvnd",         "/etc/nvidia",       "/etc/OpenCL",   "/etc/drirc",
    "/etc/ld.so.cache",  "/etc/ld.so.preload", "/etc/localtime",    "/etc/passwd",   "/etc/nsswitch.conf",
    "/etc/locale.alias", "/sys/bus",           "/sys/class",        "/sys/dev",      "/sys/devices",
    "/sys/module",       "/sys/kernel/mm",     "/proc/self",        "/proc/cpuinfo", "/proc/meminfo",
    "/proc/stat",        "/proc/version",      "/proc/filesystems", "/proc/devices", "/proc/modules",
    "/proc/driver",      "/proc/sys/vm",       "/proc/sys/kernel",  "/dev/null",     "/dev/zero",
    "/dev/full",         "/dev/random",        "/dev/urandom"};
// Of graphics drivers, by the begin of the name in /dev.
constexpr std::string_view kDevices[] = {"dri", "nvidia", "kfd", "dxg", "accel", "mali", "udmabuf"};

std::vector<fs::path> deviceNodes() {
  std::vector<fs::path> nodes;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev", error)) {
    const std::string name = entry.path().filename().string();
    if (std::ranges::any_of(kDevices, [&](std::string_view begin) { return name.starts_with(begin); }))
      nodes.push_back(entry.path());
  }
  return nodes;
}

std::vector<fs::path> pathsOf(const char* variable) {
  std::vector<fs::path> paths;
  const char* value = std::getenv(variable);
  for (const std::string& path : splitText(value ? value : "", ':'))
    if (!path.empty()) paths.emplace_back(path);
  return paths;
}

// The folder of the library that a manifest of a driver or a layer names, unless the system finds it.
fs::path libraryFolder(const fs::path& manifest) {
  try {
    const nlohmann::json json = parseJson(readTextFile(manifest));
    for (const char* key : {"ICD", "layer"}) {
      const auto object = json.find(key);
      if (object == json.end() || !object->is_object()) continue;
      const fs::path library = object->value("library_path", "");
      if (library.has_parent_path()) return (manifest.parent_path() / library).parent_path();
    }
  } catch (const Error&) {  // the loader reports it
  } catch (const nlohmann::json::exception&) {
  }
  return {};
}

// ---- The other parts

// A private /proc without the other processes. Containers can forbid it; then Landlock hides them alone.
void hideProcesses() {
  if (::mount("", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return;
  ::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr);
}

void dropCapabilities() {
  // Root would get them back with the next program that it starts.
  ::prctl(PR_SET_SECUREBITS, SECBIT_NOROOT | SECBIT_NOROOT_LOCKED | SECBIT_NO_SETUID_FIXUP_LOCKED |
                                 SECBIT_NO_CAP_AMBIENT_RAISE | SECBIT_NO_CAP_AMBIENT_RAISE_LOCKED);
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  for (unsigned long capability = 0; ::prctl(PR_CAPBSET_READ, capability) >= 0; ++capability)
    ::prctl(PR_CAPBSET_DROP, capability);
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> none{};
  if (::syscall(__NR_capset, &header, none.data()) != 0) fail("capabilities");
}

void limit(__rlimit_resource resource, rlim_t value) {
  rlimit current{};
  if (::getrlimit(resource, &current) != 0) return;
  value = std::min(value, current.rlim_max);
  const rlimit limits{value, value};
  ::setrlimit(resource, &limits);
}

void limitResources(std::size_t memory) {
  constexpr rlim_t kFileBytes = rlim_t{4} << 30, kFiles = 4096, kCpuSeconds = 24 * 3600;
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, kFileBytes);
  limit(RLIMIT_NOFILE, kFiles);
  limit(RLIMIT_CPU, kCpuSeconds * hardwareThreads());
  limit(RLIMIT_MSGQUEUE, 0);
  limit(RLIMIT_MEMLOCK, rlim_t{1} << 30);
  if (memory > 0) limit(RLIMIT_DATA, memory);
}

bool writeAll(const char* file, const char* text) {
  const int descriptor = ::open(file, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const std::size_t size = std::strlen(text);
  const bool written = ::write(descriptor, text, size) == static_cast<ssize_t>(size);
  ::close(descriptor);
  return written;
}

// Whether a process in namespaces of its own gets the rights in them.
bool hasNamespaces() {
  const std::string users = userMap(), groups = groupMap();
  const auto process = static_cast<pid_t>(::syscall(__NR_clone, namespaceFlags() | SIGCHLD, 0, 0, 0, 0));
  if (process == 0)
    ::_exit(mapUser(users.c_str(), groups.c_str()) && ::mount("", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 ? 0
                                                                                                                   : 1);
  if (process < 0) return false;
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

const SandboxSupport& sandboxSupport() {
  static const SandboxSupport kSupport{hasNamespaces(), landlockVersion(), hasSystemCallFilter()};
  return kSupport;
}

std::string sandboxGaps(const SandboxSupport& support) {
  std::vector<std::string> gaps;
  if (support.landlock == 0)
    gaps.emplace_back("it can read and write all files that you can (Landlock is missing or not allowed)");
  if (!support.seccomp)
    gaps.emplace_back(support.namespaces
                          ? "it can use all system calls (no seccomp)"
                          : "it can use the network and all other system calls (no namespaces, no seccomp)");
  if (!support.namespaces)
    gaps.emplace_back(
        "processes that it starts can outlive it (the kernel or the container allows no user namespaces)");
  if (gaps.empty()) return {};
  return fmt::format("a shader that takes over the process of its page is contained only in part: {}",
                     fmt::join(gaps, "; "));
}

std::uint64_t namespaceFlags() {
  return CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNS | CLONE_NEWNET | CLONE_NEWIPC | CLONE_NEWUTS;
}

std::string userMap() { return fmt::format("0 {} 1\n", ::geteuid()); }
std::string groupMap() { return fmt::format("0 {} 1\n", ::getegid()); }

bool mapUser(const char* userMap, const char* groupMap) {
  return writeAll("/proc/self/setgroups", "deny") && writeAll("/proc/self/uid_map", userMap) &&
         writeAll("/proc/self/gid_map", groupMap);
}

std::vector<fs::path> driverPaths() {
  std::vector<fs::path> paths = pathsOf("LD_LIBRARY_PATH"), manifests, folders;
  for (const char* variable : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "VK_LAYER_PATH",
                               "VK_ADD_LAYER_PATH", "VK_IMPLICIT_LAYER_PATH"})
    std::ranges::copy(pathsOf(variable), std::back_inserter(manifests));
  for (const char* variable : {"XDG_DATA_DIRS", "XDG_CONFIG_DIRS", "XDG_DATA_HOME", "XDG_CONFIG_HOME"})
    std::ranges::copy(pathsOf(variable), std::back_inserter(folders));
  if (const char* home = std::getenv("HOME"))
    for (const char* folder : {".local/share", ".config"}) folders.push_back(fs::path(home) / folder);
  for (const fs::path& folder : {fs::path("/etc"), fs::path("/usr/share"), fs::path("/usr/local/share")})
    folders.push_back(folder);
  for (const fs::path& folder : folders)
    for (const char* kind : {"icd.d", "implicit_layer.d", "explicit_layer.d"})
      manifests.push_back(folder / "vulkan" / kind);
  for (const fs::path& manifest : manifests) {
    std::error_code error;
    paths.push_back(manifest);
    if (fs::is_regular_file(manifest, error)) paths.push_back(libraryFolder(manifest));
    for (const fs::directory_entry& entry : fs::directory_iterator(manifest, error))
      if (entry.path().extension() == ".json") paths.push_back(libraryFolder(entry.path()));
  }
  std::erase_if(paths, [](const fs::path& path) { return path.empty(); });
  return paths;
}

void enterSandbox(const SandboxRules& rules) {
  const SandboxSupport support{::getpid() == 1, landlockVersion(), hasSystemCallFilter()};
  if (support.namespaces) hideProcesses();
  limitResources(rules.memory);
  dropCapabilities();
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) fail("no_new_privs");
  constexpr int kScopedSignals = 6;  // version of Landlock
  if (support.landlock > 0) {
    FileRules files(support.landlock);
    for (const char* path : kPrograms) files.allow(path, kRead | kExecute);
    for (const char* path : kSettings) files.allow(path, kRead);
    files.allow("/dev/null", kDevice);
    for (const fs::path& path : deviceNodes()) files.allow(path, kDevice);
    for (const fs::path& path : driverPaths()) files.allow(path, kRead | kExecute);
    for (const fs::path& path : rules.readable) files.allow(path, kRead);
    for (const fs::path& path : pathsOf("PATH"))  // of ffmpeg
      if (path.is_absolute()) files.allow(path, kReadFile | kExecute);
    for (const fs::path& path : rules.writable) files.allow(path, kWrite);
    files.apply();
  }
  if (support.seccomp) filterSystemCalls(!support.namespaces && support.landlock < kScopedSignals);
}

}  // namespace quintet::lab
