// SPDX-License-Identifier: Apache-2.0
// What the process of a page can reach. On a CPU, the driver runs shaders as code of this process, and buffer references are
// plain addresses: such a shader can do whatever the process can. So the process gives up everything that it does not need before
// it loads a driver: docs/lab.md, "What the token grants".
#ifndef QUINTET_LAB_SANDBOX_H
#define QUINTET_LAB_SANDBOX_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lab/system_call_filter.h"

namespace quintet::lab {

// What this kernel, or the container around this process, offers.
struct SandboxSupport {
  bool namespaces = false;  // processes, network and IPC of its own
  int landlock = 0;         // version of Landlock (files); 0: missing
  bool seccomp = false;     // filter of system calls
};
// Starts a process to find out, once.
const SandboxSupport& sandboxSupport();
// One line for the user about what is missing; empty if nothing is.
std::string sandboxGaps(const SandboxSupport& support);

struct SandboxRules {
  std::vector<std::filesystem::path> readable;  // files and folders, besides those of the system and its drivers
  std::vector<std::filesystem::path> writable;  // folders
  std::size_t memory = 0;                       // bytes that the process can allocate; 0: no limit
};

// Restricts this process, which has one thread, and all that it starts. Parts that the kernel does not offer are skipped. In a
// process of clone() with namespaceFlags(), it also hides the other processes. Throws SandboxError.
void enterSandbox(const SandboxRules& rules);

// Flags of clone() for a process in namespaces of its own.
std::uint64_t namespaceFlags();
// In the new process of clone() with namespaceFlags(), before exec: maps its user. Uses nothing but system calls. Returns whether it
// succeeded.
bool mapUser(const char* userMap, const char* groupMap);
std::string userMap();  // for mapUser(), made before clone()
std::string groupMap();

// The folders with libraries and settings of drivers that the environment names, and those that manifests of drivers name.
std::vector<std::filesystem::path> driverPaths();

}  // namespace quintet::lab
#endif
