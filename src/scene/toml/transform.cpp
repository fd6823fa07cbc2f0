// SPDX-License-Identifier: Apache-2.0
#include "scene/toml/transform.h"

#include <fmt/format.h>

#include <random>

#include "scene/animation/keyframes.h"
#include "scene/model/limits.h"

namespace quintet::scene {
namespace {

// ---- Transforms ----

using glm::dmat4;
using glm::dquat;
using glm::dvec3;

vec3 readScale(const TomlReader& reader, const TomlValue& value) {
  const vec3 scale = value.isNumber() ? vec3(reader.toNumber(value, "scale")) : reader.toTriple(value, "scale");
  if (scale.x == 0.0f || scale.y == 0.0f || scale.z == 0.0f)
    reader.fail(value, fmt::format("'scale' of {} must not be 0", reader.what()));
  return scale;
}

// 16 numbers by columns, as in glTF, or 3 or 4 rows of 4 numbers.
mat4 readMatrix(const TomlReader& reader, const TomlValue& value) {
  mat4 m(1.0f);
  const bool rows = value.kind == TomlValue::Kind::array && (value.elements.size() == 3 || value.elements.size() == 4);
  if (rows) {
    for (std::size_t row = 0; row < value.elements.size(); ++row) {
      const std::vector<float> numbers = reader.toNumbers(value.elements[row], "matrix", 4);
      for (std::size_t column = 0; column < 4; ++column) m[column][row] = numbers[column];
    }
  } else {
    const std::vector<float> numbers = reader.toNumbers(value, "matrix", 16);
    for (std::size_t i = 0; i < 16; ++i) m[i / 4][i % 4] = numbers[i];
  }
  if (vec4(m[0].w, m[1].w, m[2].w, m[3].w) != vec4(0, 0, 0, 1))
    reader.fail(value, fmt::format("the last row of 'matrix' of {} must be 0 0 0 1", reader.what()));
  return m;
}

// ---- random and grid ----

// Numbers in [0,1): 32 bits of MT19937 / 2^32. The C++ standard specifies its sequence.
class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}
  double operator()() { return static_cast<double>(generator_()) / 4294967296.0; }

 private:
  std::mt19937 generator_;
};

// Uniform over all rotations (K. Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992).
quat randomRotation(Random& random) {
  const double u = random(), a = 2.0 * glm::pi<double>() * random(), b = 2.0 * glm::pi<double>() * random();
  const double r1 = std::sqrt(1.0 - u), r2 = std::sqrt(u);
  return quat(glm::dquat(r2 * std::cos(b), r1 * std::sin(a), r1 * std::cos(a), r2 * std::sin(b)));
}

// Keys of both random and grid.
struct CommonKeys {
  vec2 sizes{1.0f};  // from, to
  bool turn = false;
  std::vector<int> materials;
};

CommonKeys readCommonKeys(SceneTomlContext& context, TomlReader& reader, const PlacementOptions& options) {
  CommonKeys common;
  common.sizes = vec2(options.size);
  if (const TomlValue* size = reader.find(options.sizeKey)) {
    common.sizes = size->isNumber() ? vec2(reader.toNumber(*size, options.sizeKey, kPositive))
                                    : reader.toPair(*size, options.sizeKey, kPositive);
  }
  if (options.turns) common.turn = reader.boolean("turn");
  if (options.materials) {
    const TomlValue* list = reader.find("materials");
    for (const TomlValue& name : reader.list("materials")) common.materials.push_back(context.findMaterial(name));
    if (list && common.materials.empty()) reader.fail(*list, fmt::format("'materials' of {} is empty", reader.what()));
  }
  return common;
}

// Draws size, rotation and material, in this order.
void drawProperties(Random& random, const CommonKeys& common, Placement& placement) {
  placement.size =
      static_cast<float>(glm::mix(static_cast<double>(common.sizes.x), static_cast<double>(common.sizes.y), random()));
  if (common.turn) placement.rotation = randomRotation(random);
  if (!common.materials.empty())
    placement.material =
        common.materials[static_cast<std::size_t>(random() * static_cast<double>(common.materials.size()))];
}

