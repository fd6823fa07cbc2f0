// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <type_traits>

#include "base/plural.h"
#include "scene/gltf/compression.h"
#include "scene/gltf/extensions.h"

namespace quintet::scene {
namespace {

// ---- Bounds ----

std::size_t componentCount(int type) {
  return static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
}

// Bytes.
std::size_t componentSize(int componentType) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(componentType)));
}

// Bytes. The columns of a matrix start at multiples of four.
std::size_t elementSize(const tinygltf::Accessor& accessor) {
  const std::size_t size = componentSize(accessor.componentType);
  const auto matrix = [size](std::size_t n) { return n * ((n * size + 3) / 4 * 4); };
  switch (accessor.type) {
    case TINYGLTF_TYPE_MAT2: return matrix(2);
    case TINYGLTF_TYPE_MAT3: return matrix(3);
    case TINYGLTF_TYPE_MAT4: return matrix(4);
    default: return size * componentCount(accessor.type);
  }
}

// Bytes, of an accessor with a buffer view.
std::size_t strideOf(const Document& document, const tinygltf::Accessor& accessor) {
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  return view.byteStride ? view.byteStride : elementSize(accessor);
}

// No overflow, because count < 2^32, stride <= 252 and offset < 2^53.
void checkRange(const Document& document, int view, std::size_t offset, std::size_t count, std::size_t stride,
                std::size_t size, const std::string& location) {
  const auto& bytes = document.bufferViews[static_cast<std::size_t>(view)];
  const std::size_t available =
      bytes.data() ? bytes.size() : document.model.bufferViews[static_cast<std::size_t>(view)].byteLength;
  const std::size_t end = count == 0 ? 0 : offset + (count - 1) * stride + size;
  if (end > available)
    document.fail(location + "/bufferView",
                  fmt::format("extends {} past the end of buffer view {}", counted(end - available, "byte"), view));
}

void checkSparse(const Document& document, const tinygltf::Accessor& accessor, const std::string& location) {
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > accessor.count)
    document.fail(location + "/count", fmt::format("{}, but the accessor has {}", counted(count, "value"),
                                                   counted(accessor.count, "element")));
  const std::size_t indexSize = componentSize(sparse.indices.componentType);
  checkRange(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count, indexSize,
             indexSize, location + "/indices");
  const std::size_t size = elementSize(accessor);
  checkRange(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count, size, size,
             location + "/values");
}

// ---- Conversion ----

// Limit for accessors without a buffer view. Their elements take no space in the file, so a line of JSON could
// otherwise fill the memory.
constexpr std::size_t kMaxUnbackedCount = std::size_t{1} << 24;

template <class T>
T load(const std::byte* source) {
  T value;
  std::memcpy(&value, source, sizeof value);
  return value;
}

