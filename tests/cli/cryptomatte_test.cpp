// SPDX-License-Identifier: Apache-2.0
// Cryptomatte files, read as the specification describes (Friedman and Jones, Psyop: "Cryptomatte Specification"). This file
// implements hash, conversion and names itself and uses nothing of src/io/exr/cryptomatte. The matte of an object must equal
// an image in which this object is white and everything else is black.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <set>

#include "base/file.h"
#include "fixtures.h"
#include "io/exr/exr.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kMatteWidth = 20, kMatteHeight = 14;
constexpr std::size_t kPixels = std::size_t{kMatteWidth} * kMatteHeight;

// MurmurHash3_x86_32 with seed 0, with 64-bit integers and a padded copy of the name.
std::uint32_t hashOf(const std::string& name) {
  const auto low = [](std::uint64_t v) { return v & 0xffffffffull; };
  const auto rotate = [&](std::uint64_t v, int by) { return low(v << by) | v >> (32 - by); };
  std::uint64_t h = 0;
  std::vector<unsigned char> bytes(name.begin(), name.end());
  bytes.resize((name.size() + 3) / 4 * 4, 0);
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::uint64_t k = bytes[at] + 256ull * bytes[at + 1] + 65536ull * bytes[at + 2] + 16777216ull * bytes[at + 3];
    k = low(rotate(low(k * 3432918353ull), 15) * 461845907ull);
    h ^= k;
    if (at + 4 <= name.size()) h = low(rotate(h, 13) * 5 + 3864292196ull);
  }
  h ^= name.size();
  h = low((h ^ h >> 16) * 2246822507ull);
  h = low((h ^ h >> 13) * 3266489909ull);
  return static_cast<std::uint32_t>(h ^ h >> 16);
}

// uint32_to_float32: the bits of the hash with an exponent clamped to 1–254.
std::uint32_t idBitsOf(const std::string& name) {
  const std::uint32_t hash = hashOf(name);
  const std::uint32_t exponent = std::clamp(hash >> 23 & 255u, 1u, 254u);
  return (hash & 0x80000000u) | exponent << 23 | (hash & 0x7fffffu);
}

