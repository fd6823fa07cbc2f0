// SPDX-License-Identifier: Apache-2.0
#include "job/identity.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "job/version.h"
#include "shader/include_resolver.h"
#include "shader/library.h"

namespace quintet::job {
namespace {

// Names of the files that decide what the program does: descriptions, shaders, and what those include, whatever their
// extension.
std::set<std::string> sourceNames(const program::Program& program) {
  std::set<std::string> names;
  std::vector<std::string> open;
  const auto add = [&](const std::string& name) {
    if (names.insert(name).second) open.push_back(name);
  };
  for (const auto& [name, text] : program.files)
    if (isProgramSource(name) && !name.ends_with(".scene.toml")) add(name);
  while (!open.empty()) {
    const std::string& text = program.files.at(open.back());
    open.pop_back();
    for (const shader::IncludeDirective& include : shader::findIncludes(text)) {
      const auto isMeant = [wanted = std::filesystem::path(include.name).filename()](const auto& file) {
        return std::filesystem::path(file.first).filename() == wanted;
      };
      const auto found = std::ranges::find_if(program.files, isMeant);
      if (found != program.files.end()) add(found->first);
    }
  }
  return names;
}

// An image counts by its content, not by its location.
std::string imageHash(const program::Program& program, const program::ImageValue& image) {
  if (image.file.empty()) return "none";
  Hasher hasher;
  if (image.ofProgram)
    hasher.add(program.files.at(image.file));
  else
    hasher.add(readTextFile(image.file));
  return hasher.finish().hex();
}

std::vector<std::pair<std::string, std::string>> parameterFacts(const ResolvedJob& job) {
  const nlohmann::ordered_json values = nlohmann::ordered_json::parse(job.parameters.toJson());
  const std::vector<program::ImageValue> images = job.parameters.images();
  std::vector<std::pair<std::string, std::string>> facts;
  for (const program::Parameter& parameter : job.parameters.parameters()) {
    const auto image = std::ranges::find(images, parameter.name, &program::ImageValue::parameter);
    facts.emplace_back(parameter.name,
                       image != images.end() ? imageHash(job.program, *image) : values.at(parameter.name).dump());
  }
  return facts;
}

std::string vectorText(const vec4& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

}  // namespace

Provenance identityOf(const ResolvedJob& job, const render::Renderer& renderer, const scene::Camera& camera,
                      uvec2 size) {
  const RenderRequest& request = job.request;
  Provenance p;
  p.version = quintetVersion();
  p.program = job.program.name;
  p.libraryHash = shader::libraryHash().hex();
  p.parameterValues = parameterFacts(job);
  const mat4& m = camera.worldFromCamera;
  p.projection = camera.orthographic
                     ? fmt::format("orthographic {} x {}", camera.orthographicHalfSize.x, camera.orthographicHalfSize.y)
                     : fmt::format("perspective, {} rad", camera.verticalFov);
  p.cameraPosition = vectorText(m[3]);
  p.cameraAxes = fmt::format("{} {} {}", vectorText(m[0]), vectorText(m[1]), vectorText(m[2]));
  p.lens = fmt::format("radius {} m, focus {} m", camera.apertureRadius, camera.focusDistance);
  p.size = size;
  p.region = renderer.film().region();
  p.seed = request.seed;
  p.plannedSamples = request.limits.samples;
  p.adaptive = request.limits.adaptive;
  p.transparent = request.transparent;
  if (request.shutter) p.shutter = fmt::format("{},{}", request.shutter->open, request.shutter->close);
  std::vector<std::string> stored;
  for (std::size_t i = 0; i < job.program.outputs.size(); ++i)
    if (renderer.film().stores(i)) stored.push_back(job.program.outputs[i].name);
  p.outputs = fmt::format("{}", fmt::join(stored, ", "));
  return p;
}

std::string programHash(const program::Program& program, const std::vector<Hash>& includedFiles) {
  Hasher hasher;
  for (const std::string& name : sourceNames(program)) hasher.add(name).add(program.files.at(name));
  for (const Hash& hash : includedFiles) hasher.add(hash.high).add(hash.low);
  return hasher.finish().hex();
}

std::vector<std::filesystem::path> programFiles(const ResolvedJob& job) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& [name, text] : job.program.files) {  // the stages of the lecture form are not files
    const std::filesystem::path file = job.program.path(name);
    if (isProgramSource(name) && std::filesystem::is_regular_file(file, ignored)) files.push_back(file);
  }
  for (const program::ImageValue& image : job.parameters.images())
    if (!image.file.empty()) files.emplace_back(image.ofProgram ? job.program.path(image.file) : image.file);
  if (!job.request.parameterFile.empty()) files.push_back(job.request.parameterFile);
  std::erase_if(files, [](const auto& file) { return file.string().starts_with('<'); });  // in memory
  return files;
}

}  // namespace quintet::job
