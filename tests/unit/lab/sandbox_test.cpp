// SPDX-License-Identifier: Apache-2.0
// The sandbox in a process of its own: what it can no longer do. The attacks of tests/lab try the same with a worker.
#include "lab/sandbox.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>  // NOLINT: kill() of POSIX
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "base/file.h"
#include "temp_folder.h"

namespace quintet::lab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SandboxTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (sandboxSupport().landlock == 0 || !sandboxSupport().seccomp)
      GTEST_SKIP() << "the kernel offers no Landlock or no seccomp";
    writeFile(folder_ / "secret.txt", "secret");
    std::filesystem::create_directories(folder_ / "project");
    std::filesystem::create_directories(folder_ / "cache");
    writeFile(folder_ / "project/a.glsl", "text");
  }

  // Returns whether `body` returned true in a process in the sandbox.
  bool contained(const std::function<bool()>& body) {
    SandboxRules rules;
    rules.readable.push_back(folder_ / "project");
    rules.writable.push_back(folder_ / "cache");
    const pid_t process = ::fork();
    if (process == 0) {
      try {
        enterSandbox(rules);
        ::_exit(body() ? 0 : 1);
      } catch (...) {
        ::_exit(2);
      }
    }
    int status = 0;
    ::waitpid(process, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) < 2) << status;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  bool opens(const std::string& file, int flags = O_RDONLY) const {
    return ::open((folder_ / file).c_str(), flags, 0600) >= 0;
  }

  const test::TempFolder folder_;
};

TEST_F(SandboxTest, ReadsTheProjectAndWritesTheCacheOnly) {
  EXPECT_TRUE(contained([&] { return opens("project/a.glsl"); }));
  EXPECT_TRUE(contained([&] { return opens("cache/new", O_CREAT | O_WRONLY); }));
  EXPECT_TRUE(contained([&] { return ::open("/usr/lib", O_RDONLY) >= 0 && ::open("/dev/null", O_RDWR) >= 0; }));
  EXPECT_FALSE(contained([&] { return opens("secret.txt"); }));
  EXPECT_FALSE(contained([&] { return opens("project/a.glsl", O_WRONLY); }));
  EXPECT_FALSE(contained([&] { return opens("project/a.glsl", O_RDONLY | O_TRUNC); }));
  EXPECT_FALSE(contained([&] { return opens("project/new", O_CREAT | O_WRONLY); }));
  EXPECT_FALSE(contained([&] { return ::truncate((folder_ / "project/a.glsl").c_str(), 0) == 0; }));
  EXPECT_FALSE(contained([&] { return ::chmod((folder_ / "secret.txt").c_str(), 0777) == 0; }));
  EXPECT_FALSE(contained([&] { return ::unlink((folder_ / "project/a.glsl").c_str()) == 0; }));
  EXPECT_FALSE(contained([&] { return ::symlink("/etc/shadow", (folder_ / "cache/link").c_str()) == 0; }));
  EXPECT_FALSE(contained([&] { return ::open("/etc/shadow", O_RDONLY) >= 0; }));
  EXPECT_FALSE(contained([&] { return ::open(std::getenv("HOME") ? std::getenv("HOME") : "/root", O_RDONLY) >= 0; }));
  EXPECT_EQ(readTextFile(folder_ / "project/a.glsl"), "text");
}

TEST_F(SandboxTest, HasNoNetwork) {
  for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK})
    EXPECT_FALSE(contained([&] { return ::socket(family, SOCK_STREAM, 0) >= 0 || ::socket(family, SOCK_RAW, 0) >= 0; }))
        << family;
  EXPECT_FALSE(contained([] { return ::socket(AF_UNIX, SOCK_DGRAM, 0) >= 0; }));
  EXPECT_TRUE(contained([] {
    int ends[2];
    return ::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0;  // for ffmpeg
  }));
  // These can send to other sockets.
  constexpr int kTypes[] = {SOCK_DGRAM, SOCK_RAW, SOCK_DGRAM | SOCK_CLOEXEC};
  for (const int type : kTypes)
    EXPECT_FALSE(contained([&] {
      int ends[2];
      return ::socketpair(AF_UNIX, type, 0, ends) == 0;
    })) << type;
}

// As NVIDIA's driver does when it creates a device for ray tracing.
TEST_F(SandboxTest, CanListenToASocketThatReachesNobody) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "quintet-test-" + std::to_string(::getpid());
  std::ranges::copy(name, address.sun_path + 1);  // abstract
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  const auto* at = reinterpret_cast<const sockaddr*>(&address);
  EXPECT_TRUE(contained([&] {
    const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    return socket >= 0 && ::bind(socket, at, size) == 0 && ::listen(socket, 1) == 0;
  }));
  const int listening = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  ASSERT_TRUE(listening >= 0 && ::bind(listening, at, size) == 0 && ::listen(listening, 1) == 0);
  EXPECT_FALSE(contained([&] {
    const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
    return ::connect(socket, at, size) == 0 || ::sendto(socket, "x", 1, 0, at, size) == 1;
  }));
  ::close(listening);
}

TEST_F(SandboxTest, ReachesNoOtherProcess) {
  const pid_t parent = ::getpid();
  EXPECT_FALSE(contained([&] { return ::kill(parent, 0) == 0; }));
  EXPECT_FALSE(contained([] { return ::opendir("/proc") != nullptr; }));
  EXPECT_FALSE(
      contained([&] { return ::open(("/proc/" + std::to_string(parent) + "/environ").c_str(), O_RDONLY) >= 0; }));
  EXPECT_FALSE(contained([] { return ::open("/proc/1/cmdline", O_RDONLY) >= 0; }));
  EXPECT_TRUE(contained([] { return ::open("/proc/self/status", O_RDONLY) >= 0; }));
}

TEST_F(SandboxTest, HasThreadsButNoNamespacesAndNoRights) {
  EXPECT_TRUE(contained([] {
    bool ran = false;
    std::thread([&] { ran = true; }).join();
    return ran;
  }));
  EXPECT_FALSE(contained([] { return ::unshare(CLONE_NEWUSER) == 0; }));
  EXPECT_FALSE(contained([] { return ::setuid(65534) == 0 && ::getuid() == 65534; }));
}

TEST(Sandbox, SaysWhatTheKernelLacks) {
  EXPECT_EQ(sandboxGaps({.namespaces = true, .landlock = 1, .seccomp = true}), "");
  EXPECT_THAT(sandboxGaps({.namespaces = true, .landlock = 0, .seccomp = true}), HasSubstr("all files that you can"));
  EXPECT_THAT(sandboxGaps({.namespaces = false, .landlock = 1, .seccomp = true}), HasSubstr("can outlive it"));
  const std::string none = sandboxGaps({});
  EXPECT_THAT(none, HasSubstr("network"));
  EXPECT_THAT(sandboxGaps({.namespaces = true, .landlock = 1, .seccomp = false}), Not(HasSubstr("network")));
}

}  // namespace
}  // namespace quintet::lab
