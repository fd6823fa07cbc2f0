// SPDX-License-Identifier: Apache-2.0
#include "viewer/dropped_file.h"

#include <string>
#include <system_error>

#include "base/text.h"

namespace quintet::viewer {
namespace {

bool containsProgram(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder / "program.toml", error)) return true;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (lowerCase(entry.path().filename().string()).ends_with(".rt.glsl")) return true;
  return false;
}

}  // namespace

FileUse useOfFile(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return containsProgram(path) ? FileUse::program : FileUse::unknown;
  const std::string name = lowerCase(path.filename().string());
  const auto ends = [&](auto... endings) { return (name.ends_with(endings) || ...); };
  if (name == "program.toml" || ends(".rt.glsl")) return FileUse::program;
  if (ends(".gltf", ".glb", ".scene.toml")) return FileUse::scene;
  if (ends(".hdr", ".exr")) return FileUse::environment;
  if (ends(".png", ".jpg", ".jpeg", ".webp", ".ktx2")) return FileUse::reference;
  if (ends(".json")) return FileUse::explanation;
  return FileUse::unknown;
}

}  // namespace quintet::viewer
