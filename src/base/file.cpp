// SPDX-License-Identifier: Apache-2.0
#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/parallel.h"
#include "base/temporary_file.h"

namespace quintet {
namespace {

namespace fs = std::filesystem;

std::string reason(int code) { return std::generic_category().message(code); }

[[noreturn]] void failReading(const fs::path& file, int code) {
  throw FileError(file == kStandardInput ? "standard input" : file, "cannot be read: " + reason(code));
}
[[noreturn]] void failWriting(const fs::path& file, const std::string& why) {
  throw FileError(file, "cannot be written: " + why);
}
[[noreturn]] void failWriting(const fs::path& file, int code) { failWriting(file, reason(code)); }

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  explicit operator bool() const { return fd_ >= 0; }
  int get() const { return fd_; }
  // Returns false, with errno set, if the system reports a lost write at this point (NFS).
  bool close() { return fd_ < 0 || ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

// Reads the file's first bytes on all cores. Returns the length of the prefix that was read without a gap.
std::size_t readInParts(int fd, std::span<std::byte> data) {
  constexpr std::size_t kPart = std::size_t{8} << 20;
  const std::size_t parts = (data.size() + kPart - 1) / kPart;
  std::vector<std::size_t> got(parts, 0);
  parallelFor(parts, [&](std::size_t i) {
    const std::span<std::byte> part = data.subspan(i * kPart, std::min(kPart, data.size() - i * kPart));
    while (got[i] < part.size()) {
      const ssize_t more =
          ::pread(fd, part.data() + got[i], part.size() - got[i], static_cast<off_t>(i * kPart + got[i]));
      if (more <= 0) break;  // the caller reads the rest and gets the same error
      got[i] += static_cast<std::size_t>(more);
    }
  });
  std::size_t sum = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    sum += got[i];
    if (sum != std::min(data.size(), (i + 1) * kPart)) break;
  }
  return sum;
}

template <class Container>
Container readFrom(const Descriptor& in, const struct stat& info, const fs::path& file, MemoryBudget& budget) {
  Container data;
  std::size_t used = 0;
  try {
    // One byte more than the size: read() can then return 0 at the end of the file without growing the buffer.
    const std::size_t first = S_ISREG(info.st_mode) ? static_cast<std::size_t>(info.st_size) + 1 : 65536;
    budget.take(first);
    data.resize(first);
    if constexpr (std::is_same_v<Container, FileBytes>) {
      if (S_ISREG(info.st_mode)) used = readInParts(in.get(), std::span(data).first(data.size() - 1));
      if (used > 0 && ::lseek(in.get(), static_cast<off_t>(used), SEEK_SET) < 0) failReading(file, errno);
    }
    while (true) {
      const ssize_t got = ::read(in.get(), data.data() + used, data.size() - used);
      if (got == 0) break;
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) failReading(file, errno);
      used += static_cast<std::size_t>(got);
      if (used < data.size()) continue;
      budget.take(used);
      data.resize(2 * used);
    }
    data.resize(used);
  } catch (const std::bad_alloc&) {
    failReading(file, ENOMEM);
  } catch (const std::length_error&) {
    failReading(file, EFBIG);
  }
  return data;
}

// Also with the name /dev/stdin.
bool isStandardInput(const struct stat& info) {
  struct stat input {};
  return ::fstat(STDIN_FILENO, &input) == 0 && input.st_dev == info.st_dev && input.st_ino == info.st_ino;
}

// What was read from standard input, pipes and sockets, which give their bytes only once. A file is often read twice, for
// example to find its format.
class Streams {
 public:
  static Streams& instance() {
    static Streams streams;
    return streams;
  }

  // Other threads wait until the stream ends. A stream is opened once: opening a named pipe again would wait for a
  // second writer.
  std::shared_ptr<const FileBytes> read(const struct stat& info, const fs::path& file, MemoryBudget& budget) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const FileBytes>& known = bytes_[{info.st_dev, info.st_ino}];
    if (known) return known;
    const Descriptor in(isStandardInput(info) ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                                              : ::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!in) failReading(file, errno);
    known = std::make_shared<FileBytes>(readFrom<FileBytes>(in, info, file, budget));
    return known;
  }

 private:
  std::mutex mutex_;
  std::map<std::pair<dev_t, ino_t>, std::shared_ptr<const FileBytes>> bytes_;
};

template <class Container>
Container readAll(const fs::path& file, MemoryBudget& budget) {
  const bool standardInput = file == kStandardInput;
  struct stat info {};
  if ((standardInput ? ::fstat(STDIN_FILENO, &info) : ::stat(file.c_str(), &info)) != 0) failReading(file, errno);
  if (S_ISDIR(info.st_mode)) failReading(file, EISDIR);
  if (!standardInput && !S_ISFIFO(info.st_mode) && !S_ISSOCK(info.st_mode)) {
    const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!in || ::fstat(in.get(), &info) != 0) failReading(file, errno);
    return readFrom<Container>(in, info, file, budget);
  }

  const std::shared_ptr<const FileBytes> bytes = Streams::instance().read(info, file, budget);
  try {
    budget.take(bytes->size());
    using Value = typename Container::value_type;
    const auto* first = reinterpret_cast<const Value*>(bytes->data());
    return Container(first, first + bytes->size());
  } catch (const std::bad_alloc&) {
    failReading(file, ENOMEM);
  }
}

