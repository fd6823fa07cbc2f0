// SPDX-License-Identifier: Apache-2.0
#include "lab/start_target.h"

#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "lab/named_files.h"
#include "lab/program_files.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

bool isScene(const std::string& name) {
  const std::string lower = lowerCase(name);
  return lower.ends_with(".gltf") || lower.ends_with(".glb") || lower.ends_with(".scene.toml");
}

// The project is the file and what it names.
StartTarget ofFile(const fs::path& file, std::string program, std::string scene) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  return {folder, namedFiles(folder, file.filename().string()), std::move(program), std::move(scene)};
}

StartTarget ofFolder(const fs::path& folder) {
  const std::vector<ProgramSummary> programs = projectSummaries(ProjectFolder(folder));
  return {folder, {}, programs.empty() ? kDefaultProgram : programs.front().name, ""};
}

}  // namespace

StartTarget chooseStart(const std::string& argument) {
  if (argument.empty()) return {kDefaultFolder, {}, kDefaultProgram, ""};
  std::error_code ignored;
  const fs::path path(argument);
  if (fs::is_directory(path, ignored)) return ofFolder(path);
  if (isScene(argument)) {
    if (!fs::exists(path, ignored)) throw FileError(path, "does not exist");
    return ofFile(path, "<programs/pathtracer>", path.filename().string());
  }
  for (const fs::path& file : {path, fs::path(argument + std::string(program::kLectureExtension))})
    if (fs::is_regular_file(file, ignored)) {
      if (file.filename() == "program.toml") return ofFolder(file.has_parent_path() ? file.parent_path() : ".");
      return ofFile(file, file.filename().string(), "");
    }
  return {kDefaultFolder, {}, fmt::format("<programs/{}>", program::loadProgram(argument).name), ""};
}

}  // namespace quintet::lab
