#include "base/error.h"

namespace quintet {
namespace {

std::string describe(const std::filesystem::path& file, std::string_view place, std::string_view problem) {
  std::string text = file.string();
  if (!place.empty()) text.append(": ").append(place);
  return text.append(": ").append(problem);
}

}  // namespace

FileError::FileError(const std::filesystem::path& file, std::string_view place, std::string_view problem)
    : Error(describe(file, place, problem)), file_(file), place_(place), problem_(problem) {}

}  // namespace quintet
