// SPDX-License-Identifier: Apache-2.0
// Explanations and logs made by hand.
#ifndef QUINTET_TESTS_UNIT_JOB_EXPLANATIONS_H
#define QUINTET_TESTS_UNIT_JOB_EXPLANATIONS_H

#include <cstring>
#include <utility>
#include <vector>

#include "job/explanation_builder.h"
#include "job/pixel_explanation.h"
#include "quintet/shared/explain.h"

namespace quintet::job {

// Records as shaders append them.
class LogWriter {
 public:
  template <class T>
  LogWriter& add(std::uint32_t kind, const T& record) {
    std::vector<std::uint32_t> words(sizeof(T) / sizeof(std::uint32_t));
    std::memcpy(words.data(), &record, sizeof(T));
    return words_(kind, words);
  }
  LogWriter& add(std::uint32_t kind) { return words_(kind, {}); }
  LogWriter& addWords(std::uint32_t kind, const std::vector<std::uint32_t>& words) { return words_(kind, words); }
  const render::LogContents& contents() const { return contents_; }

 private:
  LogWriter& words_(std::uint32_t kind, const std::vector<std::uint32_t>& words) {
    contents_.records.push_back({kind, {3, 4}, 0, contents_.words.size(), words.size()});
    contents_.words.insert(contents_.words.end(), words.begin(), words.end());
    return *this;
  }
  render::LogContents contents_;
};

// A path with one bounce: two rays, a light sample, and two contributions that sum to the value.
inline PixelExplanation somePath() {
  PixelExplanation e;
  e.version = "1.0";
  e.scene = "room.glb";
  e.program = "pathtracer";
  e.parameters = "bounces=12";
  e.camera = "camera 0";
  e.device = "device";
  e.driver = "driver";
  e.size = {640, 480};
  e.pixel = {3, 4};
  e.sample = 5;
  e.plannedSamples = 64;
  e.outputs = {{"color", {0.75f, 0.5f, 0.25f, 1.0f}, {0.75f, 0.5f, 0.25f, 1.0f}}};
  const ExplainedEvent payload{"payload",
                               {{"when", std::string("after")},
                                {"variable", std::string("payload")},
                                {"dataType", std::string("Payload")},
                                {"payload.t", 2.5f},
                                {"payload.ids", std::vector<std::int64_t>{1, -2}}},
                               {}};
  const ExplainedEvent hit{"closest-hit",
                           {{"stage", std::string("surface.rchit")},
                            {"instance", std::int64_t{0}},
                            {"instanceName", std::string("floor")},
                            {"geometry", std::int64_t{0}},
                            {"primitive", std::int64_t{7}},
                            {"t", 2.5f},
                            {"barycentrics", std::vector<float>{0.25f, 0.5f}},
                            {"uv", std::vector<float>{0.0f, 0.0f}},
                            {"geometricNormal", std::vector<float>{0, 1, 0}},
                            {"shadingNormal", std::vector<float>{0, 1, 0}}},
                           {}};
  const auto ray = [](const char* type, std::vector<ExplainedEvent> children) {
    return ExplainedEvent{"ray",
                          {{"stage", std::string("main.rgen")},
                           {"line", std::int64_t{12}},
                           {"rayType", std::string(type)},
                           {"flags", std::string()},
                           {"cullMask", std::int64_t{255}},
                           {"missIndex", std::int64_t{0}},
                           {"origin", std::vector<float>{0, 1, 5}},
                           {"tmin", 0.0f},
                           {"direction", std::vector<float>{0, 0, -1}},
                           {"tmax", 3.402823466e38f},
                           {"result", std::string(children.empty() ? "miss" : "hit")}},
                          std::move(children)};
  };
  const auto contribution = [](const char* source, std::int64_t scatterings, std::vector<float> value) {
    return ExplainedEvent{"contribution",
                          {{"source", std::string(source)}, {"scatterings", scatterings}, {"value", std::move(value)}},
                          {}};
  };
  e.events = {ray("radiance", {hit, payload}), contribution("surface", 0, {0.5f, 0.25f, 0.0f}), ray("shadow", {}),
              contribution("light sample", 1, {0.25f, 0.25f, 0.25f})};
  return e;
}

}  // namespace quintet::job
#endif
