#include "render/emission_map.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "io/color.h"
#include "render/luminance.h"
#include "scene/tangents.h"

namespace quintet::render {
namespace {

// Texels looked at for one triangle: larger ones use a coarser level.
constexpr double kMaxTexels = 4096.0;
// Of blocks that a triangle touches but whose centre it does not contain.
constexpr double kBorderWeight = 0.125;

// Texel values of any type as linear colour.
class TexelReader {
 public:
  explicit TexelReader(const io::Image& image) : image_(image), srgb_(image.encoding == io::ColorEncoding::sRgb) {
    for (std::size_t i = 0; i < bytes_.size(); ++i) bytes_[i] = decode(static_cast<float>(i) / 255.0f);
  }
  vec3 operator()(std::size_t pixel) const {
    const std::size_t first = pixel * image_.channels;
    if (image_.channels < 3) return vec3(sample(first));
    return {sample(first), sample(first + 1), sample(first + 2)};
  }

 private:
  float decode(float v) const { return srgb_ ? io::linearFromSrgb(v) : v; }
  float sample(std::size_t i) const {
    switch (image_.type) {
      case io::PixelType::u8: return bytes_[image_.samples<std::uint8_t>()[i]];
      case io::PixelType::u16: return decode(static_cast<float>(image_.samples<std::uint16_t>()[i]) / 65535.0f);
      case io::PixelType::f32: return decode(image_.samples<float>()[i]);
    }
    return 0.0f;
  }
  const io::Image& image_;
  bool srgb_;
  std::array<float, 256> bytes_{};
};

long wrapped(long i, long size, scene::Wrap wrap) {
  if (wrap == scene::Wrap::clampToEdge) return std::clamp(i, 0L, size - 1);
  const long period = wrap == scene::Wrap::mirroredRepeat ? 2 * size : size;
  const long m = ((i % period) + period) % period;
  return m < size ? m : period - 1 - m;
}

// A triangle in texel coordinates against axis-aligned boxes, by separating axes. Degenerate triangles are
// taken for their bounding box.
struct TexelTriangle {
  std::array<vec2, 3> p;
  std::array<vec2, 3> normal{};  // of the edges, outward; 0: no test

  explicit TexelTriangle(const std::array<vec2, 3>& points) : p(points) {
    const vec2 e1 = p[1] - p[0], e2 = p[2] - p[0];
    const float twiceArea = e1.x * e2.y - e1.y * e2.x;
    if (std::abs(twiceArea) < 1e-6f * (glm::dot(e1, e1) + glm::dot(e2, e2))) return;
    for (std::size_t i = 0; i < 3; ++i) {
      const vec2 edge = p[(i + 1) % 3] - p[i];
      normal[i] = twiceArea > 0.0f ? vec2(edge.y, -edge.x) : vec2(-edge.y, edge.x);
    }
  }
  bool touches(vec2 center, vec2 halfSize) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (glm::dot(normal[i], center - p[i]) > glm::dot(glm::abs(normal[i]), halfSize)) return false;
    return true;
  }
};

}  // namespace

EmissionMap::EmissionMap(const scene::Scene& scene, const scene::Material& material)
    : use_(material.emissiveTexture), factor_(lightLuminance(material.emissive)) {
  if (!use_.used() || factor_ <= 0.0f) return;
  const scene::Texture& texture = scene.textures[use_.texture];
  if (texture.image == scene::kNone) return;
  const io::Image& image = scene.images[texture.image].image;
  if (image.empty()) return;
  sampler_ = texture.sampler;
  levels_.push_back({image.width, image.height, std::vector<float>(image.pixelCount())});
  const TexelReader reader(image);
  parallelFor(image.height, [&](std::size_t y) {
    for (std::size_t i = y * image.width; i < (y + 1) * image.width; ++i)
      levels_[0].luminance[i] = lightLuminance(material.emissive * reader(i));
  });
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.luminance.reserve(static_cast<std::size_t>(coarse.width) * coarse.height);
    for (std::size_t y = 0; y < coarse.height; ++y)
      for (std::size_t x = 0; x < coarse.width; ++x) {
        const std::size_t x1 = std::min<std::size_t>(2 * x + 1, fine.width - 1);
        const std::size_t y0 = 2 * y * fine.width, y1 = std::min<std::size_t>(2 * y + 1, fine.height - 1) * fine.width;
        coarse.luminance.push_back(0.25f * (fine.luminance[y0 + 2 * x] + fine.luminance[y0 + x1] +
                                            fine.luminance[y1 + 2 * x] + fine.luminance[y1 + x1]));
      }
    levels_.push_back(std::move(coarse));
  }
  mean_ = levels_.back().luminance[0];
  factor_ = 0.0f;
}

vec2 EmissionMap::texelPosition(vec2 uv) const {
  return scene::transformUv(use_, uv) * vec2(levels_[0].width, levels_[0].height);
}

float EmissionMap::blockAt(const Level& level, int shift, long x, long y) const {
  const long u = wrapped(x << shift, levels_[0].width, sampler_.wrapU) >> shift;
  const long v = wrapped(y << shift, levels_[0].height, sampler_.wrapV) >> shift;
  return level.luminance[static_cast<std::size_t>(v) * level.width + static_cast<std::size_t>(u)];
}

float EmissionMap::meanOver(vec2 a, vec2 b, vec2 c) const {
  if (levels_.empty()) return factor_;
  const std::array<vec2, 3> points{texelPosition(a), texelPosition(b), texelPosition(c)};
  // A texel shows up to one texel from its centre: half a texel beyond its square.
  const vec2 low = glm::min(glm::min(points[0], points[1]), points[2]) - 0.5f;
  const vec2 high = glm::max(glm::max(points[0], points[1]), points[2]) + 0.5f;
  const vec2 reach = glm::max(glm::abs(low), glm::abs(high));
  if (!(reach.x < 1e8f && reach.y < 1e8f)) return mean_;
  int shift = 0;
  const auto blocks = [&](float length) { return length / std::ldexp(1.0, shift) + 2.0; };
  while (blocks(high.x - low.x) * blocks(high.y - low.y) > kMaxTexels) ++shift;
  if (shift >= static_cast<int>(levels_.size())) return mean_;

  const TexelTriangle triangle(points);
  const Level& level = levels_[shift];
  const float size = std::ldexp(1.0f, shift);
  const vec2 halfSize(0.5f * size + 0.5f);
  double sum = 0.0;
  double weights = 0.0;
  for (long y = std::lround(std::floor(low.y / size)); y <= std::lround(std::floor(high.y / size)); ++y)
    for (long x = std::lround(std::floor(low.x / size)); x <= std::lround(std::floor(high.x / size)); ++x) {
      const vec2 center = size * (vec2(x, y) + 0.5f);
      if (!triangle.touches(center, halfSize)) continue;
      const double weight = triangle.touches(center, vec2(0.0f)) ? 1.0 : kBorderWeight;
      sum += weight * blockAt(level, shift, x, y);
      weights += weight;
    }
  const float result = weights > 0.0 ? static_cast<float>(sum / weights) : mean_;
  // Coarse blocks are not aligned with a repeated texture of odd size: let no bright texel get lost.
  return shift == 0 ? result : std::max(result, 1e-3f * mean_);
}

}  // namespace quintet::render
