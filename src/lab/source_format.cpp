// SPDX-License-Identifier: Apache-2.0
#include "lab/source_format.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "output/video/ffmpeg.h"

extern char** environ;  // NOLINT: POSIX

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

// The style of the programs and lessons. Comments stay in their lines: those of uniforms have a meaning.
constexpr std::string_view kStyle =
    "--style={BasedOnStyle: Google, ColumnLimit: 120, ReflowComments: false, SortIncludes: Never, "
    "DerivePointerAlignment: false, AllowShortBlocksOnASingleLine: Always, "
    "AllowShortIfStatementsOnASingleLine: AllIfsAndElse}";

// A file without a name, in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content = {}) : descriptor_(::memfd_create("quintet-format", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw Error(std::generic_category().message(errno));
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno != EINTR) throw Error(std::generic_category().message(errno));
      if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
    }
    ::lseek(descriptor_, 0, SEEK_SET);
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  std::string content() const {
    std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(descriptor_, 0, SEEK_END), 0)), '\0');
    const ssize_t size = ::pread(descriptor_, text.data(), text.size(), 0);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    return text;
  }

 private:
  const int descriptor_;
};

pid_t startFormatter(const fs::path& formatter, const MemoryFile& input, const MemoryFile& output) {
  std::string name = formatter.string(), style(kStyle), language = "--assume-filename=shader.c";
  std::array<char*, 4> arguments{name.data(), style.data(), language.data(), nullptr};
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, input.descriptor(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, output.descriptor(), STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int failed = ::posix_spawn(&process, name.c_str(), &files, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw Error(fmt::format("{}: {}", name, std::generic_category().message(failed)));
  return process;
}

std::string withoutSpace(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isspace(c); });
  return text;
}

}  // namespace

fs::path findFormatter() {
  for (const char* name : {"clang-format", "clang-format-14"})
    if (fs::path found = output::findProgram(name); !found.empty()) return found;
  return {};
}

struct SourceFormat::Run {
  MemoryFile input, output;
  Stopwatch clock;
  pid_t process;

  Run(const fs::path& formatter, const std::string& text)
      : input(text), process(startFormatter(formatter, input, output)) {}
};

SourceFormat::SourceFormat(const fs::path& formatter, std::string text)
    : name_(formatter.filename().string()), text_(std::move(text)), run_(std::make_unique<Run>(formatter, text_)) {}

SourceFormat::~SourceFormat() {
  if (run_->process == 0) return;
  ::kill(run_->process, SIGKILL);
  while (::waitpid(run_->process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<std::string> SourceFormat::poll() {
  int status = 0;
  const pid_t ended = ::waitpid(run_->process, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) {
    if (run_->clock.seconds() <= kFormatSeconds) return {};
    throw Error(fmt::format("{} has taken longer than {:g} s", name_, kFormatSeconds));
  }
  run_->process = 0;
  if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Error(fmt::format("{} failed", name_));
  std::string formatted = run_->output.content();
  if (withoutSpace(formatted) != withoutSpace(text_))
    throw Error(fmt::format("{} would change more than white space", name_));
  return formatted;
}

}  // namespace quintet::lab
