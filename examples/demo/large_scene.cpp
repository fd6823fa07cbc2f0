// SPDX-License-Identifier: Apache-2.0
#include "demo/large_scene.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/math.h"
#include "base/parallel.h"
#include "demo/glb_writer.h"
#include "demo/noise.h"
#include "io/codec.h"

namespace quintet::demo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kRowsPerPiece = 64;

// Waves on the unit sphere: radius 1 + Σ amplitude · sin(frequency · p + phase).
struct Wave {
  vec3 frequency;
  float amplitude, phase;
};

const std::array<Wave, 12>& waves() {
  static const std::array<Wave, 12> kWaves = [] {
    std::array<Wave, 12> result;
    Random random(7);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const float size = 3.0f * std::pow(1.7f, static_cast<float>(i));
      const vec3 direction(random(-1, 1), random(-1, 1), random(-1, 1));
      result[i] = {size * direction, 0.1f / size, random(0, 6.28f)};
    }
    return result;
  }();
  return kWaves;
}

struct Point {
  vec3 position, normal;
  vec2 uv;
};

Point surface(vec2 uv) {
  const float theta = kPi * uv.y, phi = 2.0f * kPi * uv.x;
  const vec3 direction(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
  float radius = 1.0f;
  vec3 gradient(0.0f);
  for (const Wave& wave : waves()) {
    const float angle = glm::dot(wave.frequency, direction) + wave.phase;
    radius += wave.amplitude * std::sin(angle);
    gradient += wave.amplitude * std::cos(angle) * wave.frequency;
  }
  const vec3 alongSphere = gradient - glm::dot(gradient, direction) * direction;
  return {radius * direction, glm::normalize(direction - alongSphere / radius), 8.0f * uv};
}

// One mesh: the quads between two meridians.
struct Patch {
  std::size_t rows, columns;
  float firstU, lastU;
  std::size_t rowVertices() const { return columns + 1; }
  std::size_t vertexCount() const { return (rows + 1) * rowVertices(); }
  std::size_t triangleCount() const { return 2 * rows * columns; }
  Point at(std::size_t row, std::size_t column) const {
    const float u = static_cast<float>(column) / static_cast<float>(columns);
    return surface({firstU + u * (lastU - firstU), static_cast<float>(row) / static_cast<float>(rows)});
  }
};

class Writer {
 public:
  Writer(const std::filesystem::path& file, std::size_t jsonBytes) : file_(file), jsonBytes_((jsonBytes + 3) / 4 * 4) {
    out_.open(file, std::ios::binary | std::ios::trunc);
    if (!out_) fail();
    out_.seekp(static_cast<std::streamoff>(binaryStart()));
  }

  int beginView() {
    static constexpr std::array<char, 4> kZeros{};
    write(std::as_bytes(std::span(kZeros).first((4 - size_ % 4) % 4)));
    viewStart_ = size_;
    return static_cast<int>(views_.size());
  }
  void write(std::span<const std::byte> bytes) {
    out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    size_ += bytes.size();
  }
  void endView(int target) {
    Json view{{"buffer", 0}, {"byteOffset", viewStart_}, {"byteLength", size_ - viewStart_}};
    if (target != 0) view["target"] = target;
    views_.push_back(std::move(view));
  }

  // Writes the header and the JSON, padded to the reserved size.
  void finish(Json root) {
    beginView();  // adds padding
    root["bufferViews"] = std::move(views_);
    root["buffers"] = Json::array({{{"byteLength", size_}}});
    std::string text = root.dump();
    const std::size_t total = binaryStart() + size_;
    if (text.size() > jsonBytes_ || total > 0xFFFFFFFFu)
      throw UsageError(fmt::format("{}: {} bytes exceed the limit of a GLB (4 GiB)", file_.string(), total));
    text.resize(jsonBytes_, ' ');
    out_.seekp(0);
    word(0x46546C67u), word(2), word(total);  // "glTF", version, length
    word(jsonBytes_), out_.write("JSON", 4);
    out_.write(text.data(), static_cast<std::streamsize>(text.size()));
    word(size_), out_.write("BIN\0", 4);
    out_.close();
    if (!out_) fail();
  }

 private:
  std::size_t binaryStart() const { return 12 + 8 + jsonBytes_ + 8; }
  void word(std::size_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) out_.put(static_cast<char>((value >> shift) & 255u));
  }
  [[noreturn]] void fail() const {
    throw FileError(file_, "cannot be written: " + std::generic_category().message(errno));
  }

  std::filesystem::path file_;
  std::size_t jsonBytes_;
  std::ofstream out_;
  Json views_ = Json::array();
  std::size_t size_ = 0, viewStart_ = 0;
};

// Writes `count` rows of elements in pieces. element(row, out) computes a row; the rows of a piece are computed in
// parallel.
template <class T, class Row>
int writeRows(Writer& writer, std::size_t count, std::size_t perRow, int target, const Row& row) {
  const int view = writer.beginView();
  std::vector<T> piece;
  for (std::size_t first = 0; first < count; first += kRowsPerPiece) {
    const std::size_t rows = std::min(kRowsPerPiece, count - first);
    piece.resize(rows * perRow);
    parallelFor(rows, [&](std::size_t r) { row(first + r, std::span(piece).subspan(r * perRow, perRow)); });
    writer.write(std::as_bytes(std::span<const T>(piece)));
  }
  writer.endView(target);
  return view;
}

int addAccessor(Json& root, int view, const char* type, int componentType, std::size_t count) {
  root["accessors"].push_back(
      {{"bufferView", view}, {"componentType", componentType}, {"count", count}, {"type", type}});
  return static_cast<int>(root["accessors"].size()) - 1;
}

