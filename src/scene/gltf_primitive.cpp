#include "scene/gltf_primitive.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>

#include "base/parallel.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_draco.h"
#include "scene/gltf_extensions.h"
#include "scene/triangles.h"

namespace quintet::scene {

PrimitiveReader::PrimitiveReader(const Document& document, int mesh, int primitive)
    : document_(document),
      primitive_(document.model.meshes[static_cast<std::size_t>(mesh)].primitives[static_cast<std::size_t>(primitive)]),
      place_(fmt::format("/meshes/{}/primitives/{}", mesh, primitive)) {
  if (const tinygltf::Value* extension = findExtension(primitive_.extensions, kDraco))
    draco_ =
        std::make_unique<DracoMesh>(document, primitive_, *extension, fmt::format("{}/extensions/{}", place_, kDraco));
}

PrimitiveReader::~PrimitiveReader() = default;

void PrimitiveReader::checkCount(std::size_t count, std::size_t vertexCount, const std::string& place) const {
  if (count != vertexCount) document_.fail(place, fmt::format("{} elements, but POSITION has {}", count, vertexCount));
}

Geometry PrimitiveReader::readAttributes() const {
  Geometry geometry;
  // All at once: copying is waiting for memory. What went wrong is told in this order, whichever came first.
  struct Task {
    std::string place;
    std::function<std::size_t()> read;  // returns the number of elements
    std::size_t count = 0;
    std::exception_ptr failure;
  };
  std::vector<Task> tasks;
  const auto add = [&](const std::string& name, auto& values, auto fromAccessor) {
    const auto found = primitive_.attributes.find(name);
    if (found == primitive_.attributes.end()) return;
    const std::string place = attributePlace(name);
    tasks.push_back({place,
                     [this, &values, name, place, fromAccessor, accessor = found->second] {
                       using Element = typename std::decay_t<decltype(values)>::value_type;
                       values = draco_ && draco_->has(name) ? draco_->read<Element>(name, place)
                                                            : fromAccessor(accessor, place);
                       return values.size();
                     },
                     0, nullptr});
  };
  const auto asStated = Integers::asStated, unit = Integers::unit;
  add("POSITION", geometry.positions, [&](int a, auto& p) { return readVec3(document_, a, p, asStated); });
  add("NORMAL", geometry.normals, [&](int a, auto& p) { return readVec3(document_, a, p, unit); });
  add("TANGENT", geometry.tangents, [&](int a, auto& p) { return readVec4(document_, a, p, unit); });
  add("TEXCOORD_0", geometry.uvs[0], [&](int a, auto& p) { return readVec2(document_, a, p, asStated); });
  add("TEXCOORD_1", geometry.uvs[1], [&](int a, auto& p) { return readVec2(document_, a, p, asStated); });
  add("COLOR_0", geometry.colors, [&](int a, auto& p) { return readColors(document_, a, p); });
  parallelFor(tasks.size(), [&](std::size_t i) {
    try {
      tasks[i].count = tasks[i].read();
    } catch (...) {
      tasks[i].failure = std::current_exception();
    }
  });
  for (const Task& task : tasks) {
    if (task.failure) std::rethrow_exception(task.failure);
    checkCount(task.count, geometry.positions.size(), task.place);
  }
  return geometry;
}

std::vector<std::uint32_t> PrimitiveReader::readIndexList() const {
  if (draco_) return draco_->indices();
  return readIndices(document_, primitive_.indices, place_ + "/indices");
}

std::vector<uvec3> PrimitiveReader::readTriangles(std::size_t vertexCount) const {
  if (vertexCount > 0xFFFFFFFFu) document_.fail(place_, "more vertices than 32-bit indices can number");
  TriangleMode mode = TriangleMode::list;
  if (primitive_.mode == TINYGLTF_MODE_TRIANGLE_STRIP && !draco_) mode = TriangleMode::strip;  // Draco stores a list
  if (primitive_.mode == TINYGLTF_MODE_TRIANGLE_FAN) mode = TriangleMode::fan;
  if (primitive_.indices == kNone && !draco_) return makeTriangles(mode, {}, static_cast<std::uint32_t>(vertexCount));

  const std::string place = place_ + "/indices";
  if (mode == TriangleMode::list && !draco_) return readTriangleList(document_, primitive_.indices, vertexCount, place);
  const std::vector<std::uint32_t> indices = readIndexList();
  checkIndices(document_, indices, vertexCount, place);
  if (indices.empty()) return {};
  return makeTriangles(mode, indices, static_cast<std::uint32_t>(vertexCount));
}

std::vector<SkinSet> PrimitiveReader::readSkinSets(std::size_t vertexCount, std::size_t jointCount) const {
  std::vector<SkinSet> sets;
  for (const char* number : {"0", "1"}) {
    const std::string jointsName = std::string("JOINTS_") + number, weightsName = std::string("WEIGHTS_") + number;
    const auto joints = primitive_.attributes.find(jointsName), weights = primitive_.attributes.find(weightsName);
    if (joints == primitive_.attributes.end() || weights == primitive_.attributes.end()) break;
    SkinSet set;
    const std::string place = attributePlace(jointsName);
    set.joints = draco_ && draco_->has(jointsName) ? draco_->read<glm::u16vec4>(jointsName, place)
                                                   : readJoints(document_, joints->second, place);
    set.weights = draco_ && draco_->has(weightsName)
                      ? draco_->read<vec4>(weightsName, attributePlace(weightsName))
                      : readVec4(document_, weights->second, attributePlace(weightsName), Integers::unit);
    checkCount(set.joints.size(), vertexCount, place);
    checkCount(set.weights.size(), vertexCount, attributePlace(weightsName));
    for (std::size_t i = 0; i < vertexCount; ++i)
      for (std::size_t c = 0; c < 4; ++c)
        if (set.joints[i][c] >= jointCount)
          document_.fail(place, fmt::format("vertex {} is bound to joint {}, but the skin has {}", i, set.joints[i][c],
                                            jointCount));
    sets.push_back(std::move(set));
  }
  return sets;
}

MorphTarget PrimitiveReader::readMorphTarget(std::size_t index, const Geometry& base) const {
  MorphTarget target;
  const auto read = [&](const char* name, std::vector<vec3>& values, Integers integers) {
    const auto found = primitive_.targets[index].find(name);
    if (found == primitive_.targets[index].end()) return;
    const std::string place = fmt::format("{}/targets/{}/{}", place_, index, name);
    values = readVec3(document_, found->second, place, integers);
    checkCount(values.size(), base.positions.size(), place);
  };
  read("POSITION", target.positions, Integers::asStated);
  read("NORMAL", target.normals, Integers::unit);
  read("TANGENT", target.tangents, Integers::unit);
  return target;
}

}  // namespace quintet::scene