// Calls f with a value of the component type, so that a loop over elements knows the type at compile time.
template <class F>
void withType(int componentType, F&& f) {
  switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return f(std::int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return f(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_SHORT: return f(std::int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return f(std::uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return f(std::uint32_t{});
    default: return f(float{});
  }
}

// glTF 2.0 section 3.6.2.2: max(c / 127, -1) for signed bytes, and likewise for the other types.
template <class T, class Out>
Out convert(T value, bool normalized) {
  if constexpr (std::is_integral_v<Out>) {
    return static_cast<Out>(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return value;
  } else {
    const auto f = static_cast<float>(value);
    return normalized ? std::max(f / static_cast<float>(std::numeric_limits<T>::max()), -1.0f) : f;
  }
}

// Copies `count` elements of N components each.
template <std::size_t N, class Out>
void copyElements(const std::byte* source, std::size_t stride, std::size_t count, int componentType, bool normalized,
                  Out* out) {
  withType(componentType, [&](auto zero) {
    using T = decltype(zero);
    if (std::is_same_v<T, Out> && stride == N * sizeof(T)) {
      std::memcpy(out, source, count * N * sizeof(T));
      return;
    }
    for (std::size_t i = 0; i < count; ++i, source += stride, out += N)
      for (std::size_t c = 0; c < N; ++c) out[c] = convert<T, Out>(load<T>(source + c * sizeof(T)), normalized);
  });
}

std::vector<std::uint32_t> readSparseIndices(const Document& document, const tinygltf::Accessor& accessor,
                                             const std::string& location) {
  const auto& sparse = accessor.sparse;
  const std::size_t size = componentSize(sparse.indices.componentType);
  std::vector<std::uint32_t> indices(static_cast<std::size_t>(sparse.count));
  const auto bytes = document.view(sparse.indices.bufferView);
  if (indices.empty()) return indices;
  copyElements<1>(bytes.data() + sparse.indices.byteOffset, size, indices.size(), sparse.indices.componentType, false,
                  indices.data());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= accessor.count)
      document.fail(location, fmt::format("element {} is {}, but the accessor has {}", i, indices[i],
                                          counted(accessor.count, "element")));
    if (i > 0 && indices[i] <= indices[i - 1])
      document.fail(location,
                    fmt::format("element {} is {} after {}; the indices must increase", i, indices[i], indices[i - 1]));
  }
  return indices;
}

template <class Element>
using ComponentOf =
    std::conditional_t<std::is_same_v<Element, std::uint32_t> || std::is_same_v<Element, uvec3>, std::uint32_t,
                       std::conditional_t<std::is_same_v<Element, glm::u16vec4>, std::uint16_t, float>>;

// The accessor's data in the file's own memory, if its type, stride and alignment match Element, each of which covers
// `perElement` elements of the accessor; else empty. A vector copied from it is written once, not cleared first.
template <class Element>
std::span<const Element> directElements(const Document& document, const tinygltf::Accessor& accessor,
                                        std::size_t perElement = 1) {
  using Out = ComponentOf<Element>;
  bool same = false;
  withType(accessor.componentType, [&](auto zero) { same = std::is_same_v<decltype(zero), Out>; });
  if (!same || accessor.bufferView == kNone || accessor.count == 0 || accessor.sparse.isSparse) return {};
  if (strideOf(document, accessor) * perElement != sizeof(Element)) return {};
  const std::byte* source = document.view(accessor.bufferView).data() + accessor.byteOffset;
  if (reinterpret_cast<std::uintptr_t>(source) % alignof(Out) != 0) return {};
  return {reinterpret_cast<const Element*>(source), accessor.count / perElement};
}

// Reads an accessor whose type has been checked. N is the number of components of an element.
template <std::size_t N, class Element>
std::vector<Element> readElements(const Document& document, int index, bool normalized) {
  using Out = ComponentOf<Element>;
  static_assert(sizeof(Element) == N * sizeof(Out));
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (const auto direct = directElements<Element>(document, accessor); !direct.empty())
    return std::vector<Element>(direct.begin(), direct.end());
  if (accessor.bufferView == kNone && accessor.count > kMaxUnbackedCount)
    document.fail(
        fmt::format("/accessors/{}/count", index),
        fmt::format("{} elements without a buffer view; the maximum is {}", accessor.count, kMaxUnbackedCount));
  std::vector<Element> result(accessor.count);
  Out* out = reinterpret_cast<Out*>(result.data());
  if (accessor.bufferView != kNone && accessor.count > 0) {
    const auto bytes = document.view(accessor.bufferView);
    copyElements<N>(bytes.data() + accessor.byteOffset, strideOf(document, accessor), accessor.count,
                    accessor.componentType, normalized, out);
  }
  if (accessor.sparse.isSparse) {
    const auto indices = readSparseIndices(document, accessor, fmt::format("/accessors/{}/sparse/indices", index));
    std::vector<Element> values(indices.size());
    const auto bytes = document.view(accessor.sparse.values.bufferView);
    if (!values.empty())
      copyElements<N>(bytes.data() + accessor.sparse.values.byteOffset, elementSize(accessor), values.size(),
                      accessor.componentType, normalized, reinterpret_cast<Out*>(values.data()));
    for (std::size_t i = 0; i < indices.size(); ++i) result[indices[i]] = values[i];
  }
  return result;
}

const char* typeName(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR: return "SCALAR";
    case TINYGLTF_TYPE_VEC2: return "VEC2";
    case TINYGLTF_TYPE_VEC3: return "VEC3";
    case TINYGLTF_TYPE_VEC4: return "VEC4";
    case TINYGLTF_TYPE_MAT2: return "MAT2";
    case TINYGLTF_TYPE_MAT3: return "MAT3";
    default: return "MAT4";
  }
}

const char* componentName(int componentType) {
  switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return "signed bytes";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return "unsigned bytes";
    case TINYGLTF_COMPONENT_TYPE_SHORT: return "signed shorts";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return "unsigned shorts";
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return "unsigned ints";
    default: return "floats";
  }
}

void expectType(const Document& document, int index, int type, std::string_view location) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.type != type)
    document.fail(location,
                  fmt::format("accessor {} has type {}, expected {}", index, typeName(accessor.type), typeName(type)));
}

[[noreturn]] void failComponents(const Document& document, int index, std::string_view location,
                                 std::string_view expected) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  document.fail(location,
                fmt::format("accessor {} has {}, expected {}", index, componentName(accessor.componentType), expected));
}

template <std::size_t N, class Element>
std::vector<Element> readVectors(const Document& document, int index, int type, std::string_view location,
                                 Integers integers) {
  expectType(document, index, type, location);
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    failComponents(document, index, location, "floats, bytes or shorts");
  return readElements<N, Element>(document, index, accessor.normalized || integers == Integers::unit);
}

