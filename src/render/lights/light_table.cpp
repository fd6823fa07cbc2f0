// SPDX-License-Identifier: Apache-2.0
#include "render/lights/light_table.h"

#include <array>
#include <bit>
#include <limits>
#include <numeric>

#include "render/lights/alias_table.h"
#include "render/lights/luminance.h"
#include "scene/animation/keyframes.h"
#include "scene/model/limits.h"

namespace quintet::render {
namespace {

constexpr double kPiDouble = glm::pi<double>();

// The classes that share the samples (kMinimumClassShare).
enum class LightClass { local, directional, surfaces, environment };

LightClass classOf(const shared::LightData& light) {
  switch (light.type) {
    case shared::kLightDirectional: return LightClass::directional;
    case shared::kLightTriangle:
    case shared::kLightSolid: return LightClass::surfaces;
    case shared::kLightEnvironment: return LightClass::environment;
    default: return LightClass::local;
  }
}

// Sets the weights to the powers, scaled so that each class gets its share.
void setWeights(std::vector<float>& weights, const std::vector<shared::LightData>& lights,
                const std::vector<double>& powers) {
  std::array<double, 4> sums{};
  for (std::size_t i = 0; i < powers.size(); ++i)
    sums[static_cast<std::size_t>(classOf(lights[i]))] += std::isfinite(powers[i]) ? powers[i] : 0.0;
  const double total = std::accumulate(sums.begin(), sums.end(), 0.0);
  const auto present = static_cast<double>(std::ranges::count_if(sums, [](double s) { return s > 0.0; }));
  std::array<double, 4> factors{};
  for (std::size_t c = 0; c < sums.size(); ++c)
    if (sums[c] > 0.0)
      factors[c] = (kMinimumClassShare + (1.0 - kMinimumClassShare * present) * (sums[c] / total)) / sums[c];
  weights.resize(powers.size());
  for (std::size_t i = 0; i < powers.size(); ++i)
    weights[i] = static_cast<float>(powers[i] * factors[static_cast<std::size_t>(classOf(lights[i]))]);
}

LightReach reachOf(const shared::LightData& light) {
  if (light.type == shared::kLightEnvironment) return LightReach::environment;
  return light.type == shared::kLightDirectional ? LightReach::directional : LightReach::finite;
}

}  // namespace

// Collects the lights with their powers and bounds, one of each per light.
struct LightTableBuilder::Collector {
  double crossSection;
  LightTable& table;
  Scratch& scratch;
  std::vector<double>& powers = scratch.powers;
  std::vector<LightTreeInput>& bounds = scratch.bounds;
  std::size_t next = 0;  // light to add

  // Every element is written afterwards.
  void resize(std::size_t count) {
    table.lights.resize(count);
    powers.resize(count);
    bounds.resize(count);
  }

  void add(const shared::LightData& light, double power, const LightBounds& lightBounds) {
    bounds[next] = {lightBounds, static_cast<std::uint32_t>(next), reachOf(light)};
    table.lights[next] = light;
    powers[next++] = power;
  }

  void addPunctual(const scene::Light& light) {
    shared::LightData data{};
    data.intensity = light.intensity;
    data.position = light.position;
    data.direction = light.direction;
    data.cosInner = std::cos(light.innerConeAngle);
    data.cosOuter = std::cos(light.outerConeAngle);
    if (light.type != scene::LightType::directional) data.geometry = std::bit_cast<shared::uint>(1.0f / light.range);
    const double luminance = lightLuminance(light.intensity);
    switch (light.type) {
      case scene::LightType::point:
        data.type = shared::kLightPoint;
        return add(data, 4.0 * kPiDouble * luminance, pointBounds(light.position, luminance));
      case scene::LightType::spot:
        data.type = shared::kLightSpot;
        return add(data, luminance * spotSolidAngle(data.cosInner, data.cosOuter),
                   spotBounds(light.position, light.direction, light.innerConeAngle, light.outerConeAngle, luminance));
      case scene::LightType::directional:
        data.type = shared::kLightDirectional;
        return add(data, luminance * crossSection, directionalBounds(light.direction, luminance));
    }
  }

