// SPDX-License-Identifier: Apache-2.0
#include "check/flow/space_tags.h"

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "check/library_names.h"
#include "spirv/access.h"
#include "spirv/value_part.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;
using Kind = SpaceTag::Kind;
using TypeKind = spirv::Type::Kind;

constexpr std::size_t kMaxLeaves = 96;     // of a type
constexpr std::uint32_t kMaxElements = 4;  // of an array whose elements have leaves of their own
constexpr std::uint8_t kMaxVisits = 24;    // of an instruction

bool isLeaf(const spirv::Type& type) {
  return type.kind != TypeKind::structure && type.kind != TypeKind::array && type.kind != TypeKind::runtimeArray;
}

SpaceTag rowTag(Space from, Space to, std::uint8_t index) {
  SpaceTag tag;
  tag.kind = Kind::row;
  tag.map = {from, to};
  tag.index = index;
  return tag;
}

SpaceTag addressTag(SpaceTag::Array array) {
  SpaceTag tag;
  tag.kind = Kind::address;
  tag.array = array;
  return tag;
}

SpaceTag matrixTag(const SpaceMap& map, bool transposed) {
  SpaceTag tag;
  tag.kind = Kind::matrix;
  tag.map = map;
  tag.transposed = transposed;
  return tag;
}

// Returns the tags of a member of a structure of the library that its type alone does not give: one per element.
SpaceLeaves memberTags(const spirv::Type& structure, std::size_t member) {
  const std::string_view type = libraryName(structure.name);
  const std::string& name = structure.memberNames[member];
  const auto rows = [](Space from, Space to) {
    return SpaceLeaves{rowTag(from, to, 0), rowTag(from, to, 1), rowTag(from, to, 2)};
  };
  if (type == "InstanceData" && name == "worldFromObject") return rows(Space::object, Space::world);
  if (type == "InstanceData" && name == "objectFromWorld") return rows(Space::world, Space::object);
  if (type == "CameraData" && name == "worldFromCamera") return rows(Space::camera, Space::world);
  if (type == "GeometryData" && name == "positions") return {addressTag(SpaceTag::Array::positions)};
  if (type == "GeometryData" && name == "normals") return {addressTag(SpaceTag::Array::normals)};
  if (type == "GeometryData" && name == "tangents") return {addressTag(SpaceTag::Array::tangents)};
  if (type == "BoxData" && (name == "min" || name == "max")) return {geometricTag(Space::object, Kind::point)};
  if (type == "Launch" && name == "parameterAddress") return {addressTag(SpaceTag::Array::parameters)};
  return {};
}

SpaceTag elementTag(SpaceTag::Array array) {
  const auto vertexTag = [](Kind kind) {
    SpaceTag tag = geometricTag(Space::object, kind);
    tag.fromMesh = true;
    return tag;
  };
  switch (array) {
    case SpaceTag::Array::positions: return vertexTag(Kind::point);
    case SpaceTag::Array::normals: return vertexTag(Kind::normal);
    case SpaceTag::Array::tangents: {
      SpaceTag tag = vertexTag(Kind::direction);
      tag.w = SpaceTag::W::other;
      return tag;
    }
    case SpaceTag::Array::parameters: return neutralTag();
    default: return unknownTag();
  }
}

SpaceLeaves joinedLeaves(const SpaceLeaves& a, const SpaceLeaves& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  if (a.size() != b.size()) return SpaceLeaves(a.size(), unknownTag());
  SpaceLeaves result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = joined(a[i], b[i]);
  return result;
}

bool isUndefined(const SpaceLeaves& leaves) {
  return std::ranges::all_of(leaves, [](const SpaceTag& tag) { return tag.kind == Kind::undefined; });
}

}  // namespace

bool overlaps(const spirv::Access& access, const spirv::Path& path) {
  std::vector<std::optional<std::uint32_t>> indices;
  for (const std::uint32_t index : path) indices.push_back(index == kAnyIndex ? std::nullopt : std::optional(index));
  return spirv::overlap(access.indices, indices);
}

SpaceTags::SpaceTags(const spirv::Module& module, bool usesLibrary) : module_(module), usesLibrary_(usesLibrary) {
  const auto& instructions = module.instructions();
  Id bound = 0;
  for (const spirv::Instruction& i : instructions) bound = std::max(bound, i.result);
  tags_.resize(bound + std::size_t{1});
  visits_.resize(instructions.size());
  isOpen_.resize(instructions.size());
  for (std::size_t i = 0; i < instructions.size(); ++i) {
    if (instructions[i].op == Op::OpLoad) {
      const spirv::Access pointer = module.access(instructions[i].at(0));
      if (isTable(pointer.base)) loads_[pointer.base].push_back(i);
    } else if (instructions[i].op == Op::OpVariable && isTable(instructions[i].result)) {
      const Id type = module.types().get(instructions[i].type).element;
      if (instructions[i].operands.size() > 1)
        variables_[instructions[i].result] = SpaceLeaves(layout(type).count, neutralTag());
    } else if (instructions[i].op == Op::OpFunctionCall || instructions[i].op == Op::OpCopyMemory) {
      // A function that is not inlined can store anything.
      for (const Id id : spirv::valueOperands(instructions[i]))
        if (const spirv::Access pointer = module.access(id); isTable(pointer.base))
          variables_[pointer.base] = unknownLeaves(pointer.type);
    }
  }
  for (std::size_t i = instructions.size(); i-- > 0;)
    if (module.position(i)) push(i);
}