void expectUnsigned(const Document& document, int index, std::initializer_list<int> allowed,
                    std::string_view location) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (std::find(allowed.begin(), allowed.end(), accessor.componentType) != allowed.end()) return;
  // "unsigned bytes, unsigned shorts or unsigned ints"
  std::string expected;
  for (const int* type = allowed.begin(); type != allowed.end(); ++type)
    expected += (type == allowed.begin()     ? ""
                 : type + 1 == allowed.end() ? " or "
                                             : ", ") +
                std::string(componentName(*type));
  failComponents(document, index, location, expected);
}

}  // namespace

void resolveBufferViews(Document& document) {
  for (std::size_t i = 0; i < document.model.bufferViews.size(); ++i) {
    const tinygltf::BufferView& view = document.model.bufferViews[i];
    const std::string location = fmt::format("/bufferViews/{}", i);
    const bool compressed = view.extensions.contains(kMeshopt);
    if (compressed || view.extensions.contains(kOldMeshopt)) {
      const char* name = compressed ? kMeshopt : kOldMeshopt;
      document.bufferViews.push_back(document.storage.emplace_back(
          decodeMeshopt(document, view, name, fmt::format("{}/extensions/{}", location, name))));
      continue;
    }
    const Buffer& buffer = document.buffers[static_cast<std::size_t>(view.buffer)];
    const std::size_t end = view.byteOffset + view.byteLength;  // both < 2^53
    if (end > buffer.byteLength)
      document.fail(location, fmt::format("extends {} past the end of buffer {}",
                                          counted(end - buffer.byteLength, "byte"), view.buffer));
    document.bufferViews.push_back(buffer.data.data() ? buffer.data.subspan(view.byteOffset, view.byteLength)
                                                      : std::span<const std::byte>{});
  }
}

void checkAccessors(const Document& document) {
  for (std::size_t i = 0; i < document.model.accessors.size(); ++i) {
    const tinygltf::Accessor& accessor = document.model.accessors[i];
    const std::string location = fmt::format("/accessors/{}", i);
    if (accessor.bufferView != kNone) {
      const std::size_t stride = strideOf(document, accessor), size = elementSize(accessor);
      if (stride < size)
        document.fail(location,
                      fmt::format("the element size is {}, but byteStride is {}", counted(size, "byte"), stride));
      checkRange(document, accessor.bufferView, accessor.byteOffset, accessor.count, stride, size, location);
    }
    if (accessor.sparse.isSparse) checkSparse(document, accessor, location + "/sparse");
  }
}

std::vector<float> readFloats(const Document& document, int index, std::string_view location, Integers integers) {
  return readVectors<1, float>(document, index, TINYGLTF_TYPE_SCALAR, location, integers);
}
std::vector<vec2> readVec2(const Document& document, int index, std::string_view location, Integers integers) {
  return readVectors<2, vec2>(document, index, TINYGLTF_TYPE_VEC2, location, integers);
}
std::vector<vec3> readVec3(const Document& document, int index, std::string_view location, Integers integers) {
  return readVectors<3, vec3>(document, index, TINYGLTF_TYPE_VEC3, location, integers);
}
std::vector<vec4> readVec4(const Document& document, int index, std::string_view location, Integers integers) {
  return readVectors<4, vec4>(document, index, TINYGLTF_TYPE_VEC4, location, integers);
}

std::vector<vec4> readColors(const Document& document, int index, std::string_view location) {
  if (document.model.accessors[static_cast<std::size_t>(index)].type != TINYGLTF_TYPE_VEC3)
    return readVec4(document, index, location, Integers::unit);
  const std::vector<vec3> rgb = readVec3(document, index, location, Integers::unit);
  std::vector<vec4> result(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) result[i] = vec4(rgb[i], 1.0f);
  return result;
}

std::vector<mat4> readMat4(const Document& document, int index, std::string_view location) {
  expectType(document, index, TINYGLTF_TYPE_MAT4, location);
  if (document.model.accessors[static_cast<std::size_t>(index)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    failComponents(document, index, location, "floats");
  return readElements<16, mat4>(document, index, false);
}

std::vector<std::uint32_t> readIndices(const Document& document, int index, std::string_view location) {
  expectType(document, index, TINYGLTF_TYPE_SCALAR, location);
  expectUnsigned(document, index,
                 {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                  TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                 location);
  return readElements<1, std::uint32_t>(document, index, false);
}

std::vector<glm::u16vec4> readJoints(const Document& document, int index, std::string_view location) {
  expectType(document, index, TINYGLTF_TYPE_VEC4, location);
  expectUnsigned(document, index, {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT},
                 location);
  return readElements<4, glm::u16vec4>(document, index, false);
}

std::span<const uvec3> directTriangles(const Document& document, int index) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.type != TINYGLTF_TYPE_SCALAR) return {};
  return directElements<uvec3>(document, accessor, 3);
}

}  // namespace quintet::scene