// Returns 0 or the error code.
int writeAll(int fd, std::span<const std::byte> data) {
  while (!data.empty()) {
    const ssize_t written = ::write(fd, data.data(), data.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    data = data.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

struct Target {
  fs::path path;               // symbolic links are resolved, so that a rename replaces the file and not the link
  std::optional<mode_t> mode;  // of the existing file
  bool regular() const { return !mode || S_ISREG(*mode); }
  fs::path folder() const { return path.has_parent_path() ? path.parent_path() : fs::path("."); }
};

// Resolves `file`; throws the errors of checkWritable.
Target findTarget(const fs::path& file) {
  if (file.empty()) failWriting(file, "the file name is empty");
  Target target{file, {}};
  std::error_code ignored;
  for (int links = 0; fs::is_symlink(fs::symlink_status(target.path, ignored)); ++links) {
    if (links == 40) failWriting(file, ELOOP);
    const fs::path next = fs::read_symlink(target.path, ignored);
    // A link of /proc/self/fd can name a pipe or a deleted file, which only the link itself can open.
    if (struct stat info{}; ::stat(target.path.c_str(), &info) == 0 && !S_ISREG(info.st_mode)) break;
    target.path = target.folder() / next;
  }
  struct stat info {};
  if (::stat(target.path.c_str(), &info) == 0) {
    target.mode = info.st_mode;
    if (S_ISDIR(info.st_mode)) failWriting(file, EISDIR);
    if (::access(target.path.c_str(), W_OK) != 0) failWriting(file, errno);
  } else if (errno != ENOENT) {
    failWriting(file, errno);
  } else if (!target.path.has_filename()) {
    failWriting(file, EISDIR);
  }
  if (!target.regular()) return target;
  const fs::path folder = target.folder();
  if (::stat(folder.c_str(), &info) != 0)
    failWriting(file, errno == ENOENT ? "the folder " + folder.string() + " does not exist" : reason(errno));
  if (!S_ISDIR(info.st_mode)) failWriting(file, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    failWriting(file, "the folder " + folder.string() + ": " + reason(errno));
  return target;
}

void writeDirectly(const fs::path& file, const Target& target, std::span<const std::byte> data) {
  Descriptor out(::open(target.path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (!out) failWriting(file, errno);
  if (const int code = writeAll(out.get(), data)) failWriting(file, code);
  if (!out.close()) failWriting(file, errno);
}

void syncFolder(const fs::path& folder) {
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd) ::fsync(fd.get());  // some file systems do not support this; the data is already on the disk
}

void replaceFile(const fs::path& file, const Target& target, std::span<const std::byte> data) {
  std::optional<TemporaryFile> temporary;
  try {
    temporary.emplace(target.path);
  } catch (const std::system_error& error) {
    failWriting(file, error.code().value());
  }
  if (target.mode) ::fchmod(temporary->descriptor(), *target.mode & 07777);
  if (const int code = writeAll(temporary->descriptor(), data)) failWriting(file, code);
  if (const int code = temporary->flush()) failWriting(file, code);
  if (const int code = temporary->renameToTarget()) failWriting(file, code);
  syncFolder(target.folder());
}

}  // namespace

std::vector<std::byte> readFile(const fs::path& file) {
  MemoryBudget budget(file, 0, Remedy::none);
  return readFile(file, budget);
}
std::vector<std::byte> readFile(const fs::path& file, MemoryBudget& budget) {
  return readAll<std::vector<std::byte>>(file, budget);
}
std::string readTextFile(const fs::path& file) {
  MemoryBudget budget(file, 0, Remedy::none);
  return readTextFile(file, budget);
}
std::string readTextFile(const fs::path& file, MemoryBudget& budget) { return readAll<std::string>(file, budget); }
FileBytes readLargeFile(const fs::path& file, MemoryBudget& budget) { return readAll<FileBytes>(file, budget); }

void writeFile(const fs::path& file, std::span<const std::byte> data) {
  if (file == "-") {
    if (const int code = writeAll(STDOUT_FILENO, data)) failWriting("standard output", code);
    return;
  }
  const Target target = findTarget(file);
  if (target.regular()) {
    replaceFile(file, target, data);
  } else {
    writeDirectly(file, target, data);
  }
}

void writeFile(const fs::path& file, std::string_view text) {
  writeFile(file, std::as_bytes(std::span(text.data(), text.size())));
}

void removeLeftovers(const fs::path& file) {
  if (const Target target = findTarget(file); target.regular()) TemporaryFile::removeLeftovers(target.path);
}

void checkWritable(const fs::path& file) {
  if (file == "-") {
    const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) failWriting("standard output", EBADF);
    return;
  }
  const Target target = findTarget(file);
  if (!target.regular()) return;
  // Permissions alone do not say it: root may write everywhere, but /proc and read-only file systems take no files.
  try {
    const TemporaryFile probe(target.path);
  } catch (const std::system_error& error) {
    failWriting(file, "the folder " + target.folder().string() + " takes no files: " + reason(error.code().value()));
  }
}

fs::path cacheFolder() {
  const auto variable = [](const char* name) -> fs::path {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (fs::path own = variable("QUINTET_CACHE_DIR"); !own.empty()) return own;
  // The XDG base directory specification requires that relative paths are ignored.
  if (const fs::path xdg = variable("XDG_CACHE_HOME"); xdg.is_absolute()) return xdg / "quintet";
  if (const fs::path home = variable("HOME"); home.is_absolute()) return home / ".cache" / "quintet";
  return {};
}

fs::path executableFolder() {
  std::error_code failed;
  return fs::read_symlink("/proc/self/exe", failed).parent_path();
}

}  // namespace quintet