void SpaceTags::push(std::size_t instruction) {
  if (isOpen_[instruction]) return;
  isOpen_[instruction] = true;
  open_.push_back(instruction);
}

void SpaceTags::pushUsers(Id value) {
  for (const std::size_t user : module_.users(value)) push(user);
}

// True for variables whose tags are those of the stores: local variables and those that stages share.
bool SpaceTags::isTable(Id variable) const {
  const spirv::Instruction* definition = module_.definition(variable);
  if (!definition || definition->op != Op::OpVariable) return false;
  using Storage = spv::StorageClass;
  switch (static_cast<Storage>(definition->at(0))) {
    case Storage::Function:
    case Storage::Private:
    case Storage::RayPayloadKHR:
    case Storage::IncomingRayPayloadKHR:
    case Storage::CallableDataKHR:
    case Storage::IncomingCallableDataKHR:
    case Storage::HitAttributeKHR: return true;
    default: return false;
  }
}

const SpaceTags::Layout& SpaceTags::layout(Id type) const {
  const auto found = layouts_.find(type);
  if (found != layouts_.end()) return found->second;
  const spirv::Type& t = module_.types().get(type);
  Layout result;
  if (t.kind == TypeKind::structure) {
    result.count = 0;
    for (const Id member : t.members) {
      result.offsets.push_back(result.count);
      const Layout& inner = layout(member);
      result.count += inner.count;
      result.opaque = result.opaque || result.count > kMaxLeaves;
    }
  } else if (t.kind == TypeKind::array || t.kind == TypeKind::runtimeArray) {
    const std::size_t element = layout(t.element).count;
    result.summary = t.kind == TypeKind::runtimeArray || t.count > kMaxElements || t.count == 0;
    result.count = result.summary ? element : element * t.count;
  }
  result.opaque = result.opaque || result.count > kMaxLeaves || result.count == 0;
  if (result.opaque) result.count = 1;
  return layouts_.emplace(type, std::move(result)).first->second;
}

SpaceTags::Slice SpaceTags::slice(Id type, const std::vector<std::optional<std::uint32_t>>& path) const {
  Slice result{{0}, type, {}};
  for (std::size_t i = 0; i < path.size(); ++i) {
    const spirv::Type& t = module_.types().get(result.type);
    const Layout& whole = layout(result.type);
    if (whole.opaque) return {};
    if (isLeaf(t)) {
      result.rest.assign(path.begin() + static_cast<std::ptrdiff_t>(i), path.end());
      return result;
    }
    if (t.kind == TypeKind::structure) {
      if (!path[i] || *path[i] >= t.members.size()) return {};
      for (std::size_t& offset : result.offsets) offset += whole.offsets[*path[i]];
      result.type = t.members[*path[i]];
      continue;
    }
    result.type = t.element;
    if (whole.summary) continue;
    const std::size_t element = layout(t.element).count;
    if (path[i]) {
      if (*path[i] >= t.count) return {};
      for (std::size_t& offset : result.offsets) offset += *path[i] * element;
      continue;
    }
    std::vector<std::size_t> all;
    for (const std::size_t offset : result.offsets)
      for (std::size_t k = 0; k < t.count; ++k) all.push_back(offset + k * element);
    result.offsets = std::move(all);
    if (result.offsets.size() > kMaxLeaves) return {};
  }
  return result;
}

SpaceTag SpaceTags::part(SpaceTag tag, Id type, std::span<const std::optional<std::uint32_t>> rest) const {
  for (const auto& index : rest) {
    const spirv::Type& t = module_.types().get(type);
    if (tag.kind == Kind::undefined) return tag;
    if (t.kind == TypeKind::matrix) {
      if (tag.kind == Kind::matrix && index && tag.transposed) {
        tag = rowTag(tag.map.from, tag.map.to, static_cast<std::uint8_t>(*index));
        if (*index > 2) return unknownTag();
      } else if (tag.kind == Kind::matrix && index) {
        const bool translation = *index == kWholeVector;
        SpaceTag column = geometricTag(tag.map.to, translation ? Kind::point : Kind::direction);
        column.translation = translation;
        column.column = !translation;
        column.map = tag.map;
        column.index = static_cast<std::uint8_t>(*index);
        column.fromMesh = true;
        if (module_.types().get(t.element).count == 4) column.w = translation ? SpaceTag::W::one : SpaceTag::W::zero;
        tag = column;
      } else if (tag.kind == Kind::frame) {
        tag = geometricTag(tag.space, Kind::any);
      } else if (tag.kind != Kind::neutral) {
        return unknownTag();
      }
    } else if (t.kind == TypeKind::vector) {
      tag = index ? componentOf(tag, *index) : tag.kind == Kind::neutral ? tag : unknownTag();
    } else {
      return unknownTag();
    }
    type = t.element;
  }
  return tag;
}

