// Failures of the world, one exception type per cause. Every message is one line that names the
// object and the place; programmer errors are asserts. Apps catch once, print what(), and exit 1
// (UsageError: 2). Vulkan's own failures are in gpu/error.h.
#ifndef QUINTET_ERROR_H
#define QUINTET_ERROR_H

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace quintet {

class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

// A file that is missing, unreadable, unwritable or broken. `place` is a JSON pointer, "line 3",
// "byte 12", or empty: "scene.gltf: /accessors/3/bufferView: 12 bytes past the end of buffer 0".
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& file, std::string_view place, std::string_view problem);
  FileError(const std::filesystem::path& file, std::string_view problem) : FileError(file, {}, problem) {}
  const std::filesystem::path& file() const { return file_; }
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }

 private:
  std::filesystem::path file_;
  std::string place_;
  std::string problem_;
};

// The caller asked for something that makes no sense (unknown option, value out of range).
class UsageError : public Error {
 public:
  using Error::Error;
};

// Host or device memory is exhausted, or a request is larger than any limit.
class MemoryError : public Error {
 public:
  using Error::Error;
};

}  // namespace quintet
#endif
