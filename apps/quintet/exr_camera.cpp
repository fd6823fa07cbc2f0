#include "exr_camera.h"

#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "film_facts.h"

namespace quintet::app {
namespace {

constexpr const char* kWorldToCamera = "world to camera";
constexpr const char* kWorldToNdc = "world to NDC";

// Sixteen numbers in the order of the file, for row vectors: what oiiotool prints of the attribute.
std::string matrixText(const mat4& m) {
  std::string text;
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row) text += fmt::format("{}{}", text.empty() ? "" : " ", m[column][row]);
  return text;
}

mat4 parseMatrix(const std::string& name, const std::string& text) {
  mat4 m;
  const char *at = text.data(), *const end = at + text.size();
  for (std::size_t i = 0; i < 16; ++i) {
    if (i > 0 && at != end && *at == ' ') ++at;
    float& value = m[i / 4][i % 4];
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value))
      throw UsageError(fmt::format("{}: not a matrix of 16 numbers", name));
    at = next;
  }
  if (at != end) throw UsageError(fmt::format("{}: more than 16 numbers", name));
  return m;
}

}  // namespace

std::optional<render::CameraMatrices> shownCamera(const program::Program& program, const scene::Camera& camera,
                                                  uvec2 size) {
  if (program.accumulation == program::Accumulation::program) return std::nullopt;
  return render::cameraMatrices(camera, size.x, size.y);
}

void addCamera(io::ExrPicture& picture, const std::optional<render::CameraMatrices>& matrices) {
  if (!matrices) return;
  picture.attributes.push_back({"worldToCamera", matrices->cameraFromWorld});
  picture.attributes.push_back({"worldToNDC", matrices->ndcFromWorld});
}

void addCameraNotes(render::FilmFacts& notes, const std::optional<render::CameraMatrices>& matrices) {
  if (!matrices) return;
  setFact(notes, kWorldToCamera, matrixText(matrices->cameraFromWorld));
  setFact(notes, kWorldToNdc, matrixText(matrices->ndcFromWorld));
}

std::optional<render::CameraMatrices> readCameraNotes(const render::FilmFacts& notes) {
  const std::string* camera = render::findFact(notes, kWorldToCamera);
  const std::string* ndc = render::findFact(notes, kWorldToNdc);
  if (!camera || !ndc) return std::nullopt;
  return render::CameraMatrices{parseMatrix(kWorldToCamera, *camera), parseMatrix(kWorldToNdc, *ndc)};
}

void joinCameraNotes(render::FilmFacts& notes, const render::FilmFacts& others) {
  if (!readCameraNotes(notes)) addCameraNotes(notes, readCameraNotes(others));
}

}  // namespace quintet::app