SpaceLeaves SpaceTags::read(const SpaceLeaves& leaves, Id type,
                            const std::vector<std::optional<std::uint32_t>>& path) const {
  const Slice part = slice(type, path);
  if (part.offsets.empty()) return {unknownTag()};
  const std::size_t count = part.rest.empty() ? layout(part.type).count : 1;
  SpaceLeaves result(count);
  for (const std::size_t offset : part.offsets) {
    for (std::size_t i = 0; i < count; ++i) {
      const SpaceTag tag = offset + i < leaves.size() ? leaves[offset + i] : unknownTag();
      result[i] = joined(result[i], part.rest.empty() ? tag : this->part(tag, part.type, part.rest));
    }
  }
  return result;
}

SpaceLeaves SpaceTags::unknownLeaves(Id type) const { return SpaceLeaves(layout(type).count, unknownTag()); }

// The tags that the types of the library give.
SpaceLeaves SpaceTags::libraryLeaves(Id type) const {
  const auto found = library_.find(type);
  if (found != library_.end()) return found->second;
  const spirv::Type& t = module_.types().get(type);
  SpaceLeaves result = unknownLeaves(type);
  const Layout& whole = layout(type);
  const auto put = [&](std::size_t offset, const SpaceLeaves& tags) {
    for (std::size_t i = 0; i < tags.size() && offset + i < result.size(); ++i) result[offset + i] = tags[i];
  };
  if (t.kind == TypeKind::structure && !whole.opaque) {
    for (std::size_t i = 0; i < t.members.size(); ++i) {
      const SpaceLeaves tags = usesLibrary_ ? memberTags(t, i) : SpaceLeaves{};
      put(whole.offsets[i], tags.size() == layout(t.members[i]).count ? tags : libraryLeaves(t.members[i]));
    }
  } else if ((t.kind == TypeKind::array || t.kind == TypeKind::runtimeArray) && !whole.opaque) {
    const SpaceLeaves element = libraryLeaves(t.element);
    for (std::size_t offset = 0; offset < result.size(); offset += element.size()) put(offset, element);
  }
  return library_[type] = std::move(result);
}

SpaceTag SpaceTags::builtInTag(const spirv::Variable& variable) const {
  using spv::BuiltIn;
  switch (*variable.builtIn) {
    case BuiltIn::WorldRayOriginKHR: return geometricTag(Space::world, Kind::point);
    case BuiltIn::ObjectRayOriginKHR: return geometricTag(Space::object, Kind::point);
    case BuiltIn::WorldRayDirectionKHR:
    case BuiltIn::ObjectRayDirectionKHR: {
      const bool world = *variable.builtIn == BuiltIn::WorldRayDirectionKHR;
      SpaceTag tag = geometricTag(world ? Space::world : Space::object, Kind::direction);
      tag.onRay = true;
      return tag;
    }
    case BuiltIn::ObjectToWorldKHR: return matrixTag({Space::object, Space::world}, false);
    case BuiltIn::WorldToObjectKHR: return matrixTag({Space::world, Space::object}, false);
    default: return unknownTag();
  }
}

// The tags of what the base of a pointer points to.
SpaceLeaves SpaceTags::sourceLeaves(const spirv::Access& pointer) const {
  if (isTable(pointer.base)) {
    const auto found = variables_.find(pointer.base);
    return found == variables_.end() ? SpaceLeaves(layout(pointer.type).count) : found->second;
  }
  if (const spirv::Variable* variable = module_.variable(pointer.base)) {
    if (variable->builtIn) return {builtInTag(*variable)};
    return libraryLeaves(pointer.type);
  }
  const SpaceTag base = of(pointer.base);
  if (base.kind == Kind::undefined) return {};
  if (base.kind == Kind::address) return SpaceLeaves(layout(pointer.type).count, elementTag(base.array));
  return libraryLeaves(pointer.type);
}

SpaceTag SpaceTags::constantTag(Id value) const {
  SpaceTag tag = neutralTag();
  const spirv::Instruction* constant = module_.definition(value);
  if (!constant || module_.types().get(constant->type).count != 4) return tag;
  tag.w = SpaceTag::W::other;
  if (constant->op == Op::OpConstantNull) tag.w = SpaceTag::W::zero;
  if (constant->op != Op::OpConstantComposite) return tag;
  const auto w = module_.constantFloat(constant->operands.back());
  if (w && *w == 0.0) tag.w = SpaceTag::W::zero;
  if (w && *w == 1.0) tag.w = SpaceTag::W::one;
  return tag;
}

