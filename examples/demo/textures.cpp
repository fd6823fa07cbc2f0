// SPDX-License-Identifier: Apache-2.0
#include "demo/textures.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "demo/noise.h"
#include "io/color.h"

namespace quintet::demo {
namespace {

using io::ColorEncoding;
using io::PixelType;

std::uint8_t unitByte(float x) { return static_cast<std::uint8_t>(std::lround(255.0f * glm::clamp(x, 0.0f, 1.0f))); }

// Position within the board of a herringbone pattern: `along` and `across` in board widths.
struct Board {
  float along = 0.0f, across = 0.0f;
  std::uint32_t id = 0;
};

// Boards are `n` cells long. In each row of cells, the first n of every 2n cells belong to one horizontal board, the
// others to n vertical boards. Each row is shifted by one cell. The pattern repeats after 2n cells in both directions.
Board herringbone(float x, float y, int n, int cells) {
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const int k = (((i - j) % (2 * n)) + 2 * n) % (2 * n);
  const bool horizontal = k < n;
  const int startX = horizontal ? i - k : i, startY = horizontal ? j : j - (2 * n - 1 - k);
  const auto wrapped = [&](int c) { return static_cast<std::uint32_t>(((c % cells) + cells) % cells); };
  const float dx = x - static_cast<float>(startX), dy = y - static_cast<float>(startY);
  return {horizontal ? dx : dy, horizontal ? dy : dx,
          1u + wrapped(startX) * 1024u + wrapped(startY) * 2u + (horizontal ? 1u : 0u)};
}

Texel oakBoard(const Board& board, float length) {
  const auto random = [&](std::uint32_t k) { return hash01(board.id, k, 0, 11); };
  // The board is cut from a log: the perturbed distance from the pith gives the growth rings.
  const vec3 seed(17.0f * random(0), 31.0f * random(1), 13.0f * random(2));
  const vec3 p = vec3(0.35f * board.along, 1.3f * board.across, 0.0f) + seed;
  const float bow = (random(3) - 0.5f) * 0.25f * (board.along - 0.5f * length * (0.4f + 1.2f * random(4)));
  const float distance = board.across + bow * bow * 1.5f + 0.22f * fbm(p, 3, 5) + (random(5) - 0.3f) * 2.0f;
  const float ring = distance * (5.0f + 5.0f * random(6));
  const float phase = ring - std::floor(ring);
  const float late = glm::smoothstep(0.15f, 0.85f, phase) * (1.0f - glm::smoothstep(0.9f, 1.0f, phase));
  const float fiber = fbm(vec3(1.6f * board.along, 34.0f * board.across, 0.0f) + seed, 3, 21);
  const float pores =
      glm::smoothstep(0.28f, 0.5f, noise(vec3(3.0f * board.along, 46.0f * board.across, 5.0f) + seed, 29));

  const vec3 early(0.60f, 0.405f, 0.240f), dark(0.44f, 0.275f, 0.150f);
  vec3 color = glm::mix(early, dark, 0.62f * late + 0.30f * fiber);
  color *= (0.80f + 0.36f * random(7)) * (1.0f - 0.22f * pores);
  color = glm::mix(color, vec3(glm::dot(color, vec3(0.33f))), 0.15f * random(8));
  return {glm::clamp(color, 0.02f, 0.9f), 0.52f + 0.08f * late + 0.10f * fiber + 0.12f * pores, 0.0f,
          -6e-5f * pores - 2e-5f * late + 2e-5f * fiber};
}

}  // namespace

SurfaceMaps bake(std::uint32_t size, float metersPerTile, const std::function<Texel(float, float)>& texel) {
  SurfaceMaps maps{io::makeImage(size, size, 3, PixelType::u8, ColorEncoding::sRgb),
                   io::makeImage(size, size, 3, PixelType::u8, ColorEncoding::linear),
                   io::makeImage(size, size, 3, PixelType::u8, ColorEncoding::linear)};
  std::vector<float> heights(maps.baseColor.pixelCount());
  const float step = 1.0f / static_cast<float>(size);
  parallelFor(size, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < size; ++x) {
      const Texel t = texel((static_cast<float>(x) + 0.5f) * step, (static_cast<float>(y) + 0.5f) * step);
      const auto color = maps.baseColor.pixel<std::uint8_t>(x, y);
      for (unsigned c = 0; c < 3; ++c) color[c] = io::byteFromUnit(io::srgbFromLinear(t.color[c]));
      const auto rough = maps.metallicRoughness.pixel<std::uint8_t>(x, y);
      rough[0] = 255;
      rough[1] = unitByte(t.roughness);
      rough[2] = unitByte(t.metallic);
      heights[row * size + x] = t.height;
    }
  });
  const float perTexel = 0.5f * static_cast<float>(size) / metersPerTile;
  parallelFor(size, [&](std::size_t row) {
    const std::size_t above = (row + size - 1) % size * size, below = (row + 1) % size * size, here = row * size;
    for (std::uint32_t x = 0; x < size; ++x) {
      const std::size_t left = (x + size - 1) % size, right = (x + 1) % size;
      const float dx = (heights[here + right] - heights[here + left]) * perTexel;
      const float dy = (heights[above + x] - heights[below + x]) * perTexel;  // y is up, rows run down
      const vec3 n = glm::normalize(vec3(-dx, -dy, 1.0f));
      const auto pixel = maps.normal.pixel<std::uint8_t>(x, static_cast<std::uint32_t>(row));
      for (unsigned c = 0; c < 3; ++c) pixel[c] = unitByte(0.5f * n[c] + 0.5f);
    }
  });
  return maps;
}

