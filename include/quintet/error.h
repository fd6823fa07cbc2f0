// SPDX-License-Identifier: Apache-2.0
// Exceptions for failures at run time: one type per cause. what() is one line that names the object and the location.
#ifndef QUINTET_ERROR_H
#define QUINTET_ERROR_H

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace quintet {

// What a caller can change in the request so that it succeeds. A front end adds the name of its option or control.
enum class Remedy {
  none,
  overwrite,          // allow the samples of a film to be lost
  startOver,          // discard the checkpoint
  resumeOrStartOver,  // continue from the checkpoint, or discard it
  renderRegion,       // render a part of the image
  selectLayer,        // request the output as a layer
  allowDifference,    // name the facts of two films that may differ
  measureLaunches,    // measure the launches of the program instead of its rays
  raiseMemoryLimit,   // allow the file more memory
  allowExternal,      // allow files outside of the folder of the scene file
  omitTextures,       // render without missing textures
};

// Base of all exceptions that the library throws on purpose; also thrown itself, for example if no device can be used.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, Remedy remedy = Remedy::none)
      : std::runtime_error(message), remedy_(remedy) {}
  Remedy remedy() const { return remedy_; }  // none if a change of the request does not help

 private:
  Remedy remedy_;
};

// A file that is missing, unreadable, not writable or invalid. `location` is a JSON pointer, "line 3", "byte 12", or
// empty. Example: "scene.gltf: /accessors/3/bufferView: 12 bytes past the end of buffer 0".
class FileError : public Error {
 public:
  FileError(const std::filesystem::path& file, std::string_view location, std::string_view problem,
            Remedy remedy = Remedy::none);
  FileError(const std::filesystem::path& file, std::string_view problem, Remedy remedy = Remedy::none)
      : FileError(file, {}, problem, remedy) {}
  const std::filesystem::path& file() const { return file_; }  // as the caller named it
  const std::string& location() const { return location_; }    // in the file; empty if unknown
  const std::string& problem() const { return problem_; }      // one sentence without a period

 private:
  std::filesystem::path file_;
  std::string location_;
  std::string problem_;
};

// An invalid argument or option: an unknown name, a value out of range, a combination that is not supported.
class UsageError : public Error {
 public:
  using Error::Error;
};

// Host or device memory is exhausted, or a request exceeds every limit.
class MemoryError : public Error {
 public:
  using Error::Error;
};

}  // namespace quintet
#endif
