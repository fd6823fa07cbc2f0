// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

namespace quintet {
namespace {

std::string describe(const std::filesystem::path& file, std::string_view location, std::string_view problem) {
  std::string text = file.string();
  if (!location.empty()) text.append(": ").append(location);
  return text.append(": ").append(problem);
}

}  // namespace

FileError::FileError(const std::filesystem::path& file, std::string_view location, std::string_view problem,
                     Remedy remedy)
    : Error(describe(file, location, problem), remedy), file_(file), location_(location), problem_(problem) {}

}  // namespace quintet