SpaceLeaves SpaceTags::leavesOf(Id value) const {
  const spirv::Instruction* definition = module_.definition(value);
  if (!definition) return {unknownTag()};
  if (module_.isConstant(value) || definition->op == Op::OpSpecConstant || definition->op == Op::OpSpecConstantOp) {
    const std::size_t count = layout(definition->type).count;
    return SpaceLeaves(count, count == 1 ? constantTag(value) : neutralTag());
  }
  return value < tags_.size() ? tags_[value] : SpaceLeaves{};
}

SpaceTag SpaceTags::of(Id value) const {
  const SpaceLeaves leaves = leavesOf(value);
  if (leaves.empty()) return {};
  return leaves.size() == 1 ? leaves.front() : unknownTag();
}

const std::vector<std::size_t>& SpaceTags::loads(Id variable) const {
  static const std::vector<std::size_t> kNone;
  const auto found = loads_.find(variable);
  return found == loads_.end() ? kNone : found->second;
}

SpaceLeaves SpaceTags::contents(Id variable) const {
  const auto found = variables_.find(variable);
  return found == variables_.end() ? SpaceLeaves{} : found->second;
}

bool SpaceTags::add(Id variable, const SpaceLeaves& leaves) {
  const spirv::Variable* declared = module_.variable(variable);
  if (!declared || leaves.empty() || isUndefined(leaves)) return false;
  SpaceLeaves& own = variables_[variable];
  if (own.empty()) own.resize(layout(declared->type).count);
  SpaceLeaves all = joinedLeaves(own, leaves);
  if (all == own) return false;
  own = std::move(all);
  for (const std::size_t load : loads(variable)) push(load);
  return true;
}

SpaceLeaves SpaceTags::load(const spirv::Instruction& instruction) const {
  const spirv::Access pointer = module_.access(instruction.at(0));
  const SpaceLeaves source = sourceLeaves(pointer);
  return source.empty() ? SpaceLeaves{} : read(source, pointer.type, pointer.indices);
}

bool SpaceTags::store(const spirv::Instruction& instruction) {
  const spirv::Access pointer = module_.access(instruction.at(0));
  if (!isTable(pointer.base)) return false;
  const SpaceLeaves value = leavesOf(instruction.at(1));
  if (value.empty()) return false;
  SpaceLeaves& own = variables_[pointer.base];
  if (own.empty()) own.resize(layout(pointer.type).count);
  SpaceLeaves changed = own;
  const Slice target = slice(pointer.type, pointer.indices);
  if (target.offsets.empty()) {
    for (SpaceTag& tag : changed) tag = unknownTag();
  } else if (target.rest.empty()) {
    for (const std::size_t offset : target.offsets)
      for (std::size_t i = 0; i < value.size() && offset + i < changed.size(); ++i)
        changed[offset + i] = joined(changed[offset + i], value[i]);
  } else {
    // A component or a column.
    SpaceTag tag = value.front();
    const bool component = (tag.geometric() || tag.kind == Kind::barycentric) && target.rest.size() == 1 &&
                           target.rest[0] == tag.component;
    if (component)
      tag.component = kWholeVector;
    else if (tag.kind != Kind::neutral && tag.kind != Kind::undefined)
      tag = unknownTag();
    for (const std::size_t offset : target.offsets)
      if (offset < changed.size()) changed[offset] = joined(changed[offset], tag);
  }
  if (changed == own) return false;
  own = std::move(changed);
  for (const std::size_t i : loads(pointer.base)) push(i);
  return true;
}

void SpaceTags::run() {
  while (!open_.empty()) {
    const std::size_t next = open_.back();
    open_.pop_back();
    isOpen_[next] = false;
    const spirv::Instruction& instruction = module_.instructions()[next];
    if (instruction.op == Op::OpStore) {
      store(instruction);
      continue;
    }
    if (instruction.result == 0 || instruction.type == 0) continue;
    SpaceLeaves leaves = evaluate(instruction);
    SpaceLeaves& old = tags_[instruction.result];
    if (leaves == old || leaves.empty()) continue;
    if (++visits_[next] > kMaxVisits) {
      visits_[next] = kMaxVisits;
      leaves.assign(leaves.size(), unknownTag());
      if (leaves == old) continue;
    }
    old = std::move(leaves);
    pushUsers(instruction.result);
  }
}

void SpaceTags::finish() {
  for (const auto& [variable, loads] : loads_) {
    const Id pointer = module_.definition(variable)->type;
    SpaceLeaves& own = variables_[variable];
    own.resize(layout(module_.types().get(pointer).element).count);
    bool changed = false;
    for (SpaceTag& tag : own) {
      if (tag.kind != Kind::undefined) continue;
      tag = unknownTag();
      changed = true;
    }
    if (!changed) continue;
    for (const std::size_t load : loads) push(load);
  }
  run();
}

