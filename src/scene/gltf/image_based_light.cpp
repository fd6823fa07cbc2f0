// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/image_based_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/texture.h"

namespace quintet::scene {
namespace {

constexpr std::uint32_t kLargestHeight = 2048;

// The axes of a face: the direction through its center, and where the image's right and bottom edges are.
struct FaceAxes {
  vec3 forward, right, down;
};
constexpr std::array<FaceAxes, 6> kFaces{{{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                          {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                          {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
                                          {{0, -1, 0}, {-1, 0, 0}, {0, 0, -1}},
                                          {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}},
                                          {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}}}};

vec3 texel(const io::Image& image, int x, int y) {
  const int last = static_cast<int>(image.width) - 1;
  const auto pixel = image.pixel<float>(static_cast<std::uint32_t>(std::clamp(x, 0, last)),
                                        static_cast<std::uint32_t>(std::clamp(y, 0, last)));
  return {pixel[0], pixel[1], pixel[2]};
}

// Bilinear interpolation within one face.
vec3 lookUp(const std::array<io::Image, 6>& faces, const vec3& direction) {
  const vec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto face = static_cast<std::size_t>(2 * axis + (direction[axis] < 0.0f ? 1 : 0));
  const vec2 onFace =
      vec2(glm::dot(direction, kFaces[face].right), glm::dot(direction, kFaces[face].down)) / size[axis];
  const vec2 position = (0.5f * onFace + 0.5f) * static_cast<float>(faces[face].width) - 0.5f;
  const vec2 first = glm::floor(position), weight = position - first;
  const int x = static_cast<int>(first.x), y = static_cast<int>(first.y);
  const vec3 top = glm::mix(texel(faces[face], x, y), texel(faces[face], x + 1, y), weight.x);
  const vec3 bottom = glm::mix(texel(faces[face], x, y + 1), texel(faces[face], x + 1, y + 1), weight.x);
  return glm::mix(top, bottom, weight.y);
}

// Linear RGB. An integer image with alpha is RGBD: the color divided by alpha.
io::Image toRadiance(const io::Image& image) {
  const bool rgbd = image.hasAlpha() && image.type != io::PixelType::f32;
  const float smallest = image.type == io::PixelType::u16 ? 1.0f / 65535.0f : 1.0f / 255.0f;
  const io::Image source = io::toChannels(io::toFloat(image), 4);
  io::Image result = io::makeImage(image.width, image.height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  const std::span<const float> from = source.samples<float>();
  const std::span<float> to = result.samples<float>();
  for (std::size_t i = 0; i < image.pixelCount(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      to[3 * i + c] = rgbd ? from[4 * i + c] / std::max(from[4 * i + 3], smallest) : from[4 * i + c];
  return result;
}

quat rotationOf(const tinygltf::Value& light, const std::string& location, Report& report) {
  const vec4 q = vec4Of(light, "rotation", vec4(0, 0, 0, 1));
  const float length = glm::length(q);
  if (length > 0.0f && std::isfinite(length)) return quat(q.w / length, q.x / length, q.y / length, q.z / length);
  report.repaired.push_back(fmt::format("{}/rotation: not a rotation, replaced by none", location));
  return quat(1, 0, 0, 0);
}

std::array<io::Image, 6> decodeFaces(const Document& document, const tinygltf::Value& level,
                                     const std::string& location, Report& report) {
  std::array<io::Image, 6> faces;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto index = static_cast<std::size_t>(level.Get(static_cast<int>(i)).GetNumberAsInt());
    io::Image face = loadImage(document, index, *document.budget).image;
    if (std::string line = repairImage(document, static_cast<int>(index), face); !line.empty())
      report.repaired.push_back(std::move(line));
    faces[i] = toRadiance(face);
    if (faces[i].width != faces[0].width || faces[i].height != faces[0].width)
      document.fail(fmt::format("{}/specularImages/0/{}", location, i),
                    fmt::format("the image has {} x {} pixels; faces must be square and have the same size",
                                faces[i].width, faces[i].height));
  }
  return faces;
}

}  // namespace

io::Image equirectangularFromCube(const std::array<io::Image, 6>& faces, const quat& worldFromLight) {
  const std::uint32_t height = std::min(2 * faces[0].width, kLargestHeight), width = 2 * height;
  io::Image result = io::makeImage(width, height, 3, io::PixelType::f32, io::ColorEncoding::linear);
  const quat lightFromWorld = glm::conjugate(worldFromLight);
  parallelFor(height, [&](std::size_t row) {
    for (std::uint32_t column = 0; column < width; ++column) {
      vec3 sum(0.0f);
      for (const vec2& offset : {vec2(0.25f, 0.25f), vec2(0.75f, 0.25f), vec2(0.25f, 0.75f), vec2(0.75f, 0.75f)}) {
        const float phi = 2.0f * kPi * ((static_cast<float>(column) + offset.x) / static_cast<float>(width) - 0.5f);
        const float theta = kPi * (static_cast<float>(row) + offset.y) / static_cast<float>(height);
        const vec3 world(std::cos(phi) * std::sin(theta), std::cos(theta), std::sin(phi) * std::sin(theta));
        sum += lookUp(faces, lightFromWorld * world);
      }
      const auto pixel = result.pixel<float>(column, static_cast<std::uint32_t>(row));
      for (glm::length_t c = 0; c < 3; ++c) pixel[static_cast<std::size_t>(c)] = 0.25f * sum[c];
    }
  });
  return result;
}

ImageBasedLight readImageBasedLight(const Document& document, int scene, bool replaceMissing, Report& report) {
  ImageBasedLight result;
  const tinygltf::Value* lights = findExtension(document.model.extensions, kImageBasedLights);
  if (!lights || scene == kNone) return result;
  const tinygltf::Value* use =
      findExtension(document.model.scenes[static_cast<std::size_t>(scene)].extensions, kImageBasedLights);
  if (!use) return result;
  result.light = indexOf(*use, "light");
  const tinygltf::Value& light = lights->Get("lights").Get(result.light);
  const std::string location = fmt::format("/extensions/{}/lights/{}", kImageBasedLights, result.light);
  const tinygltf::Value& levels = light.Get("specularImages");
  if (levels.ArrayLen() == 0 || levels.Get(0).ArrayLen() != 6)
    document.fail(location + "/specularImages", "needs at least one level of 6 images");
  for (std::size_t level = 0; level < levels.ArrayLen(); ++level)
    for (std::size_t i = 0; i < levels.Get(static_cast<int>(level)).ArrayLen(); ++i)
      (level == 0 ? result.images : result.prefiltered)
          .insert(levels.Get(static_cast<int>(level)).Get(static_cast<int>(i)).GetNumberAsInt());

  double intensity = numberOf(light, "intensity", 1.0);
  if (intensity < 0.0) {
    report.repaired.push_back(fmt::format("{}/intensity: {} is negative, replaced by 0", location, intensity));
    intensity = 0.0;
  }
  const quat rotation = rotationOf(light, location, report);
  try {
    const std::array<io::Image, 6> faces = decodeFaces(document, levels.Get(0), location, report);
    const std::size_t height = std::min(2 * faces[0].width, kLargestHeight);
    document.budget->take(2 * height * height * 3 * sizeof(float));
    result.environment.image = equirectangularFromCube(faces, rotation);
  } catch (const FileError& error) {
    if (!replaceMissing) throw;
    report.ignored.push_back(
        fmt::format("{}: {}: {}; rendered without this light", location, error.location(), error.problem()));
    return result;
  }
  report.repaired.push_back(fmt::format("{}: cube map converted to an equirectangular image of {} x {} pixels",
                                        location, result.environment.image.width, result.environment.image.height));
  result.environment.name = stringOf(light, "name", "image-based light");
  result.environment.intensity = static_cast<float>(intensity);
  result.environment.present = true;
  return result;
}

}  // namespace quintet::scene
