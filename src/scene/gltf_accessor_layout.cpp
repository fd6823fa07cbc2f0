#include "scene/gltf_accessor_layout.h"

#include <fmt/format.h>

namespace quintet::scene {
namespace {

std::size_t componentCount(int type) {
  return static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
}

// count < 2^32, stride <= 252, offset < 2^53: no sum or product here overflows.
void checkRange(const Document& document, int view, std::size_t offset, std::size_t count, std::size_t stride,
                std::size_t size, const std::string& place) {
  const auto& bytes = document.bufferViews[static_cast<std::size_t>(view)];
  const std::size_t have =
      bytes.data() ? bytes.size() : document.model.bufferViews[static_cast<std::size_t>(view)].byteLength;
  const std::size_t end = count == 0 ? 0 : offset + (count - 1) * stride + size;
  if (end > have)
    document.fail(place + "/bufferView", fmt::format("{} bytes past the end of buffer view {}", end - have, view));
}

void checkSparse(const Document& document, const tinygltf::Accessor& accessor, const std::string& place) {
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > accessor.count)
    document.fail(place + "/count", fmt::format("{} values for an accessor of {} elements", count, accessor.count));
  const std::size_t indexSize = componentSize(sparse.indices.componentType);
  checkRange(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count, indexSize,
             indexSize, place + "/indices");
  const std::size_t size = elementSize(accessor);
  checkRange(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count, size, size,
             place + "/values");
}

}  // namespace

std::size_t componentSize(int componentType) {
  return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(componentType)));
}

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

std::size_t strideOf(const Document& document, const tinygltf::Accessor& accessor) {
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  return view.byteStride ? view.byteStride : elementSize(accessor);
}

void checkAccessors(const Document& document) {
  for (std::size_t i = 0; i < document.model.accessors.size(); ++i) {
    const tinygltf::Accessor& accessor = document.model.accessors[i];
    const std::string place = fmt::format("/accessors/{}", i);
    if (accessor.bufferView != kNone) {
      const std::size_t stride = strideOf(document, accessor), size = elementSize(accessor);
      if (stride < size)
        document.fail(place, fmt::format("elements of {} bytes with a byteStride of {}", size, stride));
      checkRange(document, accessor.bufferView, accessor.byteOffset, accessor.count, stride, size, place);
    }
    if (accessor.sparse.isSparse) checkSparse(document, accessor, place + "/sparse");
  }
}

}  // namespace quintet::scene
