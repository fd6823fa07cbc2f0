// SPDX-License-Identifier: Apache-2.0
// What the public classes hide: each is a thin handle of the layers below.
#ifndef QUINTET_API_IMPL_H
#define QUINTET_API_IMPL_H

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <quintet/quintet.h>

#include "base/math.h"
#include "job/pixel_explanation.h"
#include "job/render_job.h"
#include "job/sample_search.h"
#include "output/layers.h"
#include "program/description/program.h"
#include "scene/model/scene.h"

namespace quintet {

// The object behind a handle. Throws UsageError if there is none.
template <class Handle>
auto& requireObject(const Handle& handle, const char* className) {
  if (!handle) throw UsageError(fmt::format("this {} is empty: it was moved from, or never got an object", className));
  return *handle;
}

struct Device::Impl {
  explicit Impl(job::EngineOptions options) : engine(std::move(options)) {}
  job::Engine engine;
};

struct Scene::Impl {
  std::shared_ptr<scene::Scene> scene = std::make_shared<scene::Scene>();  // never null
};

struct Program::Impl {
  program::Program program;
};

struct Film::Impl {
  job::RenderResult result;           // with a film in host memory
  std::vector<output::Layer> layers;  // those that Film::layer() accepts
  static Film make(job::RenderResult result, std::vector<output::Layer> layers);
};

// Reads an output (empty: the first) of a film on the device or in host memory. Throws UsageError. Defined in film.cpp, the
// others in scene.cpp.
Image toImage(const job::FilmView& film, const std::string& output);

// Defined in explanation.cpp.
std::vector<PrintedLine> toApi(const std::vector<job::PrintedLine>& lines);
Explanation toApi(const job::PixelExplanation& explanation);  // Explanation::printed is left empty
SearchReport toApi(const job::SearchResult& result);

inline vec2 toGlm(const Float2& v) { return {v[0], v[1]}; }
inline vec3 toGlm(const Float3& v) { return {v[0], v[1], v[2]}; }
inline vec4 toGlm(const Float4& v) { return {v[0], v[1], v[2], v[3]}; }
inline Float2 fromGlm(const vec2& v) { return {v.x, v.y}; }
inline Float3 fromGlm(const vec3& v) { return {v.x, v.y, v.z}; }
inline Float4 fromGlm(const vec4& v) { return {v.x, v.y, v.z, v.w}; }
mat4 toGlm(const Transform& transform);
scene::Material toScene(const Material& material);
scene::Camera toScene(const Camera& camera, const std::string& name);  // throws UsageError; `name`: for messages

}  // namespace quintet
#endif