void addRandom(SceneTomlContext& context, TomlReader& parent, const TomlValue& value, const PlacementOptions& options,
               std::vector<Placement>& result) {
  TomlReader reader(parent.toTable(value, "random"), fmt::format("'random' of {}", parent.what()), context.file);
  const std::uint32_t count = reader.toInteger(reader.require("count"), "count", 1, options.maxCount);
  Random random(reader.integer("seed", 0, 0, 0xFFFFFFFFu));
  const TomlValue& box = reader.require("box");
  if (box.kind != TomlValue::Kind::array || box.elements.size() != 2)
    reader.fail(box, fmt::format("'box' of {} must be [[min x, y, z], [max x, y, z]]", reader.what()));
  const glm::dvec3 low(reader.toTriple(box.elements[0], "box")), high(reader.toTriple(box.elements[1], "box"));
  if (!glm::all(glm::lessThanEqual(low, high)))
    reader.fail(box, fmt::format("'box' of {}: the minimum is above the maximum", reader.what()));
  const CommonKeys common = readCommonKeys(context, reader, options);
  reader.rejectUnknownKeys();
  context.budget.take(count * options.bytesEach);
  result.reserve(result.size() + count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Placement& placement = result.emplace_back();
    const double x = random(), y = random(), z = random();
    placement.center = vec3(glm::mix(low, high, glm::dvec3(x, y, z)));
    drawProperties(random, common, placement);
  }
}

uvec3 readGridCount(const TomlReader& reader, const TomlValue& value, std::uint32_t maxCount) {
  if (value.kind != TomlValue::Kind::array || value.elements.size() != 3)
    reader.fail(value, fmt::format("'count' of {} must be three integers [x, y, z]", reader.what()));
  uvec3 count(1);
  std::uint64_t total = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    count[i] = reader.toInteger(value.elements[i], "count", 1, maxCount);
    total *= count[i];
    if (total > maxCount)
      reader.fail(value, fmt::format("'count' of {}: the product is more than {}", reader.what(), maxCount));
  }
  return count;
}

vec3 numberOrTriple(const TomlReader& reader, const TomlValue& value, const char* name) {
  return value.isNumber() ? vec3(reader.toNumber(value, name)) : reader.toTriple(value, name);
}

void addGrid(SceneTomlContext& context, TomlReader& parent, const TomlValue& value, const PlacementOptions& options,
             std::vector<Placement>& result) {
  TomlReader reader(parent.toTable(value, "grid"), fmt::format("'grid' of {}", parent.what()), context.file);
  const uvec3 count = readGridCount(reader, reader.require("count"), options.maxCount);
  const glm::dvec3 spacing(numberOrTriple(reader, reader.require("spacing"), "spacing"));
  const glm::dvec3 center(reader.triple("center", vec3(0.0f)));
  const TomlValue* jitterValue = reader.find("jitter");
  const glm::dvec3 jitter(jitterValue ? numberOrTriple(reader, *jitterValue, "jitter") : vec3(0.0f));
  const TomlValue* seed = reader.find("seed");
  Random random(seed ? reader.toInteger(*seed, "seed", 0, 0xFFFFFFFFu) : 0);
  const CommonKeys common = readCommonKeys(context, reader, options);
  reader.rejectUnknownKeys();
  context.budget.take(static_cast<std::size_t>(count.x) * count.y * count.z * options.bytesEach);
  const glm::dvec3 first = center - 0.5 * spacing * (glm::dvec3(count) - 1.0);
  std::size_t index = 0;
  for (std::uint32_t z = 0; z < count.z; ++z) {
    for (std::uint32_t y = 0; y < count.y; ++y) {
      for (std::uint32_t x = 0; x < count.x; ++x, ++index) {
        Placement& placement = result.emplace_back();
        const double u = random(), v = random(), w = random();
        placement.center = vec3(first + spacing * glm::dvec3(x, y, z) + jitter * (2.0 * glm::dvec3(u, v, w) - 1.0));
        drawProperties(random, common, placement);
        if (!seed && !common.materials.empty()) placement.material = common.materials[index % common.materials.size()];
      }
    }
  }
}

}  // namespace

