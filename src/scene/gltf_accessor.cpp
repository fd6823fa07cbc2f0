#include "scene/gltf_accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <type_traits>

#include "base/parallel.h"
#include "scene/gltf_accessor_layout.h"
#include "scene/triangles.h"

namespace quintet::scene {
namespace {

// Elements that no buffer backs cost nothing in the file: without a limit a line of JSON fills the memory.
constexpr std::size_t kMaxUnbackedCount = std::size_t{1} << 24;

template <class T>
T load(const std::byte* source) {
  T value;
  std::memcpy(&value, source, sizeof value);
  return value;
}

// Calls f with a value of the accessor's component type, so that a loop over elements has it as a constant.
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

// glTF 2.0 section 3.6.2.2: c / 127, at least -1 (and so on for the other types).
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
                                             const std::string& place) {
  const auto& sparse = accessor.sparse;
  const std::size_t size = componentSize(sparse.indices.componentType);
  std::vector<std::uint32_t> indices(static_cast<std::size_t>(sparse.count));
  const auto bytes = document.view(sparse.indices.bufferView);
  if (indices.empty()) return indices;
  copyElements<1>(bytes.data() + sparse.indices.byteOffset, size, indices.size(), sparse.indices.componentType, false,
                  indices.data());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= accessor.count)
      document.fail(place,
                    fmt::format("element {} is {}, but the accessor has {} elements", i, indices[i], accessor.count));
    if (i > 0 && indices[i] <= indices[i - 1])
      document.fail(
          place, fmt::format("element {} is {}, after {}: the indices must increase", i, indices[i], indices[i - 1]));
  }
  return indices;
}

template <class Element>
using ComponentOf =
    std::conditional_t<std::is_same_v<Element, std::uint32_t> || std::is_same_v<Element, uvec3>, std::uint32_t,
                       std::conditional_t<std::is_same_v<Element, glm::u16vec4>, std::uint16_t, float>>;

// The accessor's data as they lie in the file, if they are elements of that very type, `perElement` of the accessor's
// own to each; else empty. A vector made from them is written once, not cleared first.
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

// Reads an accessor whose type has been checked into elements of N components of type Out.
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
        fmt::format("{} elements without a buffer view; at most {} are read", accessor.count, kMaxUnbackedCount));
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

void expectType(const Document& document, int index, int type, std::string_view place) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.type != type)
    document.fail(place,
                  fmt::format("accessor {} is {}, but {} is needed", index, typeName(accessor.type), typeName(type)));
}

template <std::size_t N, class Element>
std::vector<Element> readVectors(const Document& document, int index, int type, std::string_view place,
                                 Integers integers) {
  expectType(document, index, type, place);
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    document.fail(place, fmt::format("accessor {} has unsigned ints; floats, bytes or shorts are needed", index));
  return readElements<N, Element>(document, index, accessor.normalized || integers == Integers::unit);
}

void expectUnsigned(const Document& document, int index, std::initializer_list<int> allowed, std::string_view place) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  if (std::find(allowed.begin(), allowed.end(), accessor.componentType) == allowed.end())
    document.fail(place, fmt::format("accessor {} has {}; unsigned integers are needed", index,
                                     componentName(accessor.componentType)));
}

}  // namespace

std::vector<float> readFloats(const Document& document, int index, std::string_view place, Integers integers) {
  return readVectors<1, float>(document, index, TINYGLTF_TYPE_SCALAR, place, integers);
}
std::vector<vec2> readVec2(const Document& document, int index, std::string_view place, Integers integers) {
  return readVectors<2, vec2>(document, index, TINYGLTF_TYPE_VEC2, place, integers);
}
std::vector<vec3> readVec3(const Document& document, int index, std::string_view place, Integers integers) {
  return readVectors<3, vec3>(document, index, TINYGLTF_TYPE_VEC3, place, integers);
}
std::vector<vec4> readVec4(const Document& document, int index, std::string_view place, Integers integers) {
  return readVectors<4, vec4>(document, index, TINYGLTF_TYPE_VEC4, place, integers);
}

std::vector<vec4> readColors(const Document& document, int index, std::string_view place) {
  if (document.model.accessors[static_cast<std::size_t>(index)].type != TINYGLTF_TYPE_VEC3)
    return readVec4(document, index, place, Integers::unit);
  const std::vector<vec3> rgb = readVec3(document, index, place, Integers::unit);
  std::vector<vec4> result(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) result[i] = vec4(rgb[i], 1.0f);
  return result;
}

std::vector<mat4> readMat4(const Document& document, int index, std::string_view place) {
  expectType(document, index, TINYGLTF_TYPE_MAT4, place);
  if (document.model.accessors[static_cast<std::size_t>(index)].componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
    document.fail(place, fmt::format("accessor {} must have floats", index));
  return readElements<16, mat4>(document, index, false);
}

std::vector<std::uint32_t> readIndices(const Document& document, int index, std::string_view place) {
  expectType(document, index, TINYGLTF_TYPE_SCALAR, place);
  expectUnsigned(document, index,
                 {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                  TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                 place);
  return readElements<1, std::uint32_t>(document, index, false);
}

std::vector<uvec3> readTriangleList(const Document& document, int index, std::size_t vertexCount,
                                    std::string_view place) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  std::vector<uvec3> triangles;
  if (accessor.type == TINYGLTF_TYPE_SCALAR) {
    const auto direct = directElements<uvec3>(document, accessor, 3);
    triangles.assign(direct.begin(), direct.end());
  }
  // What follows the last whole triangle is checked, too.
  if (triangles.empty() || accessor.count % 3 != 0) {
    const std::vector<std::uint32_t> indices = readIndices(document, index, place);
    checkIndices(document, indices, vertexCount, place);
    return makeTriangles(TriangleMode::list, indices, static_cast<std::uint32_t>(vertexCount));
  }
  static_assert(sizeof(uvec3) == 3 * sizeof(std::uint32_t));
  checkIndices(document, {&triangles[0].x, 3 * triangles.size()}, vertexCount, place);
  return triangles;
}

void checkIndices(const Document& document, std::span<const std::uint32_t> indices, std::size_t vertexCount,
                  std::string_view place) {
  std::atomic<std::size_t> wrong = indices.size();  // the first one
  parallelRanges(indices.size(), [&](std::size_t first, std::size_t last) {
    const auto part = indices.subspan(first, last - first);
    const auto found = std::ranges::find_if(part, [&](std::uint32_t i) { return i >= vertexCount; });
    if (found == part.end()) return;
    const std::size_t at = first + static_cast<std::size_t>(found - part.begin());
    for (std::size_t known = wrong; at < known && !wrong.compare_exchange_weak(known, at);) {
    }
  });
  if (wrong < indices.size())
    document.fail(
        place, fmt::format("element {} is {}, but there are {} vertices", wrong.load(), indices[wrong], vertexCount));
}

std::vector<glm::u16vec4> readJoints(const Document& document, int index, std::string_view place) {
  expectType(document, index, TINYGLTF_TYPE_VEC4, place);
  expectUnsigned(document, index, {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT},
                 place);
  return readElements<4, glm::u16vec4>(document, index, false);
}

}  // namespace quintet::scene