  // Adds the triangles and solids of all parts. Instances can be small, so one loop visits the lights of all.
  void addParts(const std::vector<Part>& parts, const Emitters& emitters, std::span<const mat4> worldFromObject) {
    std::vector<std::size_t> firsts;  // light of triangle or solid 0 of each part
    const std::size_t begin = next;
    for (const Part& part : parts) {
      table.slots[part.slot] = static_cast<std::uint32_t>(next);
      firsts.push_back(next);
      next += part.count;
    }
    const auto fill = [&](std::size_t first, std::size_t last) {
      first += begin, last += begin;
      auto p = static_cast<std::size_t>(std::ranges::upper_bound(firsts, first) - firsts.begin()) - 1;
      for (; first < last; ++p) {
        const std::size_t end = std::min(last, firsts[p] + parts[p].count);
        const Emitter& emitter = emitters.of(parts[p].mesh, parts[p].geometry);
        fillPart(parts[p], emitter, worldFromObject[parts[p].instance], firsts[p], first, end);
        first = end;
      }
    };
    parallelRanges(next - begin, fill, 4096);
  }

  // Fills the lights from `first` up to `end`; `zero` is the light of the part's triangle or solid 0.
  void fillPart(const Part& part, const Emitter& emitter, const mat4& worldFromObject, std::size_t zero,
                std::size_t first, std::size_t end) {
    shared::LightData light{};
    light.type = emitter.solids ? shared::kLightSolid : shared::kLightTriangle;
    light.instance = static_cast<shared::uint>(part.instance);
    light.geometry = static_cast<shared::uint>(part.geometry);
    for (std::size_t i = first; i < end; ++i) {
      light.primitive = static_cast<shared::uint>(i - zero);
      table.lights[i] = light;
      powers[i] = 0.0;
      bounds[i] = {LightBounds{}, static_cast<std::uint32_t>(i)};
      const double luminance = emitter.luminance[i - zero];
      const double area = luminance > 0.0 ? emitterArea(emitter, i - zero, worldFromObject) : 0.0;
      if (!(area > 0.0)) continue;
      powers[i] = kPiDouble * area * luminance;
      bounds[i].bounds = emitterBounds(emitter, i - zero, worldFromObject, area * luminance);
    }
  }

  // Builds the alias table and the tree. Both sample the same lights, which are those with a weight above 0.
  void finish() {
    std::vector<float>& weights = scratch.weights;
    setWeights(weights, table.lights, powers);
    table.entries = buildAliasTable(weights);
    double total = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (!(weights[i] > 0.0f)) bounds[i].bounds.intensity = 0.0f;
      bounds[i].bounds.intensity = std::min(bounds[i].bounds.intensity, std::numeric_limits<float>::max());
      total += bounds[i].bounds.intensity;
    }
    for (LightTreeInput& input : bounds)
      if (input.bounds.intensity > 0.0f)
        input.bounds.intensity = std::max(static_cast<float>(input.bounds.intensity / total), 1e-30f);
    scratch.tree.nodes.swap(table.nodes);
    scratch.tree.build(bounds, table.lights.size());
    scratch.tree.nodes.swap(table.nodes);
    for (std::size_t i = 0; i < table.lights.size(); ++i) table.lights[i].leaf = scratch.tree.leaves[i];
  }
};