quat readRotation(const TomlReader& reader, const TomlValue& value) {
  if (value.kind == TomlValue::Kind::array) {
    const dvec3 angles = glm::radians(dvec3(reader.toTriple(value, "rotate")));
    return quat(glm::angleAxis(angles.z, dvec3(0, 0, 1)) * glm::angleAxis(angles.y, dvec3(0, 1, 0)) *
                glm::angleAxis(angles.x, dvec3(1, 0, 0)));
  }
  TomlReader inner(reader.toTable(value, "rotate"), fmt::format("'rotate' of {}", reader.what()), reader.file());
  quat rotation(1, 0, 0, 0);
  if (const TomlValue* numbers = inner.find("quaternion")) {
    const std::vector<float> n = inner.toNumbers(*numbers, "quaternion", 4);
    const dquat q(static_cast<double>(n[3]), static_cast<double>(n[0]), static_cast<double>(n[1]),
                  static_cast<double>(n[2]));
    if (!(glm::length(q) > 0.0)) inner.fail(*numbers, "the quaternion must not be 0");
    rotation = quat(glm::normalize(q));
  } else {
    const vec3 axis = inner.toDirection(inner.require("axis"), "axis");
    rotation =
        quat(glm::angleAxis(glm::radians(static_cast<double>(inner.toNumber(inner.require("degrees"), "degrees"))),
                            glm::normalize(dvec3(axis))));
  }
  inner.rejectUnknownKeys();
  return rotation;
}

Keyframe readParts(TomlReader& reader, const Keyframe& fallback) {
  Keyframe key = fallback;
  key.translation = reader.triple("translate", fallback.translation);
  if (const TomlValue* rotate = reader.find("rotate")) key.rotation = readRotation(reader, *rotate);
  if (const TomlValue* scale = reader.find("scale")) key.scale = readScale(reader, *scale);
  return key;
}

mat4 readTransform(TomlReader& reader) {
  const Keyframe parts = readParts(reader);
  const TomlValue* matrix = reader.find("matrix");
  if (!matrix) {
    const mat4 m = matrixOf(parts);
    checkInvertible(reader, reader.table(), m);
    return m;
  }
  for (const char* other : {"translate", "rotate", "scale"})
    if (reader.has(other))
      reader.fail(*matrix, fmt::format("'matrix' and '{}' of {} are mutually exclusive", other, reader.what()));
  const mat4 m = readMatrix(reader, *matrix);
  checkInvertible(reader, *matrix, m);
  return m;
}

void checkInvertible(const TomlReader& reader, const TomlValue& at, const mat4& matrix) {
  const dmat4 m(matrix);
  if (!isFinite(matrix) || glm::determinant(glm::dmat3(m)) == 0.0 || !isFinite(mat4(glm::inverse(m))))
    reader.fail(at, fmt::format("the transform of {} has no inverse", reader.what()));
  if (!isWithinLimits(matrix))
    reader.fail(at, fmt::format("{} is too large or too far away: the numbers of its transform can be at most {:g}",
                                reader.what(), kMaxCoordinate));
}

mat4 matrixOf(const Placement& placement) {
  mat4 m = placement.size * glm::mat4_cast(placement.rotation);
  m[3] = vec4(placement.center, 1.0f);
  return m;
}

std::vector<Placement> readPlacements(SceneTomlContext& context, TomlReader& reader, const PlacementOptions& options) {
  std::vector<Placement> result;
  if (const TomlValue* random = reader.find("random")) addRandom(context, reader, *random, options, result);
  if (const TomlValue* grid = reader.find("grid")) addGrid(context, reader, *grid, options, result);
  return result;
}

}  // namespace quintet::scene
