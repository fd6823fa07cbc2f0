#include "scene/scene_toml.h"

#include <new>
#include <stdexcept>

#include "base/error.h"
#include "base/file.h"
#include "scene/printable.h"
#include "scene/scene_toml_context.h"
#include "scene/validate.h"

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
  readPrimitiveSets(context, root);
  readInstances(context, root);
  readView(context, root);
  root.finish();
  for (std::string& line : context.scene.report.ignored) line = printable(line);
  // All was checked where it was read, with its line; this is for what was forgotten.
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
  try {
    return read(text, file, options);
  } catch (const std::bad_alloc&) {
    throw MemoryError(file.string() + ": not enough memory for the scene");
  } catch (const std::length_error&) {
    throw MemoryError(file.string() + ": the scene is larger than any memory");
  }
}

}  // namespace quintet::scene
