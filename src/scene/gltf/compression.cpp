// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/compression.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <span>

#include "base/plural.h"
#include "scene/gltf/extensions.h"
#include "scene/gltf/meshopt.h"

namespace quintet::scene {
namespace {

// ---- meshopt ----

// What the codecs can reach: 64 : 1 for vertices in version 0, 1024 : 1 in version 1 (two bits for each of up to 256 equal
// bytes), one byte per triangle or index. Data that states a higher ratio is invalid, and the stated size must not be
// allocated.
constexpr std::size_t kMaxRatio = 128, kMaxRatioVersion1 = 1024;

bool strideFits(const std::string& mode, const std::string& filter, std::size_t stride) {
  if (mode != "ATTRIBUTES") return stride == 2 || stride == 4;
  if (filter == "OCTAHEDRAL" || filter == "COLOR") return stride == 4 || stride == 8;
  if (filter == "QUATERNION") return stride == 8;
  return stride % 4 == 0 && stride <= 256;
}

// Returns whether the data is valid.
bool decode(const std::string& mode, std::span<std::byte> out, std::size_t stride, std::span<const std::byte> in) {
  const auto* data = reinterpret_cast<const unsigned char*>(in.data());
  const std::size_t count = out.size() / stride;
  if (mode == "TRIANGLES") return meshopt_decodeIndexBuffer(out.data(), count, stride, data, in.size()) == 0;
  if (mode == "INDICES") return meshopt_decodeIndexSequence(out.data(), count, stride, data, in.size()) == 0;
  if (isMeshoptVersion1(in)) return decodeMeshoptVersion1(out, stride, in);
  return meshopt_decodeVertexBuffer(out.data(), count, stride, data, in.size()) == 0;
}

void applyFilter(const std::string& filter, std::span<std::byte> data, std::size_t stride) {
  const std::size_t count = data.size() / stride;
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(data.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(data.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(data.data(), count, stride);
  if (filter == "COLOR") decodeMeshoptColors(data, stride);
}

}  // namespace

FileBytes decodeMeshopt(const Document& document, const tinygltf::BufferView& view, const std::string& name,
                        const std::string& location) {
  const tinygltf::Value& extension = *findExtension(view.extensions, name);
  const auto size = [&](const char* key) { return static_cast<std::size_t>(indexOf(extension, key, 0)); };
  const std::size_t buffer = size("buffer"), offset = size("byteOffset"), length = size("byteLength");
  const std::span<const std::byte> bytes = document.buffers[buffer].data;
  const std::size_t stride = size("byteStride"), count = size("count");
  const std::string mode = stringOf(extension, "mode", ""), filter = stringOf(extension, "filter", "NONE");

  if (offset + length > bytes.size())
    document.fail(location, fmt::format("extends {} past the end of buffer {}",
                                        counted(offset + length - bytes.size(), "byte"), buffer));
  if (!strideFits(mode, filter, stride))
    document.fail(location + "/byteStride",
                  fmt::format("{} is not valid for mode {} with filter {}", stride, mode, filter));
  if (view.byteStride != 0 && view.byteStride != stride)
    document.fail(location + "/byteStride", fmt::format("{}, but the buffer view states {}", stride, view.byteStride));
  if (mode == "TRIANGLES" && count % 3 != 0)
    document.fail(location + "/count", fmt::format("{} is not a multiple of 3", count));
  if (mode != "ATTRIBUTES" && filter != "NONE")
    document.fail(location + "/filter", "only attributes can have a filter");
  const std::span<const std::byte> stream = bytes.subspan(offset, length);
  const bool version1 = mode == "ATTRIBUTES" && isMeshoptVersion1(stream);
  if (count * stride > (version1 ? kMaxRatioVersion1 : kMaxRatio) * length)
    document.fail(location + "/count",
                  fmt::format("{} cannot hold {}", counted(length, "byte"), counted(count, "element")));

  document.budget->take(count * stride);
  FileBytes result(count * stride);
  if (count == 0) return result;
  if (!decode(mode, result, stride, stream)) document.fail(location, "invalid compressed data");
  applyFilter(filter, result, stride);
  return result;
}

// ---- Draco ----

namespace {

// Number of triangles that the header of the stream states (Draco bitstream specification 2.2, sections 2.1 and 2.3);
// 0 if metadata precedes it or the stream is truncated.
std::uint64_t claimedTriangles(std::span<const std::byte> stream) {
  const auto byte = [&](std::size_t i) { return i < stream.size() ? std::to_integer<std::uint64_t>(stream[i]) : 0; };
  std::size_t at = 11;  // after "DRACO", version (2 bytes), type, method, flags (2 bytes)
  const auto varint = [&] {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      value |= (byte(at) & 0x7F) << shift;
      if (byte(at++) < 0x80) break;
    }
    return value;
  };
  constexpr std::uint64_t kEdgebreaker = 1, kHasMetadata = 0x80;
  if (byte(10) & kHasMetadata) return 0;
  if (byte(8) == kEdgebreaker) {
    ++at;      // traversal type
    varint();  // vertices
  }
  return varint();
}

// Far above what Draco reaches (about 8). Decoding a stream that claims more could take minutes and gigabytes.
constexpr std::uint64_t kMaxTrianglesPerByte = 256;

// Bytes that the decoder requires per triangle: its corner table, and the attributes of a vertex.
constexpr std::uint64_t kDracoMemory = 80;

}  // namespace

struct DracoMesh::State {
  const Document& document;
  const tinygltf::Value& attributeIds;
  std::string location;
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(const Document& document, const tinygltf::Primitive& primitive, const tinygltf::Value& extension,
                     std::string location)
    : state_(new State{document, extension.Get("attributes"), std::move(location), nullptr}) {
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    document.fail(state_->location, "only TRIANGLES and TRIANGLE_STRIP can be compressed");
  const auto bytes = document.view(indexOf(extension, "bufferView"));
  if (const std::uint64_t claimed = claimedTriangles(bytes); claimed > kMaxTrianglesPerByte * bytes.size())
    document.fail(state_->location,
                  fmt::format("{} cannot hold {}", counted(bytes.size(), "byte"), counted(claimed, "triangle")));
  document.budget->take(kDracoMemory * claimedTriangles(bytes));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    document.fail(state_->location, fmt::format("invalid Draco stream ({})", decoded.status().error_msg_string()));
  state_->mesh = std::move(decoded).value();
}

DracoMesh::~DracoMesh() = default;

bool DracoMesh::has(const std::string& attribute) const { return state_->attributeIds.Has(attribute); }

std::vector<std::uint32_t> DracoMesh::indices() const {
  const draco::Mesh& mesh = *state_->mesh;
  std::vector<std::uint32_t> result;
  result.reserve(std::size_t{3} * mesh.num_faces());
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (std::size_t c = 0; c < 3; ++c) result.push_back(mesh.face(f)[c].value());
  return result;
}

template <class Vec>
std::vector<Vec> DracoMesh::read(const std::string& name, const std::string& location) const {
  const draco::Mesh& mesh = *state_->mesh;
  const int id = indexOf(state_->attributeIds, name);
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  const std::string idLocation = fmt::format("{}/attributes/{}", state_->location, name);
  if (!attribute) state_->document.fail(idLocation, fmt::format("the Draco stream has no attribute {}", id));
  const int needed = static_cast<int>(Vec::length()), have = attribute->num_components();
  if (have != needed && !(name.starts_with("COLOR") && have == 3))
    state_->document.fail(location,
                          fmt::format("{} in the Draco stream, expected {}", counted(have, "component"), needed));

  std::vector<Vec> values(mesh.num_points(), Vec(1));
  for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex value = attribute->mapped_index(p);
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue(value, static_cast<std::int8_t>(have), &values[p.value()][0]))
      state_->document.fail(idLocation, fmt::format("vertex {} has no value in the Draco stream", p.value()));
  }
  return values;
}

template std::vector<vec2> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<vec3> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<vec4> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<glm::u16vec4> DracoMesh::read(const std::string&, const std::string&) const;

}  // namespace quintet::scene