Json addPatch(Json& root, Writer& writer, const Patch& patch) {
  const std::size_t rows = patch.rows + 1, width = patch.rowVertices(), count = patch.vertexCount();
  std::vector<Bounds3> boxes(rows);
  const auto points = [&](auto T, const auto& member) {
    using Element = decltype(T);
    return writeRows<Element>(writer, rows, width, kArrayBuffer, [&](std::size_t row, std::span<Element> out) {
      for (std::size_t c = 0; c < width; ++c) out[c] = member(row, patch.at(row, c));
    });
  };
  const int positions = addAccessor(root,
                                    points(vec3(),
                                           [&](std::size_t row, const Point& p) {
                                             boxes[row].extend(p.position);
                                             return p.position;
                                           }),
                                    "VEC3", kFloat, count);
  Bounds3 box;
  for (const Bounds3& b : boxes) box.extend(b);
  root["accessors"].back()["min"] = {box.min.x, box.min.y, box.min.z};
  root["accessors"].back()["max"] = {box.max.x, box.max.y, box.max.z};
  const int normals =
      addAccessor(root, points(vec3(), [](std::size_t, const Point& p) { return p.normal; }), "VEC3", kFloat, count);
  const int uvs =
      addAccessor(root, points(vec2(), [](std::size_t, const Point& p) { return p.uv; }), "VEC2", kFloat, count);
  const int indices = writeRows<uvec3>(
      writer, patch.rows, 2 * patch.columns, kElementArrayBuffer, [&](std::size_t row, std::span<uvec3> out) {
        for (std::size_t c = 0; c < patch.columns; ++c) {
          const auto a = static_cast<std::uint32_t>(row * width + c), b = static_cast<std::uint32_t>(a + width);
          out[2 * c] = {a, b, b + 1};
          out[2 * c + 1] = {a, b + 1, a + 1};
        }
      });
  Json primitive{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}},
                 {"indices", addAccessor(root, indices, "SCALAR", kUnsignedInt, 3 * patch.triangleCount())}};
  return primitive;
}

io::Image makeTexture(std::uint32_t size, std::uint32_t seed, bool normalMap) {
  io::Image image = io::makeImage(size, size, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  const auto pixels = image.samples<std::uint8_t>();
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const float angle = 40.0f * (static_cast<float>(x) + 3.0f * static_cast<float>(y)) / static_cast<float>(size);
      const float wave = 0.5f + 0.4f * std::sin(angle + static_cast<float>(seed)), grain = 0.1f * hash01(x, y, 0, seed);
      const vec3 value = normalMap ? vec3(0.4f + 0.2f * wave, 0.5f + grain, 0.98f)
                                   : vec3(wave + grain, 0.9f - 0.5f * wave, 0.3f + grain);
      for (std::size_t c = 0; c < 3; ++c)
        pixels[3 * (std::size_t{y} * size + x) + c] =
            static_cast<std::uint8_t>(255.0f * std::clamp(value[c], 0.0f, 1.0f));
    }
  }
  return image;
}

void addTextures(Json& root, Writer& writer, const LargeSceneOptions& options) {
  const std::size_t perMaterial = options.normalMaps ? 2 : 1;
  std::vector<std::vector<std::byte>> files(std::size_t{options.textures} * perMaterial);
  parallelFor(files.size(), [&](std::size_t i) {
    const auto seed = static_cast<std::uint32_t>(i / perMaterial);
    files[i] = io::encodePng(makeTexture(options.textureSize, seed, i % perMaterial == 1));
  });
  for (std::size_t i = 0; i < files.size(); ++i) {
    const int view = writer.beginView();
    writer.write(files[i]);
    writer.endView(0);
    root["images"].push_back({{"mimeType", "image/png"}, {"bufferView", view}});
    root["textures"].push_back({{"source", i}});
  }
  for (std::size_t k = 0; k < std::max<std::size_t>(options.textures, 1); ++k) {
    Json material{{"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}}};
    if (options.textures > 0) {
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", k * perMaterial}};
      if (options.normalMaps) material["normalTexture"] = {{"index", k * perMaterial + 1}};
    }
    root["materials"].push_back(std::move(material));
  }
}

}  // namespace

std::uint64_t writeLargeScene(const std::filesystem::path& file, const LargeSceneOptions& options) {
  const std::uint32_t meshes = std::max(options.meshes, 1u);
  const double rows = std::max(2.0, std::round(std::sqrt(static_cast<double>(options.triangles) / 4.0)));
  const double columns = std::max(2.0, std::round(static_cast<double>(options.triangles) / (2.0 * rows * meshes)));
  Writer writer(file, 4096 + std::size_t{1024} * meshes + std::size_t{512} * options.textures);
  Json root{{"asset", {{"version", "2.0"}, {"generator", "Quintet"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", Json::array()}}}}};
  addTextures(root, writer, options);
  std::uint64_t triangles = 0;
  for (std::uint32_t i = 0; i < meshes; ++i) {
    const Patch patch{static_cast<std::size_t>(rows), static_cast<std::size_t>(columns),
                      static_cast<float>(i) / static_cast<float>(meshes),
                      static_cast<float>(i + 1) / static_cast<float>(meshes)};
    Json primitive = addPatch(root, writer, patch);
    primitive["material"] = i % std::max(options.textures, 1u);
    root["meshes"].push_back({{"name", fmt::format("patch {}", i)}, {"primitives", {std::move(primitive)}}});
    root["nodes"].push_back({{"mesh", i}});
    root["scenes"][0]["nodes"].push_back(i);
    triangles += patch.triangleCount();
  }
  writer.finish(std::move(root));
  return triangles;
}

}  // namespace quintet::demo