SpaceLeaves SpaceTags::evaluate(const spirv::Instruction& i) const {
  const std::size_t count = layout(i.type).count;
  switch (i.op) {
    case Op::OpLoad: return load(i);
    case Op::OpCopyObject:
    case Op::OpCopyLogical: {
      SpaceLeaves result = leavesOf(i.at(0));
      return result.size() == count || result.empty() ? result : SpaceLeaves(count, unknownTag());
    }
    case Op::OpPhi: {
      SpaceLeaves result;
      for (std::size_t k = 0; k < i.operands.size(); k += 2) result = joinedLeaves(result, leavesOf(i.at(k)));
      return result;
    }
    case Op::OpSelect: return joinedLeaves(leavesOf(i.at(1)), leavesOf(i.at(2)));
    case Op::OpCompositeExtract: {
      const spirv::Instruction* from = module_.definition(i.at(0));
      const SpaceLeaves leaves = leavesOf(i.at(0));
      if (!from || leaves.empty()) return {};
      const std::vector<std::optional<std::uint32_t>> path(i.operands.begin() + 1, i.operands.end());
      return read(leaves, from->type, path);
    }
    case Op::OpCompositeInsert: {
      SpaceLeaves result = leavesOf(i.at(1));
      const SpaceLeaves object = leavesOf(i.at(0));
      if (result.empty() || object.empty()) return {};
      const std::vector<std::optional<std::uint32_t>> path(i.operands.begin() + 2, i.operands.end());
      const Slice target = slice(i.type, path);
      if (target.offsets.size() != 1) return SpaceLeaves(count, unknownTag());
      const std::size_t offset = target.offsets[0];
      if (target.rest.empty()) {
        for (std::size_t k = 0; k < object.size() && offset + k < result.size(); ++k) result[offset + k] = object[k];
      } else if (offset < result.size() && (result[offset].kind != Kind::neutral || object[0].kind != Kind::neutral)) {
        const SpaceTag& old = result[offset];
        const bool same = old.geometric() && object[0].geometric() && object[0].space == old.space &&
                          target.rest.size() == 1 && target.rest[0] == object[0].component;
        result[offset] = same ? geometricTag(old.space, Kind::any) : unknownTag();
      }
      return result;
    }
    case Op::OpCompositeConstruct: {
      const spirv::Type& type = module_.types().get(i.type);
      if (isLeaf(type)) break;
      const Layout& whole = layout(i.type);
      if (whole.opaque) return {unknownTag()};
      SpaceLeaves result;
      bool defined = false;
      for (std::size_t k = 0; k < i.operands.size(); ++k) {
        const Id member = type.part(static_cast<std::uint32_t>(k));
        SpaceLeaves leaves = leavesOf(i.at(k));
        defined = defined || !leaves.empty();
        leaves.resize(layout(member).count);
        if (whole.summary && k > 0) {
          result = joinedLeaves(result, leaves);
        } else {
          result.insert(result.end(), leaves.begin(), leaves.end());
        }
      }
      if (result.size() != whole.count) return SpaceLeaves(whole.count, unknownTag());
      return defined ? result : SpaceLeaves{};
    }
    default: break;
  }
  if (count != 1) return SpaceLeaves(count, unknownTag());
  SpaceTag tag = evaluateLeaf(i);
  if (tag.geometric())
    for (const Id id : spirv::valueOperands(i)) tag.fromMesh = tag.fromMesh || of(id).fromMesh;
  return tag.kind == Kind::undefined ? SpaceLeaves{} : SpaceLeaves{tag};
}