std::uint32_t bitsOf(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

// A reader of Cryptomatte files.
class Cryptomatte {
 public:
  Cryptomatte(io::ExrImage file, const std::string& type)
      : type_(type), image_(std::move(file)), pixels_(std::size_t{image_.width} * image_.height) {
    std::map<std::string, std::string> attributes(image_.metadata.begin(), image_.metadata.end());
    for (const auto& [key, text] : attributes)
      if (key.starts_with("cryptomatte/") && key.ends_with("/name") && text == type)
        key_ = key.substr(12, key.size() - 17);
    EXPECT_FALSE(key_.empty()) << type;
    EXPECT_LE(key_.size(), 7u);
    EXPECT_EQ(attributes["cryptomatte/" + key_ + "/hash"], "MurmurHash3_32");
    EXPECT_EQ(attributes["cryptomatte/" + key_ + "/conversion"], "uint32_to_float32");
    manifest_ = nlohmann::json::parse(attributes["cryptomatte/" + key_ + "/manifest"]);
    for (int layer = 0;; ++layer) {
      const std::string name = type + (layer < 10 ? "0" : "") + std::to_string(layer) + ".";
      if (!find(image_, name + "R")) break;
      for (const auto& [id, coverage] : {std::pair("R", "G"), std::pair("B", "A")})
        ranks_.push_back({find(image_, name + id), find(image_, name + coverage)});
    }
    for (const Rank& rank : ranks_)
      for (const io::ExrChannel* channel : {rank.id, rank.coverage}) EXPECT_EQ(channel->type, io::ExrType::f32);
  }

  Cryptomatte(const Cryptomatte&) = delete;  // pointers into image_

  const std::string& key() const { return key_; }
  const nlohmann::json& manifest() const { return manifest_; }
  std::size_t rankCount() const { return ranks_.size(); }

  // The matte of several names: the sum of the coverages of all ranks with their ids.
  std::vector<float> matte(const std::vector<std::string>& names) const {
    std::set<std::uint32_t> ids;
    for (const std::string& name : names) ids.insert(idBitsOf(name));
    std::vector<float> sum(pixels_);
    for (const Rank& rank : ranks_)
      for (std::size_t i = 0; i < pixels_; ++i)
        if (ids.contains(bitsOf(rank.id->samples[i]))) sum[i] += rank.coverage->samples[i];
    return sum;
  }

  // Checks the rules of the specification for each pixel.
  void expectValidRanks() const {
    for (std::size_t i = 0; i < pixels_; ++i) {
      float before = 1, total = 0;
      std::set<std::uint32_t> ids;
      for (const Rank& rank : ranks_) {
        const float id = rank.id->samples[i], coverage = rank.coverage->samples[i];
        EXPECT_LE(coverage, before) << type_ << i;
        EXPECT_EQ(id == 0, coverage == 0) << type_ << i;
        EXPECT_TRUE(id == 0 || std::isnormal(id)) << type_ << i;
        EXPECT_TRUE(id == 0 || ids.insert(bitsOf(id)).second) << type_ << i;
        total += before = coverage;
      }
      EXPECT_LE(total, 1 + 1e-6f) << type_ << i;
    }
  }

 private:
  struct Rank {
    const io::ExrChannel *id, *coverage;
  };
  static const io::ExrChannel* find(const io::ExrImage& image, const std::string& name) {
    const auto at = std::ranges::find(image.channels, name, &io::ExrChannel::name);
    return at == image.channels.end() ? nullptr : &*at;
  }

  std::string type_, key_;
  io::ExrImage image_;
  std::size_t pixels_;
  nlohmann::json manifest_;
  std::vector<Rank> ranks_;
};

struct Object {
  const char *name, *material;
  vec3 position;
  float size;
};

// The objects occlude each other. The nearest one transmits half of the rays. The hashes of object85 and object878 have the
// exponents 0 and 255. Two objects have the same name, and pairs of them have the same material.
constexpr std::array<Object, 6> kObjects{{{"object85", "wall \"A\"", {0, 0, -1}, 1.3f},
                                          {"object878", "gla\u00df", {0.5f, 0.3f, 0.8f}, 0.6f},
                                          {"b\u00e4r/\\", "other", {-0.7f, -0.4f, 0.3f}, 0.5f},
                                          {"twin", "other", {0.6f, -0.7f, 0.1f}, 0.4f},
                                          {"twin", "third", {-0.6f, 0.7f, 0.4f}, 0.35f},
                                          {"small", "third", {0.1f, 0.1f, 0.5f}, 0.06f}}};
constexpr const char* kClear = "gla\u00df";

using White = std::function<bool(const Object&)>;

class CryptomatteFile : public CliTest {
 protected:
  // Unlit objects, white or black, without other lights. `shared`: objects share materials as in the table; otherwise each
  // one has its own.
  void writeScene(const char* file, const White& white, bool shared) {
    nlohmann::json scene = quadScene();
    scene["extensionsUsed"] = {"KHR_materials_unlit"};
    scene["nodes"] = {{{"camera", 0}, {"translation", {0.2, 0.1, 4}}, {"rotation", {-0.02, 0.03, 0.2, 0.979}}}};
    scene["scenes"][0]["nodes"] = {0};
    const nlohmann::json primitive = scene["meshes"][0]["primitives"][0];
    scene["materials"] = scene["meshes"] = nlohmann::json::array();
    for (std::size_t i = 0; i < kObjects.size(); ++i) {
      const Object& object = kObjects[i];
      const float gray = white(object) ? 1.0f : 0.0f;
      const bool clear = std::string(object.material) == kClear;
      nlohmann::json& materials = scene["materials"];
      std::size_t material = 0;
      while (material < materials.size() && !(shared && materials[material]["name"] == object.material)) ++material;
      materials[material] = {{"name", object.material},
                             {"doubleSided", true},
                             {"alphaMode", clear ? "BLEND" : "OPAQUE"},
                             {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}},
                             {"pbrMetallicRoughness", {{"baseColorFactor", {gray, gray, gray, clear ? 0.5 : 1.0}}}}};
      scene["meshes"].push_back({{"primitives", {primitive}}});
      scene["meshes"][i]["primitives"][0]["material"] = material;
      scene["nodes"].push_back({{"mesh", i},
                                {"name", object.name},
                                {"translation", {object.position.x, object.position.y, object.position.z}},
                                {"scale", {object.size, object.size, 1}}});
      scene["scenes"][0]["nodes"].push_back(i + 1);
    }
    write(folder_ / file, scene.dump());
  }
  void writeAll() {
    writeScene(
        "all.gltf", [](const Object&) { return false; }, true);
  }

  void render(const std::string& scene, const std::string& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"render", scene,   "-q",   "--size",     "20x14", "--spp",   "16", "-o",
                                 output,   "--env", "none", "--aperture", "0.05",  "--focus", "4",  "--transparent"};
    all.insert(all.end(), more.begin(), more.end());
    const RunResult result = quintet(all);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  io::ExrImage read(const std::string& file) { return io::decodeExr(readFile(folder_ / file), file); }
  static std::vector<float> channel(const io::ExrImage& image, const std::string& name) {
    return std::ranges::find(image.channels, name, &io::ExrChannel::name)->samples;
  }
  // The visible coverage of the white objects: an image in which all other objects are black.
  std::vector<float> coverageOf(const White& white) {
    writeScene("one.gltf", white, false);
    render("one.gltf", "one.exr", {"--exr-type", "float"});
    return channel(read("one.exr"), "R");
  }
  static void expectSame(const std::vector<float>& matte, const std::vector<float>& coverage, const std::string& what) {
    ASSERT_EQ(matte.size(), kPixels);
    ASSERT_EQ(coverage.size(), kPixels);
    float largest = 0;
    for (std::size_t i = 0; i < kPixels; ++i) largest = std::max(largest, std::abs(matte[i] - coverage[i]));
    EXPECT_LT(largest, 1e-6f) << what;
    EXPECT_GT(std::ranges::max(matte), 0.0f) << what;
  }

  const std::vector<std::string> layers_{"--exr-type", "float", "--aov", "cryptomatte_object,cryptomatte_material"};
};

