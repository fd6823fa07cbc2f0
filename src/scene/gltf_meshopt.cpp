#include "scene/gltf_meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "scene/gltf_extensions.h"

namespace quintet::scene {
namespace {

// More than the codecs can compress (64 : 1 for vertices, one byte per triangle or index): what claims
// more is broken, and its claim must not reach the memory.
constexpr std::size_t kMaxRatio = 128;

bool strideFits(const std::string& mode, const std::string& filter, std::size_t stride) {
  if (mode != "ATTRIBUTES") return stride == 2 || stride == 4;
  if (filter == "OCTAHEDRAL") return stride == 4 || stride == 8;
  if (filter == "QUATERNION") return stride == 8;
  return stride % 4 == 0 && stride <= 256;
}

int decode(const std::string& mode, std::byte* out, std::size_t count, std::size_t stride,
           std::span<const std::byte> in) {
  const auto* data = reinterpret_cast<const unsigned char*>(in.data());
  if (mode == "TRIANGLES") return meshopt_decodeIndexBuffer(out, count, stride, data, in.size());
  if (mode == "INDICES") return meshopt_decodeIndexSequence(out, count, stride, data, in.size());
  return meshopt_decodeVertexBuffer(out, count, stride, data, in.size());
}

void applyFilter(const std::string& filter, std::byte* data, std::size_t count, std::size_t stride) {
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(data, count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(data, count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(data, count, stride);
}

}  // namespace

FileBytes decodeMeshopt(const Document& document, const tinygltf::BufferView& view,
                        std::span<const std::span<const std::byte>> buffers, const std::string& place) {
  const tinygltf::Value& extension = *findExtension(view.extensions, kMeshopt);
  const auto size = [&](const char* key) { return static_cast<std::size_t>(indexOf(extension, key, 0)); };
  const std::size_t buffer = size("buffer"), offset = size("byteOffset"), length = size("byteLength");
  const std::size_t stride = size("byteStride"), count = size("count");
  const std::string mode = stringOf(extension, "mode", ""), filter = stringOf(extension, "filter", "NONE");

  if (offset + length > buffers[buffer].size())
    document.fail(place,
                  fmt::format("{} bytes past the end of buffer {}", offset + length - buffers[buffer].size(), buffer));
  if (!strideFits(mode, filter, stride))
    document.fail(place + "/byteStride", fmt::format("{} does not fit mode {} with filter {}", stride, mode, filter));
  if (view.byteStride != 0 && view.byteStride != stride)
    document.fail(place + "/byteStride", fmt::format("{}, but the buffer view says {}", stride, view.byteStride));
  if (mode == "TRIANGLES" && count % 3 != 0)
    document.fail(place + "/count", fmt::format("{} is not a multiple of 3", count));
  if (mode != "ATTRIBUTES" && filter != "NONE") document.fail(place + "/filter", "only attributes can have one");
  if (count * stride > kMaxRatio * length)
    document.fail(place + "/count", fmt::format("{} bytes cannot hold {} elements", length, count));

  FileBytes result(count * stride);
  if (count == 0) return result;
  if (decode(mode, result.data(), count, stride, buffers[buffer].subspan(offset, length)) != 0)
    document.fail(place, "the compressed data is broken");
  applyFilter(filter, result.data(), count, stride);
  return result;
}

}  // namespace quintet::scene
