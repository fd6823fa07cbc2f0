// SPDX-License-Identifier: Apache-2.0
#include "scene/toml/scene_toml.h"

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "scene/model/validate.h"
#include "scene/toml/context.h"

namespace quintet::scene {
namespace {

Scene read(std::string_view text, const std::filesystem::path& file, const SceneTomlOptions& options) {
  const TomlValue document = parseToml(text, file);
  SceneTomlContext context(file, options.memoryLimit);
  context.scene.name = file.filename().string();
  context.scene.report.files.push_back(file);
  TomlReader root(document, "the scene", context.file);
  readFiles(context, root);
  readMaterials(context, root);
  readMeshes(context, root);
  readPrimitives(context, root);
  readInstances(context, root);
  readView(context, root);
  root.rejectUnknownKeys();
  for (std::string& line : context.scene.report.ignored) line = printable(line);
  // The readers have checked everything, with line numbers. This finds errors that they miss.
  try {
    validate(context.scene);
  } catch (const Error& error) {
    throw FileError(file, error.what());
  }
  return std::move(context.scene);
}

}  // namespace

Scene loadSceneToml(const std::filesystem::path& file) { return parseSceneToml(readTextFile(file), file); }

Scene parseSceneToml(std::string_view text, const std::filesystem::path& file, const SceneTomlOptions& options) {
  return withMemoryErrors(file, [&] { return read(text, file, options); });
}

}  // namespace quintet::scene
