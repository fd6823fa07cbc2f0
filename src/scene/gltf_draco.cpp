#include "scene/gltf_draco.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include "scene/gltf_extensions.h"

namespace quintet::scene {
namespace {

// The number of triangles that the stream claims to hold, from its header (Draco bitstream specification 2.2,
// sections 2.1 and 2.3); 0 where it comes behind metadata or is cut off.
std::uint64_t claimedTriangles(std::span<const std::byte> stream) {
  const auto byte = [&](std::size_t i) { return i < stream.size() ? std::to_integer<std::uint64_t>(stream[i]) : 0; };
  std::size_t at = 11;  // behind "DRACO", version (2 bytes), type, method, flags (2 bytes)
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

// Far beyond what Draco reaches (about 8): more is a claim that costs minutes and gigabytes to disprove.
constexpr std::uint64_t kMaxTrianglesPerByte = 256;

}  // namespace

struct DracoMesh::State {
  const Document& document;
  const tinygltf::Value& attributeIds;
  std::string place;
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::DracoMesh(const Document& document, const tinygltf::Primitive& primitive, const tinygltf::Value& extension,
                     std::string place)
    : state_(new State{document, extension.Get("attributes"), std::move(place), nullptr}) {
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP)
    document.fail(state_->place, "only TRIANGLES and TRIANGLE_STRIP can be compressed");
  const auto bytes = document.view(indexOf(extension, "bufferView"));
  if (const std::uint64_t claimed = claimedTriangles(bytes); claimed > kMaxTrianglesPerByte * bytes.size())
    document.fail(state_->place, fmt::format("{} bytes cannot hold {} triangles", bytes.size(), claimed));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    document.fail(state_->place, fmt::format("the Draco stream is broken ({})", decoded.status().error_msg_string()));
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
std::vector<Vec> DracoMesh::read(const std::string& name, const std::string& place) const {
  const draco::Mesh& mesh = *state_->mesh;
  const int id = indexOf(state_->attributeIds, name);
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  const std::string idPlace = fmt::format("{}/attributes/{}", state_->place, name);
  if (!attribute) state_->document.fail(idPlace, fmt::format("the Draco stream has no attribute {}", id));
  const int needed = static_cast<int>(Vec::length()), have = attribute->num_components();
  if (have != needed && !(name.starts_with("COLOR") && have == 3))
    state_->document.fail(place, fmt::format("{} components in the Draco stream, {} are needed", have, needed));

  std::vector<Vec> values(mesh.num_points(), Vec(1));
  for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex value = attribute->mapped_index(p);
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue(value, static_cast<std::int8_t>(have), &values[p.value()][0]))
      state_->document.fail(idPlace, fmt::format("vertex {} has no value in the Draco stream", p.value()));
  }
  return values;
}

template std::vector<vec2> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<vec3> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<vec4> DracoMesh::read(const std::string&, const std::string&) const;
template std::vector<glm::u16vec4> DracoMesh::read(const std::string&, const std::string&) const;

}  // namespace quintet::scene