// The examples of the specification, and the names with special hashes.
TEST_F(CryptomatteFile, HashFollowsTheSpecification) {
  EXPECT_EQ(idBitsOf("bunny"), 0x13851a76u);
  EXPECT_EQ(idBitsOf("default"), 0x42c9679fu);
  EXPECT_EQ(hashOf(kObjects[0].name) >> 23 & 255u, 0u);
  EXPECT_EQ(hashOf(kObjects[1].name) >> 23 & 255u, 255u);
}

TEST_F(CryptomatteFile, FollowsTheSpecification) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const io::ExrImage image = read("all.exr");
  const Cryptomatte objects(image, "CryptoObject"), materials(image, "CryptoMaterial");
  EXPECT_NE(objects.key(), materials.key());
  for (const Cryptomatte* type : {&objects, &materials}) {
    EXPECT_EQ(type->rankCount(), 6u);
    type->expectValidRanks();
    std::vector<std::string> names;
    for (const auto& [name, hex] : type->manifest().items()) {
      EXPECT_EQ(hex.get<std::string>().size(), 8u) << name;
      EXPECT_EQ(std::stoul(hex.get<std::string>(), nullptr, 16), idBitsOf(name)) << name;
      names.push_back(name);
    }
    // The sum of all mattes is alpha: the manifest contains every id of the pixels.
    expectSame(type->matte(names), channel(image, "A"), "all");
  }
}

TEST_F(CryptomatteFile, MattesOfObjectsEqualTheirCoverage) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const Cryptomatte objects(read("all.exr"), "CryptoObject");
  EXPECT_EQ(objects.manifest().size(), kObjects.size());
  int mixed = 0;  // partially covered pixels
  for (const Object& object : kObjects) {
    const std::string name = &object == &kObjects[4] ? "twin#2" : object.name;  // the second object of this name
    ASSERT_TRUE(objects.manifest().contains(name)) << name;
    const std::vector<float> coverage = coverageOf([&](const Object& other) { return &other == &object; });
    expectSame(objects.matte({name}), coverage, name);
    mixed += static_cast<int>(std::ranges::count_if(coverage, [](float c) { return c > 0 && c < 1; }));
  }
  EXPECT_GT(mixed, 60);
  expectSame(objects.matte({"twin", "twin#2", "small"}),
             coverageOf([](const Object& object) { return object.size < 0.45f; }), "three");
}

TEST_F(CryptomatteFile, MattesOfMaterialsEqualTheirCoverage) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const Cryptomatte materials(read("all.exr"), "CryptoMaterial");
  for (const char* name : {"wall \"A\"", kClear, "other", "third"}) {
    ASSERT_TRUE(materials.manifest().contains(name)) << name;
    expectSame(materials.matte({name}),
               coverageOf([&](const Object& object) { return std::string(object.material) == name; }), name);
  }
}

// The mattes are the same in the second part of a lossy file, in a region, and in merged parts.
TEST_F(CryptomatteFile, MattesDoNotDependOnTheFile) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  render("all.gltf", "lossy.exr", {"--aov", "all", "--exr-compression", "dwab:500", "--exr-tiles", "8"});
  for (const char* part : {"0-1", "2-3"})
    render("all.gltf", std::string(part) + ".qfilm", {"--batches", part, "--aov", "cryptomatte_object"});
  ASSERT_EQ(quintet({"merge", "2-3.qfilm", "0-1.qfilm", "-q", "-o", "merged.exr"}).status, 0);
  render("all.gltf", "region.exr", {"--aov", "cryptomatte_object", "--region", "5,3,9,8"});
  const Cryptomatte all(read("all.exr"), "CryptoObject");
  for (const char* file : {"lossy.exr", "merged.exr", "region.exr"}) {
    const Cryptomatte other(read(file), "CryptoObject");
    other.expectValidRanks();
    EXPECT_EQ(other.manifest(), all.manifest()) << file;
    for (const auto& [name, hex] : all.manifest().items()) {
      std::vector<float> matte = all.matte({name});
      for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t x = i % kMatteWidth, y = i / kMatteWidth;
        const bool inside = std::string(file) != "region.exr" || (x >= 5 && x < 14 && y >= 3 && y < 11);
        if (!inside) matte[i] = 0;
      }
      EXPECT_EQ(other.matte({name}), matte) << file << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace quintet::test