SpaceTag SpaceTags::evaluateLeaf(const spirv::Instruction& i) const {
  const auto operand = [&](std::size_t k) { return of(i.at(k)); };
  switch (i.op) {
    case Op::OpFAdd: return sumOf(operand(0), operand(1));
    case Op::OpFSub: return differenceOf(operand(0), operand(1));
    case Op::OpFNegate: {
      SpaceTag tag = scaledTag(operand(0));
      return tag;
    }
    case Op::OpVectorTimesScalar: return productOf(operand(0), operand(1));
    case Op::OpFMul:
    case Op::OpFDiv: return evaluateProduct(i);
    case Op::OpMatrixTimesScalar: return operand(0);
    case Op::OpMatrixTimesVector:
    case Op::OpVectorTimesMatrix: {
      const bool left = i.op == Op::OpVectorTimesMatrix;
      const SpaceTag matrix = operand(left ? 1 : 0), vector = operand(left ? 0 : 1);
      if (matrix.kind == Kind::undefined || vector.kind == Kind::undefined) return {};
      if (matrix.kind == Kind::frame && !left) return geometricTag(matrix.space, Kind::any);
      const auto found = product(i);
      if (!found) return matrix.kind == Kind::neutral && vector.kind == Kind::neutral ? neutralTag() : unknownTag();
      SpaceTag result = transformed(found->transform, found->vector);
      // A vec4 result: w is that of the vector if the last row is (0, 0, 0, 1).
      if (module_.types().get(i.type).count == 4)
        result.w = !found->transform.affine ? SpaceTag::W::other : found->vector.w;
      return result;
    }
    case Op::OpMatrixTimesMatrix: return matrixProduct(operand(0), operand(1));
    case Op::OpTranspose: {
      SpaceTag tag = operand(0);
      if (tag.kind == Kind::matrix) tag.transposed = !tag.transposed;
      return tag.kind == Kind::frame ? unknownTag() : tag;
    }
    case Op::OpDot: return dot(i);
    case Op::OpVectorShuffle: return shuffle(i);
    case Op::OpCompositeConstruct: return construct(i);
    case Op::OpExtInst: return evaluateExtended(i);
    case Op::OpConvertUToPtr:
    case Op::OpConvertPtrToU:
    case Op::OpBitcast: {
      const SpaceTag tag = operand(0);
      return tag.kind == Kind::address || tag.kind == Kind::neutral || tag.kind == Kind::undefined ? tag : unknownTag();
    }
    case Op::OpFunctionCall:
    case Op::OpFunctionParameter:
    case Op::OpReportIntersectionKHR: return unknownTag();
    default: break;
  }
  if (i.op == Op::OpAccessChain || i.op == Op::OpInBoundsAccessChain) return unknownTag();
  SpaceTag result = neutralTag();
  for (const Id id : spirv::valueOperands(i)) {
    const SpaceTag tag = of(id);
    if (tag.kind == Kind::undefined) return {};
    if (tag.kind != Kind::neutral) result = unknownTag();
  }
  // Instructions without operands, and samples of textures, are not constants.
  const bool image = i.op >= Op::OpSampledImage && i.op <= Op::OpImageQuerySamples;
  return spirv::valueOperands(i).empty() || image ? unknownTag() : result;
}

SpaceTag SpaceTags::evaluateExtended(const spirv::Instruction& i) const {
  const auto operand = [&](std::size_t k) { return of(i.at(2 + k)); };
  if (module_.extendedSet(i.at(0)) != "GLSL.std.450") return unknownTag();
  switch (i.at(1)) {
    case GLSLstd450Normalize: return normalizedTag(operand(0));
    case GLSLstd450Cross: return crossOf(operand(0), operand(1));
    case GLSLstd450MatrixInverse: {
      SpaceTag tag = operand(0);
      std::swap(tag.map.from, tag.map.to);
      return tag.kind == Kind::frame ? unknownTag() : tag;
    }
    case GLSLstd450Reflect:
    case GLSLstd450Refract: {
      const SpaceTag a = operand(0), b = operand(1);
      if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
      if (a.kind == Kind::unknown || b.kind == Kind::unknown) return unknownTag();
      const SpaceTag& known = a.geometric() ? a : b;
      if (!known.geometric()) return known.kind == Kind::neutral ? known : unknownTag();
      if (a.geometric() && b.geometric() && a.space != b.space) return unknownTag();
      return geometricTag(known.space, Kind::direction);
    }
    case GLSLstd450FaceForward: return scaledTag(operand(0));
    case GLSLstd450Fma: {
      const SpaceTag a = operand(0), b = operand(1);
      const bool vector = module_.types().get(i.type).kind == TypeKind::vector;
      if (vector && !spirv::isSplat(module_, i.at(2)) && !spirv::isSplat(module_, i.at(3))) break;
      const SpaceTag scaled = spirv::isSplat(module_, i.at(2)) ? scaledTag(b)
                              : a.geometric()                  ? scaledTag(a)
                                                               : scaledTag(b);
      if (!vector && a.geometric() && b.geometric()) return unknownTag();
      return sumOf(scaled, operand(2));
    }
    case GLSLstd450FMix: {
      const SpaceTag a = operand(0), b = operand(1);
      if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
      const SpaceTag both = joined(scaledTag(a), scaledTag(b));
      if (a.kind == b.kind || both.kind == Kind::unknown) return both;
      return both.geometric() ? geometricTag(both.space, Kind::any) : both;
    }
    default: break;
  }
  SpaceTag result = neutralTag();
  for (const Id id : spirv::valueOperands(i)) {
    const SpaceTag tag = of(id);
    if (tag.kind == Kind::undefined) return {};
    if (tag.kind != Kind::neutral) result = unknownTag();
  }
  return result;
}

// FMul and FDiv, of scalars or component by component.
SpaceTag SpaceTags::evaluateProduct(const spirv::Instruction& i) const {
  SpaceTag a = of(i.at(0)), b = of(i.at(1));
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  if (a.kind == Kind::neutral && b.kind == Kind::neutral) return neutralTag();
  const bool division = i.op == Op::OpFDiv;
  if (module_.types().get(i.type).kind == TypeKind::vector) {
    if (spirv::isSplat(module_, i.at(1))) return scaledTag(a);
    if (!division && spirv::isSplat(module_, i.at(0))) return scaledTag(b);
    return unknownTag();
  }
  if (a.geometric() && !b.geometric()) return scaledTag(a);
  if (!division && b.geometric() && !a.geometric()) return scaledTag(b);
  return unknownTag();
}

