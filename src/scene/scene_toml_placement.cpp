#include "scene/scene_toml_placement.h"

#include <fmt/format.h>

#include <random>

namespace quintet::scene {
namespace {

// Numbers in [0,1): the 32 bits of MT19937 (whose sequence the C++ standard fixes) / 2^32.
class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}
  double operator()() { return static_cast<double>(generator_()) / 4294967296.0; }

 private:
  std::mt19937 generator_;
};

// Uniform over all rotations: K. Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992.
quat randomTurn(Random& random) {
  const double u = random(), a = 2.0 * glm::pi<double>() * random(), b = 2.0 * glm::pi<double>() * random();
  const double r1 = std::sqrt(1.0 - u), r2 = std::sqrt(u);
  return quat(glm::dquat(r2 * std::cos(b), r1 * std::sin(a), r1 * std::cos(a), r2 * std::sin(b)));
}

// What random and grid have in common.
struct Common {
  vec2 sizes{1.0f};  // from, to
  bool turn = false;
  std::vector<int> materials;
};

Common readCommon(SceneTomlContext& context, TomlReader& reader, const PlacementOptions& options) {
  Common common;
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

// The numbers are drawn in this order.
void drawRest(Random& random, const Common& common, Placement& placement) {
  placement.size =
      static_cast<float>(glm::mix(static_cast<double>(common.sizes.x), static_cast<double>(common.sizes.y), random()));
  if (common.turn) placement.turn = randomTurn(random);
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
    reader.fail(box, fmt::format("'box' of {}: its minimum is above its maximum", reader.what()));
  const Common common = readCommon(context, reader, options);
  reader.finish();
  context.budget.take(count * options.bytesEach);
  result.reserve(result.size() + count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Placement& placement = result.emplace_back();
    const double x = random(), y = random(), z = random();
    placement.center = vec3(glm::mix(low, high, glm::dvec3(x, y, z)));
    drawRest(random, common, placement);
  }
}

uvec3 readGridCount(const TomlReader& reader, const TomlValue& value, std::uint32_t maxCount) {
  if (value.kind != TomlValue::Kind::array || value.elements.size() != 3)
    reader.fail(value, fmt::format("'count' of {} must be three whole numbers [x, y, z]", reader.what()));
  uvec3 count(1);
  std::uint64_t total = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    count[i] = reader.toInteger(value.elements[i], "count", 1, maxCount);
    total *= count[i];
    if (total > maxCount)
      reader.fail(value, fmt::format("'count' of {}: more than {} in all", reader.what(), maxCount));
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
  const Common common = readCommon(context, reader, options);
  reader.finish();
  context.budget.take(static_cast<std::size_t>(count.x) * count.y * count.z * options.bytesEach);
  const glm::dvec3 first = center - 0.5 * spacing * (glm::dvec3(count) - 1.0);
  std::size_t index = 0;
  for (std::uint32_t z = 0; z < count.z; ++z) {
    for (std::uint32_t y = 0; y < count.y; ++y) {
      for (std::uint32_t x = 0; x < count.x; ++x, ++index) {
        Placement& placement = result.emplace_back();
        const double u = random(), v = random(), w = random();
        placement.center = vec3(first + spacing * glm::dvec3(x, y, z) + jitter * (2.0 * glm::dvec3(u, v, w) - 1.0));
        drawRest(random, common, placement);
        if (!seed && !common.materials.empty()) placement.material = common.materials[index % common.materials.size()];
      }
    }
  }
}

}  // namespace

mat4 matrixOf(const Placement& placement) {
  mat4 m = placement.size * glm::mat4_cast(placement.turn);
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
