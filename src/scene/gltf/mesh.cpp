// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <functional>
#include <numeric>
#include <span>

#include "base/parallel.h"
#include "base/plural.h"
#include "scene/animation/deform.h"
#include "scene/geometry/repair.h"
#include "scene/geometry/tangents.h"
#include "scene/geometry/texture_coordinates.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/compression.h"
#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

// ---- Triangles ----

enum class TriangleMode { list, strip, fan };

template <class Vertex>
std::vector<uvec3> assemble(TriangleMode mode, std::size_t count, Vertex vertex) {
  std::vector<uvec3> triangles;
  if (count < 3) return triangles;
  triangles.resize(mode == TriangleMode::list ? count / 3 : count - 2);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    switch (mode) {
      case TriangleMode::list: triangles[i] = {vertex(3 * i), vertex(3 * i + 1), vertex(3 * i + 2)}; break;
      case TriangleMode::strip: triangles[i] = {vertex(i), vertex(i + 1 + i % 2), vertex(i + 2 - i % 2)}; break;
      case TriangleMode::fan: triangles[i] = {vertex(i + 1), vertex(i + 2), vertex(0)}; break;
    }
  }
  return triangles;
}

// Triangles from the order of the vertices (glTF 2.0 section 3.7.2.1, winding included). Empty `indices` mean vertices
// 0 … vertexCount-1 in their order. Vertices after the last whole triangle are dropped.
std::vector<uvec3> makeTriangles(TriangleMode mode, const std::vector<std::uint32_t>& indices,
                                 std::uint32_t vertexCount) {
  if (indices.empty()) return assemble(mode, vertexCount, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  if (mode == TriangleMode::list) {  // the common and the large case is a copy
    std::vector<uvec3> triangles(indices.size() / 3);
    static_assert(sizeof(uvec3) == 3 * sizeof(std::uint32_t));
    if (!triangles.empty()) std::memcpy(triangles.data(), indices.data(), triangles.size() * sizeof(uvec3));
    return triangles;
  }
  return assemble(mode, indices.size(), [&](std::size_t i) { return indices[i]; });
}

// Throws FileError for the first index that is too large.
void checkIndices(const Document& document, std::span<const std::uint32_t> indices, std::size_t vertexCount,
                  std::string_view location) {
  std::atomic<std::size_t> wrong = indices.size();  // index of the first one
  parallelRanges(indices.size(), [&](std::size_t first, std::size_t last) {
    const auto part = indices.subspan(first, last - first);
    const auto found = std::ranges::find_if(part, [&](std::uint32_t i) { return i >= vertexCount; });
    if (found == part.end()) return;
    const std::size_t at = first + static_cast<std::size_t>(found - part.begin());
    for (std::size_t known = wrong; at < known && !wrong.compare_exchange_weak(known, at);) {
    }
  });
  if (wrong < indices.size())
    document.fail(location, fmt::format("element {} is {}, but the primitive has {}", wrong.load(), indices[wrong],
                                        counted(vertexCount, "vertex", "vertices")));
}

// Every index of the result is below vertexCount.
std::vector<uvec3> readTriangleList(const Document& document, int index, std::size_t vertexCount,
                                    std::string_view location) {
  const std::span<const uvec3> direct = directTriangles(document, index);
  // Indices after the last whole triangle are checked, too.
  if (direct.empty() || document.model.accessors[static_cast<std::size_t>(index)].count % 3 != 0) {
    const std::vector<std::uint32_t> indices = readIndices(document, index, location);
    checkIndices(document, indices, vertexCount, location);
    return makeTriangles(TriangleMode::list, indices, static_cast<std::uint32_t>(vertexCount));
  }
  static_assert(sizeof(uvec3) == 3 * sizeof(std::uint32_t));
  std::vector<uvec3> triangles(direct.begin(), direct.end());
  checkIndices(document, {&triangles[0].x, 3 * triangles.size()}, vertexCount, location);
  return triangles;
}

// ---- One primitive ----

// Reads the parts of one primitive, from accessors or from its Draco stream.
class PrimitiveReader {
 public:
  PrimitiveReader(const Document&, int mesh, int primitive);

  const tinygltf::Primitive& primitive() const { return primitive_; }
  const std::string& location() const { return location_; }  // "/meshes/0/primitives/2"
  bool has(const std::string& attribute) const { return primitive_.attributes.contains(attribute); }

  // Positions, normals, tangents, texture coordinates and colors. All counts are equal.
  Geometry readAttributes() const;
  // Indexed or not. Every index is below vertexCount.
  std::vector<uvec3> readTriangles(std::size_t vertexCount) const;
  // JOINTS_0/WEIGHTS_0, JOINTS_1/WEIGHTS_1 and so on; empty without a skin. Every joint is below jointCount.
  std::vector<SkinSet> readSkinSets(std::size_t vertexCount, std::size_t jointCount) const;
  MorphTarget readMorphTarget(std::size_t index, const Geometry& base) const;

 private:
  std::string attributeLocation(const std::string& name) const { return location_ + "/attributes/" + name; }
  void checkCount(std::size_t count, std::size_t vertexCount, const std::string& location) const;
  std::vector<std::uint32_t> readIndexList() const;

  const Document& document_;
  const tinygltf::Primitive& primitive_;
  std::string location_;
  std::optional<DracoMesh> draco_;
};

PrimitiveReader::PrimitiveReader(const Document& document, int mesh, int primitive)
    : document_(document),
      primitive_(document.model.meshes[static_cast<std::size_t>(mesh)].primitives[static_cast<std::size_t>(primitive)]),
      location_(fmt::format("/meshes/{}/primitives/{}", mesh, primitive)) {
  if (const tinygltf::Value* extension = findExtension(primitive_.extensions, kDraco))
    draco_.emplace(document, primitive_, *extension, fmt::format("{}/extensions/{}", location_, kDraco));
}

void PrimitiveReader::checkCount(std::size_t count, std::size_t vertexCount, const std::string& location) const {
  if (count != vertexCount)
    document_.fail(location, fmt::format("{}, but POSITION has {}", counted(count, "element"), vertexCount));
}

Geometry PrimitiveReader::readAttributes() const {
  Geometry geometry;
  // In parallel, because copying waits for memory. The first failure in this order is reported, whichever occurred
  // first.
  struct Task {
    std::string location;
    std::function<std::size_t()> read;  // returns the number of elements
    std::size_t count = 0;
    std::exception_ptr failure;
  };
  std::vector<Task> tasks;
  const auto add = [&](const std::string& name, auto& values, auto fromAccessor) {
    const auto found = primitive_.attributes.find(name);
    if (found == primitive_.attributes.end()) return;
    const std::string location = attributeLocation(name);
    tasks.push_back({location,
                     [this, &values, name, location, fromAccessor, accessor = found->second] {
                       using Element = typename std::decay_t<decltype(values)>::value_type;
                       values = draco_ && draco_->has(name) ? draco_->read<Element>(name, location)
                                                            : fromAccessor(accessor, location);
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
    checkCount(task.count, geometry.positions.size(), task.location);
  }
  return geometry;
}

std::vector<std::uint32_t> PrimitiveReader::readIndexList() const {
  if (draco_) return draco_->indices();
  return readIndices(document_, primitive_.indices, location_ + "/indices");
}

std::vector<uvec3> PrimitiveReader::readTriangles(std::size_t vertexCount) const {
  if (vertexCount > 0xFFFFFFFFu) document_.fail(location_, "more vertices than 32-bit indices can address");
  TriangleMode mode = TriangleMode::list;
  if (primitive_.mode == TINYGLTF_MODE_TRIANGLE_STRIP && !draco_) mode = TriangleMode::strip;  // Draco stores lists
  if (primitive_.mode == TINYGLTF_MODE_TRIANGLE_FAN) mode = TriangleMode::fan;
  if (primitive_.indices == kNone && !draco_) return makeTriangles(mode, {}, static_cast<std::uint32_t>(vertexCount));

  const std::string location = location_ + "/indices";
  if (mode == TriangleMode::list && !draco_)
    return readTriangleList(document_, primitive_.indices, vertexCount, location);
  const std::vector<std::uint32_t> indices = readIndexList();
  checkIndices(document_, indices, vertexCount, location);
  if (indices.empty()) return {};
  return makeTriangles(mode, indices, static_cast<std::uint32_t>(vertexCount));
}

std::vector<SkinSet> PrimitiveReader::readSkinSets(std::size_t vertexCount, std::size_t jointCount) const {
  std::vector<SkinSet> sets;
  for (std::size_t number = 0;; ++number) {
    const std::string jointsName = fmt::format("JOINTS_{}", number), weightsName = fmt::format("WEIGHTS_{}", number);
    const auto joints = primitive_.attributes.find(jointsName), weights = primitive_.attributes.find(weightsName);
    if (joints == primitive_.attributes.end() || weights == primitive_.attributes.end()) break;
    SkinSet set;
    const std::string location = attributeLocation(jointsName);
    set.joints = draco_ && draco_->has(jointsName) ? draco_->read<glm::u16vec4>(jointsName, location)
                                                   : readJoints(document_, joints->second, location);
    set.weights = draco_ && draco_->has(weightsName)
                      ? draco_->read<vec4>(weightsName, attributeLocation(weightsName))
                      : readVec4(document_, weights->second, attributeLocation(weightsName), Integers::unit);
    checkCount(set.joints.size(), vertexCount, location);
    checkCount(set.weights.size(), vertexCount, attributeLocation(weightsName));
    for (std::size_t i = 0; i < vertexCount; ++i)
      for (std::size_t c = 0; c < 4; ++c)
        if (set.joints[i][c] >= jointCount)
          document_.fail(location,
                         fmt::format("vertex {} uses joint {}, but the skin has {}", i, set.joints[i][c], jointCount));
    sets.push_back(std::move(set));
  }
  return sets;
}

MorphTarget PrimitiveReader::readMorphTarget(std::size_t index, const Geometry& base) const {
  MorphTarget target;
  const auto read = [&](const char* name, std::vector<vec3>& values, Integers integers) {
    const auto found = primitive_.targets[index].find(name);
    if (found == primitive_.targets[index].end()) return;
    const std::string location = fmt::format("{}/targets/{}/{}", location_, index, name);
    values = readVec3(document_, found->second, location, integers);
    checkCount(values.size(), base.positions.size(), location);
  };
  read("POSITION", target.positions, Integers::asStated);
  read("NORMAL", target.normals, Integers::unit);
  read("TANGENT", target.tangents, Integers::unit);
  return target;
}

// ---- From primitive to geometry ----

// Adds a line for each attribute that is not supported. Names with an underscore are specific to an application.
void reportAttributes(const tinygltf::Primitive& primitive, const std::string& location, GeometryResult& result) {
  for (const auto& [name, accessor] : primitive.attributes) {
    const bool used = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name == "TEXCOORD_0" ||
                      name == "TEXCOORD_1" || name == "COLOR_0" || name.starts_with("JOINTS_") ||
                      name.starts_with("WEIGHTS_");
    if (!used && !name.starts_with('_'))
      result.ignored.push_back(fmt::format("{}/attributes/{}: attribute not supported", location, name));
  }
}

void applyMorphTargets(Geometry& geometry, const PrimitiveReader& reader, std::span<const double> weights) {
  for (std::size_t i = 0; i < reader.primitive().targets.size(); ++i) {
    const MorphTarget target = reader.readMorphTarget(i, geometry);  // also checks targets of weight 0
    const float weight = i < weights.size() ? static_cast<float>(weights[i]) : 0.0f;
    if (weight != 0.0f) applyMorphTarget(geometry, target, weight);
  }
}

void deform(Geometry& geometry, const PrimitiveReader& reader, const tinygltf::Mesh& mesh,
            const Deformation& deformation) {
  applyMorphTargets(geometry, reader, deformation.morphWeights.empty() ? mesh.weights : deformation.morphWeights);
  if (!deformation.jointMatrices.empty()) {
    const auto sets = reader.readSkinSets(geometry.positions.size(), deformation.jointMatrices.size());
    if (!sets.empty()) return applySkin(geometry, sets, deformation.jointMatrices);
  }
  if (deformation.bake) applyTransform(geometry, *deformation.bake);
}

// What an animation needs to deform the vertices of the primitive, in the order of the file.
void readDeformation(GeometryDeformation& deformation, const PrimitiveReader& reader, const Geometry& geometry,
                     std::size_t jointCount) {
  for (std::size_t i = 0; i < reader.primitive().targets.size(); ++i)
    deformation.targets.push_back(reader.readMorphTarget(i, geometry));
  if (jointCount > 0) deformation.skinSets = reader.readSkinSets(geometry.positions.size(), jointCount);
}

// Brings the deformation into the order of the vertices of the geometry, and adds the undeformed attributes.
void finishDeformation(GeometryDeformation& deformation, Geometry& geometry, bool faceNormals, bool skinned) {
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> gathered;
    gathered.reserve(geometry.fileVertices.size());
    for (const std::uint32_t vertex : geometry.fileVertices) gathered.push_back(values[vertex]);
    values = std::move(gathered);
  };
  for (MorphTarget& target : deformation.targets) {
    gather(target.positions);
    gather(target.normals);
    gather(target.tangents);
  }
  for (SkinSet& set : deformation.skinSets) {
    gather(set.joints);
    gather(set.weights);
  }
  deformation.positions = geometry.positions;
  deformation.normals = geometry.normals;
  deformation.tangents = geometry.tangents;
  deformation.faceNormals = faceNormals;
  if (skinned) deformation.triangles = geometry.triangles;
  geometry.fileVertices = {};
}

void repair(Geometry& geometry, const std::string& location, GeometryResult& result) {
  const auto note = [&](std::size_t count, const char* what) {
    if (count > 0) result.repaired.push_back(fmt::format("{}: {} {}", location, count, what));
  };
  note(dropNonFiniteTriangles(geometry), "triangles with non-finite vertices dropped");
  note(repairNormals(geometry), "normals without a direction replaced");
  note(repairUvsAndColors(geometry), "non-finite texture coordinates or colors replaced");
  if (geometry.normals.empty()) geometry.tangents.clear();  // glTF 2.0 section 3.7.2.1
  note(repairTangents(geometry), "tangents without a direction replaced");
}

const char* modeName(int mode) {
  constexpr const char* kNames[] = {"POINTS", "LINES", "LINE_LOOP", "LINE_STRIP"};
  return kNames[mode];
}

}  // namespace

GeometryResult readGeometry(const Document& document, const std::vector<Material>& materials, int meshIndex,
                            int primitiveIndex, const Deformation& deformation) {
  const tinygltf::Mesh& mesh = document.model.meshes[static_cast<std::size_t>(meshIndex)];
  const PrimitiveReader reader(document, meshIndex, primitiveIndex);
  const std::string& location = reader.location();
  GeometryResult result;
  if (const int mode = reader.primitive().mode; mode < TINYGLTF_MODE_TRIANGLES) {
    result.ignored.push_back(fmt::format("{}: mode {} has no surface", location, modeName(mode)));
    return result;
  }
  if (!reader.has("POSITION")) {
    result.ignored.push_back(location + ": no POSITION attribute");
    return result;
  }
  reportAttributes(reader.primitive(), location, result);

  Geometry geometry = reader.readAttributes();
  geometry.triangles = reader.readTriangles(geometry.positions.size());
  geometry.material = reader.primitive().material;
  if (deformation.animated) {
    readDeformation(result.deformation, reader, geometry, deformation.jointCount);
    geometry.fileVertices.resize(geometry.positions.size());
    std::iota(geometry.fileVertices.begin(), geometry.fileVertices.end(), 0u);
  } else {
    deform(geometry, reader, mesh, deformation);
  }
  repair(geometry, location, result);
  if (geometry.triangles.empty()) {
    result.ignored.push_back(location + ": no triangles");
    return result;
  }
  dropUnusedVertices(geometry);
  const bool flat = geometry.normals.empty();
  if (geometry.material != kNone) {
    const Material& material = materials[static_cast<std::size_t>(geometry.material)];
    const unsigned missing = missingUvSets(geometry, material);
    for (unsigned set = 0; set < kMaxUvSets; ++set)
      if (missing >> set & 1u)
        result.repaired.push_back(fmt::format(
            "{}: the textures of /materials/{} that use TEXCOORD_{} are ignored, because the primitive does "
            "not have it",
            location, geometry.material, set));
    addTangents(geometry, withoutUvSets(material, missing));
  }
  if (deformation.animated)
    finishDeformation(result.deformation, geometry, flat && !geometry.normals.empty(), deformation.jointCount > 0);
  result.geometry = std::move(geometry);
  return result;
}

void checkMorphTargets(const Document& document, int meshIndex) {
  const tinygltf::Mesh& mesh = document.model.meshes[static_cast<std::size_t>(meshIndex)];
  const std::string location = fmt::format("/meshes/{}", meshIndex);
  if (mesh.primitives.empty()) document.fail(location + "/primitives", "must not be empty");
  const std::size_t count = mesh.primitives[0].targets.size();
  for (std::size_t i = 1; i < mesh.primitives.size(); ++i)
    if (mesh.primitives[i].targets.size() != count)
      document.fail(
          fmt::format("{}/primitives/{}/targets", location, i),
          fmt::format("{}, but primitive 0 has {}", counted(mesh.primitives[i].targets.size(), "morph target"), count));
  if (!mesh.weights.empty() && mesh.weights.size() != count)
    document.fail(location + "/weights",
                  fmt::format("{} for {}", counted(mesh.weights.size(), "weight"), counted(count, "morph target")));
}

}  // namespace quintet::scene