SpaceTag SpaceTags::vectorOf(std::span<const SpaceTag> components) const {
  SpaceTag result;
  bool neutral = false;
  for (std::size_t k = 0; k < components.size(); ++k) {
    SpaceTag tag = components[k];
    if (tag.kind == Kind::undefined) return {};
    if (tag.kind == Kind::neutral) {
      neutral = true;
      continue;
    }
    if (!tag.geometric() || tag.component != k) return unknownTag();
    tag.component = kWholeVector;
    if (tag.translation) tag.index = 0;
    result = joined(result, tag);
  }
  if (result.kind == Kind::undefined) return neutralTag();
  if (neutral && result.geometric()) return geometricTag(result.space, Kind::any);
  return result;
}

SpaceTag SpaceTags::construct(const spirv::Instruction& i) const {
  const spirv::Type& type = module_.types().get(i.type);
  if (type.kind == TypeKind::matrix) return constructMatrix(i);
  if (type.kind != TypeKind::vector) return unknownTag();
  // Operands can be vectors.
  std::array<SpaceTag, 4> components;
  std::size_t count = 0;
  std::optional<double> last;
  for (const Id id : i.operands) {
    const spirv::Instruction* definition = module_.definition(id);
    if (!definition) return unknownTag();
    const spirv::Type& part = module_.types().get(definition->type);
    const SpaceTag tag = of(id);
    const std::uint32_t n = part.kind == TypeKind::vector ? part.count : 1;
    for (std::uint32_t k = 0; k < n && count < 4; ++k) components[count++] = n == 1 ? tag : componentOf(tag, k);
    last = n == 1 ? module_.constantFloat(id) : std::nullopt;
  }
  if (count < 3) {
    const bool neutral = std::all_of(components.begin(), components.begin() + static_cast<std::ptrdiff_t>(count),
                                     [](const SpaceTag& tag) { return tag.kind == Kind::neutral; });
    const auto isWeight = [&](std::size_t k) {
      return components[k].kind == Kind::barycentric && components[k].component == k;
    };
    if (count == 2 && isWeight(0) && isWeight(1)) {
      components[0].component = kWholeVector;
      return components[0];
    }
    return neutral ? neutralTag() : unknownTag();
  }
  SpaceTag result = vectorOf(std::span(components).first(3));
  if (count == 4 && (result.geometric() || result.kind == Kind::neutral || result.kind == Kind::unknown)) {
    if (components[3].kind == Kind::undefined) return {};
    result.w = last == 0.0 ? SpaceTag::W::zero : last == 1.0 ? SpaceTag::W::one : SpaceTag::W::other;
    // vec4(rows[i].xyz, rows[i].w) and the like are not followed.
    if (result.kind == Kind::neutral && components[3].kind != Kind::neutral) return unknownTag();
  }
  return result;
}

SpaceTag SpaceTags::constructMatrix(const spirv::Instruction& i) const {
  std::vector<SpaceTag> columns;
  for (const Id id : i.operands) {
    columns.push_back(of(id));
    if (columns.back().kind == Kind::undefined) return {};
  }
  if (columns.size() < 3) return unknownTag();
  const auto all = [&](auto&& test) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (!test(columns[k], k)) return false;
    return true;
  };
  const SpaceTag first = columns.front();
  if (all([](const SpaceTag& c, std::size_t) { return c.kind == Kind::neutral; })) return neutralTag();
  if (all([&](const SpaceTag& c, std::size_t k) {
        return k < 3 ? c.column && c.map == first.map && c.index == k : c.translation;
      }))
    return matrixTag(first.map, false);
  if (all([&](const SpaceTag& c, std::size_t k) {
        return k < 3 && c.kind == Kind::row && c.map == first.map && c.index == k;
      }))
    return matrixTag(first.map, true);
  if (columns.size() == 3 && all([&](const SpaceTag& c, std::size_t) {
        return c.geometric() && c.whole() && c.space == first.space && !c.column;
      })) {
    SpaceTag tag;
    tag.kind = Kind::frame;
    tag.space = first.space;
    return tag;
  }
  return unknownTag();
}