LightTableBuilder::LightTableBuilder(const scene::Scene& scene, const scene::Environment& environment,
                                     std::size_t maxTriangleLights)
    : punctual_(scene.lights),
      emitters_(scene),
      environment_(buildEnvironmentTable(environment)),
      maxTriangleLights_(maxTriangleLights),
      environmentIntegral_(environment_.width > 0 ? environment_.integral : 0.0) {
  const Bounds3 bounds = scene::worldBounds(scene);
  scene::checkExtent(scene, bounds);
  const double radius = bounds.empty() ? 0.0 : 0.5 * glm::length(glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
  crossSection_ = kPiDouble * (radius > 0.0 && std::isfinite(radius) ? radius * radius : 1.0);
  addParts(scene);
}

bool LightTableBuilder::setEmission(const scene::Scene& scene) {
  if (!emitters_.update(scene)) return false;
  parts_.clear();
  slots_.clear();
  firstSlots_.clear();
  addParts(scene);
  return true;
}

void LightTableBuilder::addParts(const scene::Scene& scene) {
  std::size_t total = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const int mesh = scene.instances[i].mesh;
    const bool visible = (scene.instances[i].mask & 0xFFu) != 0;  // with mask 0 no ray hits the instance
    firstSlots_.push_back(static_cast<std::uint32_t>(slots_.size()));
    if (mesh == scene::kNone) continue;
    const auto m = static_cast<std::size_t>(mesh);
    for (std::size_t g = 0; g < scene.meshes[m].geometryCount(); ++g) {
      const Emitter& emitter = emitters_.of(m, g);
      if (visible && !emitter.black) parts_.push_back({i, g, slots_.size(), m, emitter.count()});
      slots_.push_back(shared::kNoLight);
    }
  }
  for (const Part& part : parts_) total += part.count;
  if (total > maxTriangleLights_) {
    std::ranges::stable_sort(parts_, {}, &Part::count);
    std::size_t kept = 0;
    total = 0;
    while (total + parts_[kept].count <= maxTriangleLights_) total += parts_[kept++].count;
    parts_.resize(kept);
  }
  lit_.assign(scene.instances.size(), false);
  for (const Part& part : parts_) lit_[part.instance] = true;
  const auto moves = [&](const Part& part) {
    return scene.instances[part.instance].animated() || scene.meshes[part.mesh].deformation;
  };
  hasMovingLights_ = std::ranges::any_of(parts_, moves) || std::ranges::any_of(scene.lights, &scene::Light::animated);
}

void LightTableBuilder::build(std::span<const mat4> worldFromObject, LightTable& table) {
  table.slots = slots_;
  table.firstSlots = firstSlots_;
  table.environmentLight = shared::kNoLight;
  Collector collector{crossSection_, table, scratch_};
  std::size_t count = punctual_.size() + (environmentIntegral_ > 0.0 ? 1 : 0);
  for (const Part& part : parts_) count += part.count;
  collector.resize(count);
  for (const scene::Light& light : punctual_) collector.addPunctual(light);
  collector.addParts(parts_, emitters_, worldFromObject);
  if (environmentIntegral_ > 0.0) {
    table.environmentLight = static_cast<std::uint32_t>(count - 1);
    shared::LightData light{};
    light.type = shared::kLightEnvironment;
    collector.add(light, environmentIntegral_ * crossSection_, environmentBounds(0.25 * environmentIntegral_));
  }
  collector.finish();
  if (table.lights.size() > kKeptLights) scratch_ = {};
}

double spotSolidAngle(double cosInner, double cosOuter) {
  // The integral ∫ 2π a dc of the attenuation a, which is ((c - cosOuter) / width)² until it or c reaches 1, and then
  // 1.
  const double width = std::max(0.001, cosInner - cosOuter);
  const double ramp = std::min(width, 1.0 - cosOuter);
  return 2.0 * kPiDouble * (ramp * ramp * ramp / (3.0 * width * width) + (1.0 - cosOuter - ramp));
}

void LightTable::clear() {
  lights.clear();
  std::ranges::fill(slots, shared::kNoLight);
  environmentLight = shared::kNoLight;
}

LightTable buildLightTable(const scene::Scene& scene, const scene::Environment& environmentInUse,
                           std::size_t maxTriangleLights) {
  LightTableBuilder builder(scene, environmentInUse, maxTriangleLights);
  std::vector<mat4> worldFromObject;
  for (const scene::Instance& instance : scene.instances)
    worldFromObject.push_back(scene::worldFromObjectAt(instance, 0.0f));
  LightTable table;
  builder.build(worldFromObject, table);
  table.environment = std::move(builder.environment());
  if (table.hasNoPower()) table.clear();
  return table;
}

}  // namespace quintet::render