SurfaceMaps oakHerringbone(std::uint32_t size) {
  constexpr int kCells = 20, kBoardLength = 5;
  return bake(size, kOakTile, [](float u, float v) {
    const Board board = herringbone(u * kCells, v * kCells, kBoardLength, kCells);
    const float length = kBoardLength;
    Texel t = oakBoard(board, length);
    // A narrow gap between boards with rounded edges.
    const float edge = std::min({board.across, 1.0f - board.across, board.along, length - board.along});
    const float gap = 1.0f - glm::smoothstep(0.008f, 0.020f, edge);
    const float shoulder = 1.0f - glm::smoothstep(0.0f, 0.045f, edge);
    t.color = glm::mix(t.color, vec3(0.045f, 0.028f, 0.018f), 0.85f * gap);
    t.roughness = glm::mix(t.roughness, 0.9f, gap);
    t.height -= 0.0005f * shoulder * shoulder;
    return t;
  });
}

SurfaceMaps marble(std::uint32_t size) {
  return bake(size, kMarbleTile, [](float u, float v) {
    constexpr int kPeriod = 4;
    const auto field = [](vec3 p, int octaves, std::uint32_t seed, int scale) {
      return fbm(p * static_cast<float>(scale), octaves, seed, glm::ivec3(kPeriod * scale, kPeriod * scale, 0));
    };
    const vec3 p(u * kPeriod, v * kPeriod, 0.0f);
    const vec3 warp(field(p, 4, 41, 1), field(p, 4, 42, 1), 0.0f);
    const vec3 q = p + 1.1f * warp;
    // Veins are at the zero crossings of a smooth field; a second field is their strength.
    const float wide = std::exp(-12.0f * std::abs(field(q, 5, 43, 1)));
    const float fine = std::exp(-34.0f * std::abs(field(q + 0.3f * warp, 4, 47, 2)));
    const float where = glm::smoothstep(-0.15f, 0.15f, field(p, 3, 53, 1));
    const float clouds = 0.5f + 0.9f * field(q, 5, 59, 1);
    const float grain = field(p, 2, 61, 48);

    vec3 color =
        glm::mix(vec3(0.82f, 0.795f, 0.755f), vec3(0.68f, 0.67f, 0.66f), glm::clamp(0.55f * clouds, 0.0f, 1.0f));
    color = glm::mix(color, vec3(0.26f, 0.27f, 0.295f), 0.95f * wide * where);
    color = glm::mix(color, vec3(0.42f, 0.385f, 0.34f), 0.80f * fine * (0.35f + 0.65f * where));
    color *= 1.0f + 0.03f * grain;
    return Texel{color, 0.48f + 0.10f * wide * where + 0.05f * fine, 0.0f, 0.0f};
  });
}

SurfaceMaps brushedMetal(std::uint32_t size, float roughness) {
  return bake(size, 0.2f, [=](float u, float v) {
    const glm::ivec3 coarse(2, 96, 0), finest(6, 400, 0);
    const float a = fbm(vec3(u, v, 0.0f) * vec3(coarse), 3, 71, coarse);
    const float b = noise(vec3(u, v, 0.0f) * vec3(finest), 83, finest);
    return Texel{vec3(0.96f + 0.06f * a), roughness + 0.10f * a + 0.06f * b, 1.0f, 1.1e-5f * a + 4e-6f * b};
  });
}

io::Image leafCutout(std::uint32_t size) {
  io::Image image = io::makeImage(size, size, 4, PixelType::u8, ColorEncoding::sRgb);
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const float s = (static_cast<float>(y) + 0.5f) / static_cast<float>(size);
      const float t = 2.0f * (static_cast<float>(x) + 0.5f) / static_cast<float>(size) - 1.0f;
      const float teeth = 0.05f * std::abs(std::sin(40.0f * s));
      const float inside = 0.9f * std::pow(std::sin(kPi * std::pow(s, 0.7f)), 0.8f) - teeth - std::abs(t);
      const float vein = std::exp(-40.0f * std::abs(t)) +
                         0.5f * std::exp(-20.0f * std::abs(std::sin(18.0f * (s - 0.5f * std::abs(t)))));
      const vec3 color = glm::mix(vec3(0.10f, 0.24f, 0.05f), vec3(0.30f, 0.42f, 0.14f), std::min(vein, 1.0f));
      const auto pixel = image.pixel<std::uint8_t>(x, y);
      for (unsigned c = 0; c < 3; ++c) pixel[c] = io::byteFromUnit(io::srgbFromLinear(color[c]));
      pixel[3] = unitByte(0.5f + 20.0f * inside);
    }
  }
  return image;
}

}  // namespace quintet::demo