SpaceTag SpaceTags::shuffle(const spirv::Instruction& i) const {
  const SpaceTag a = of(i.at(0)), b = of(i.at(1));
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  const spirv::Instruction* first = module_.definition(i.at(0));
  const std::uint32_t size = first ? module_.types().get(first->type).count : 0;
  std::array<SpaceTag, 4> components;
  const std::size_t count = std::min<std::size_t>(i.operands.size() - 2, 4);
  bool prefix = count >= 3;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t at = i.at(2 + k);
    prefix = prefix && at == k;
    components[k] = at < size ? componentOf(a, at) : componentOf(b, at - size);
  }
  if (prefix && (a.kind == Kind::row || a.geometric()) && count == 3) {
    SpaceTag tag = a;
    tag.w = SpaceTag::W::none;
    return tag;
  }
  if (count < 3) return a.kind == Kind::neutral && b.kind == Kind::neutral ? neutralTag() : unknownTag();
  SpaceTag result = vectorOf(std::span(components).first(3));
  if (count == 4 && result.kind != Kind::unknown) result.w = SpaceTag::W::other;
  return result;
}

// The product of a row and a vector is a component of a transformed vector.
SpaceTag SpaceTags::dot(const spirv::Instruction& i) const {
  SpaceTag row = of(i.at(0)), vector = of(i.at(1));
  if (row.kind == Kind::undefined || vector.kind == Kind::undefined) return {};
  if (row.kind != Kind::row) std::swap(row, vector);
  if (row.kind != Kind::row)
    return row.kind == Kind::neutral && vector.kind == Kind::neutral ? neutralTag() : unknownTag();
  if (vector.kind == Kind::row || (vector.geometric() && !vector.whole())) return unknownTag();
  const bool affine = module_.types().get(module_.definition(i.at(0))->type).count == 4;
  SpaceTag result = transformed({row.map, false, affine}, vector);
  result.component = row.index;
  result.w = SpaceTag::W::none;
  return result;
}

SpaceTag SpaceTags::matrixProduct(const SpaceTag& a, const SpaceTag& b) const {
  if (a.kind == Kind::undefined || b.kind == Kind::undefined) return {};
  if (a.kind == Kind::neutral && b.kind == Kind::neutral) return neutralTag();
  if (a.kind != Kind::matrix || b.kind != Kind::matrix || a.transposed != b.transposed) return unknownTag();
  const SpaceMap& inner = a.transposed ? a.map : b.map;
  const SpaceMap& outer = a.transposed ? b.map : a.map;
  if (inner.to != outer.from || inner.from == outer.to) return unknownTag();
  return matrixTag({inner.from, outer.to}, a.transposed);
}

bool SpaceTags::isAffine(Id matrix) const {
  const spirv::Instruction* definition = module_.definition(matrix);
  if (!definition) return false;
  const spirv::Type& type = module_.types().get(definition->type);
  const SpaceTag tag = of(matrix);
  return (tag.transposed ? module_.types().get(type.element).count : type.count) == 4;
}

std::optional<SpaceTags::Product> SpaceTags::product(const spirv::Instruction& i) const {
  if (i.op == Op::OpMatrixTimesVector || i.op == Op::OpVectorTimesMatrix) {
    const bool left = i.op == Op::OpVectorTimesMatrix;
    const Id matrix = i.at(left ? 1 : 0), vector = i.at(left ? 0 : 1);
    const SpaceTag tag = of(matrix);
    if (tag.kind != Kind::matrix) return {};
    // The transpose of an affine matrix adds a fourth component, which is not used: vec3(normal * matrix).
    const bool transposed = tag.transposed != left;
    return Product{transformOf(tag.map, transposed, !transposed && isAffine(matrix)), of(vector), vector, matrix};
  }
  if (i.op == Op::OpCompositeConstruct && module_.types().get(i.type).kind == TypeKind::vector &&
      i.operands.size() >= 3) {
    const spirv::Instruction* first = module_.definition(i.at(0));
    bool translated = false;
    if (first && first->op == Op::OpFAdd) {
      translated = of(first->at(1)).translation || of(first->at(0)).translation;
      if (!translated) return {};
      first = module_.definition(first->at(of(first->at(1)).translation ? 0 : 1));
    }
    if (!first || first->op != Op::OpDot) return {};
    const bool swapped = of(first->at(0)).kind != Kind::row;
    const Id row = first->at(swapped ? 1 : 0), vector = first->at(swapped ? 0 : 1);
    const SpaceTag tag = of(row);
    if (tag.kind != Kind::row || tag.index != 0) return {};
    SpaceTag operand = of(vector);
    const bool affine = module_.types().get(module_.definition(row)->type).count == 4;
    if (translated && !affine) operand.w = SpaceTag::W::one;
    return Product{{tag.map, false, affine || translated}, operand, vector, row};
  }
  if (i.op == Op::OpFAdd) {
    const SpaceTag a = of(i.at(0)), b = of(i.at(1));
    if (a.kind != Kind::term || b.kind != Kind::term || (a.index | b.index) != 7 || (a.index & b.index) != 0) return {};
    SpaceTag vector = geometricTag(a.map.from, a.operand);
    return Product{{a.map, a.covariant, false}, vector, 0, i.at(0)};
  }
  return {};
}

}  // namespace quintet::check
