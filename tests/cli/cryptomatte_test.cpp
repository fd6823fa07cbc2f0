// Cryptomatte files read as the specification says (Friedman and Jones, Psyop: "Cryptomatte Specification"), with nothing of
// src/io/cryptomatte: hash, conversion, names of attributes and channels are this file's own. A matte must be the coverage
// that a picture shows in which the thing is white and all else black.
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
#include "io/exr.h"

namespace quintet::test {
namespace {

constexpr std::uint32_t kWidth = 20, kHeight = 14;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

// MurmurHash3_x86_32 with seed 0, in 64-bit arithmetic and over a padded copy.
std::uint32_t hashOf(const std::string& name) {
  const auto low = [](std::uint64_t v) { return v & 0xffffffffull; };
  const auto turn = [&](std::uint64_t v, int by) { return low(v << by) | v >> (32 - by); };
  std::uint64_t h = 0;
  std::vector<unsigned char> bytes(name.begin(), name.end());
  bytes.resize((name.size() + 3) / 4 * 4, 0);
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::uint64_t k = bytes[at] + 256ull * bytes[at + 1] + 65536ull * bytes[at + 2] + 16777216ull * bytes[at + 3];
    k = low(turn(low(k * 3432918353ull), 15) * 461845907ull);
    h ^= k;
    if (at + 4 <= name.size()) h = low(turn(h, 13) * 5 + 3864292196ull);
  }
  h ^= name.size();
  h = low((h ^ h >> 16) * 2246822507ull);
  h = low((h ^ h >> 13) * 3266489909ull);
  return static_cast<std::uint32_t>(h ^ h >> 16);
}

// uint32_to_float32: the same bits, the exponent clamped to 1 ... 254.
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

// Everything that a reader needs, from the file alone.
class Cryptomatte {
 public:
  Cryptomatte(io::ExrPicture file, const std::string& type)
      : type_(type), picture_(std::move(file)), pixels_(std::size_t{picture_.width} * picture_.height) {
    std::map<std::string, std::string> attributes(picture_.metadata.begin(), picture_.metadata.end());
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
      if (!find(picture_, name + "R")) break;
      for (const auto& [id, coverage] : {std::pair("R", "G"), std::pair("B", "A")})
        ranks_.push_back({find(picture_, name + id), find(picture_, name + coverage)});
    }
    for (const Rank& rank : ranks_)
      for (const io::ExrChannel* channel : {rank.id, rank.coverage}) EXPECT_EQ(channel->type, io::ExrType::f32);
  }

  Cryptomatte(const Cryptomatte&) = delete;  // points into its picture

  const std::string& key() const { return key_; }
  const nlohmann::json& manifest() const { return manifest_; }
  std::size_t rankCount() const { return ranks_.size(); }

  // Of all names at once: the sum of the coverages of the ranks that have the id of one of them.
  std::vector<float> matte(const std::vector<std::string>& names) const {
    std::set<std::uint32_t> ids;
    for (const std::string& name : names) ids.insert(idBitsOf(name));
    std::vector<float> sum(pixels_);
    for (const Rank& rank : ranks_)
      for (std::size_t i = 0; i < pixels_; ++i)
        if (ids.contains(bitsOf(rank.id->samples[i]))) sum[i] += rank.coverage->samples[i];
    return sum;
  }

  // What the specification says of every pixel.
  void expectRanked() const {
    for (std::size_t i = 0; i < pixels_; ++i) {
      float before = 1, total = 0;
      std::set<std::uint32_t> seen;
      for (const Rank& rank : ranks_) {
        const float id = rank.id->samples[i], coverage = rank.coverage->samples[i];
        EXPECT_LE(coverage, before) << type_ << i;
        EXPECT_EQ(id == 0, coverage == 0) << type_ << i;
        EXPECT_TRUE(id == 0 || std::isnormal(id)) << type_ << i;
        EXPECT_TRUE(id == 0 || seen.insert(bitsOf(id)).second) << type_ << i;
        total += before = coverage;
      }
      EXPECT_LE(total, 1 + 1e-6f) << type_ << i;
    }
  }

 private:
  struct Rank {
    const io::ExrChannel *id, *coverage;
  };
  static const io::ExrChannel* find(const io::ExrPicture& picture, const std::string& name) {
    const auto at = std::ranges::find(picture.channels, name, &io::ExrChannel::name);
    return at == picture.channels.end() ? nullptr : &*at;
  }

  std::string type_, key_;
  io::ExrPicture picture_;
  std::size_t pixels_;
  nlohmann::json manifest_;
  std::vector<Rank> ranks_;
};

struct Thing {
  const char *name, *material;
  vec3 place;
  float size;
};

// They hide each other; the nearest lets half of the rays through. The hashes of object85 and object878 have the exponents
// 0 and 255. Two share a name, two a material.
constexpr std::array<Thing, 6> kThings{{{"object85", "wall \"A\"", {0, 0, -1}, 1.3f},
                                        {"object878", "gla\u00df", {0.5f, 0.3f, 0.8f}, 0.6f},
                                        {"b\u00e4r/\\", "other", {-0.7f, -0.4f, 0.3f}, 0.5f},
                                        {"twin", "other", {0.6f, -0.7f, 0.1f}, 0.4f},
                                        {"twin", "third", {-0.6f, 0.7f, 0.4f}, 0.35f},
                                        {"small", "third", {0.1f, 0.1f, 0.5f}, 0.06f}}};
constexpr const char* kClear = "gla\u00df";

using White = std::function<bool(const Thing&)>;

class CryptomatteFile : public CliTest {
 protected:
  // Those that are not white are black; nothing else gives light. `shared`: materials as the table has them, else one each.
  void writeScene(const char* file, const White& white, bool shared) {
    nlohmann::json scene = quadScene();
    scene["extensionsUsed"] = {"KHR_materials_unlit"};
    scene["nodes"] = {{{"camera", 0}, {"translation", {0.2, 0.1, 4}}, {"rotation", {-0.02, 0.03, 0.2, 0.979}}}};
    scene["scenes"][0]["nodes"] = {0};
    const nlohmann::json primitive = scene["meshes"][0]["primitives"][0];
    scene["materials"] = scene["meshes"] = nlohmann::json::array();
    for (std::size_t i = 0; i < kThings.size(); ++i) {
      const Thing& thing = kThings[i];
      const float grey = white(thing) ? 1.0f : 0.0f;
      const bool clear = std::string(thing.material) == kClear;
      nlohmann::json& materials = scene["materials"];
      std::size_t material = 0;
      while (material < materials.size() && !(shared && materials[material]["name"] == thing.material)) ++material;
      materials[material] = {{"name", thing.material},
                             {"doubleSided", true},
                             {"alphaMode", clear ? "BLEND" : "OPAQUE"},
                             {"extensions", {{"KHR_materials_unlit", nlohmann::json::object()}}},
                             {"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, clear ? 0.5 : 1.0}}}}};
      scene["meshes"].push_back({{"primitives", {primitive}}});
      scene["meshes"][i]["primitives"][0]["material"] = material;
      scene["nodes"].push_back({{"mesh", i},
                                {"name", thing.name},
                                {"translation", {thing.place.x, thing.place.y, thing.place.z}},
                                {"scale", {thing.size, thing.size, 1}}});
      scene["scenes"][0]["nodes"].push_back(i + 1);
    }
    write(folder_ / file, scene.dump());
  }
  void writeAll() {
    writeScene(
        "all.gltf", [](const Thing&) { return false; }, true);
  }

  void render(const std::string& scene, const std::string& output, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"render", scene,   "-q",   "--size",     "20x14", "--spp",   "16", "-o",
                                 output,   "--env", "none", "--aperture", "0.05",  "--focus", "4",  "--transparent"};
    all.insert(all.end(), more.begin(), more.end());
    const RunResult result = quintet(all);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  io::ExrPicture read(const std::string& file) { return io::decodeExr(readFile(folder_ / file), file); }
  static std::vector<float> channel(const io::ExrPicture& picture, const std::string& name) {
    return std::ranges::find(picture.channels, name, &io::ExrChannel::name)->samples;
  }
  // How much of each pixel the things cover that are chosen: the picture in which they are white.
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

// The examples that it has, and the names that were chosen for what they hash to.
TEST_F(CryptomatteFile, HashIsThatOfTheSpecification) {
  EXPECT_EQ(idBitsOf("bunny"), 0x13851a76u);
  EXPECT_EQ(idBitsOf("default"), 0x42c9679fu);
  EXPECT_EQ(hashOf(kThings[0].name) >> 23 & 255u, 0u);
  EXPECT_EQ(hashOf(kThings[1].name) >> 23 & 255u, 255u);
}

TEST_F(CryptomatteFile, IsWhatTheSpecificationSays) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const io::ExrPicture picture = read("all.exr");
  const Cryptomatte objects(picture, "CryptoObject"), materials(picture, "CryptoMaterial");
  EXPECT_NE(objects.key(), materials.key());
  for (const Cryptomatte* type : {&objects, &materials}) {
    EXPECT_EQ(type->rankCount(), 6u);
    type->expectRanked();
    std::vector<std::string> names;
    for (const auto& [name, hex] : type->manifest().items()) {
      EXPECT_EQ(hex.get<std::string>().size(), 8u) << name;
      EXPECT_EQ(std::stoul(hex.get<std::string>(), nullptr, 16), idBitsOf(name)) << name;
      names.push_back(name);
    }
    // All names together are the picture's alpha: every id in the pixels is one of the manifest.
    expectSame(type->matte(names), channel(picture, "A"), "all");
  }
}

TEST_F(CryptomatteFile, MattesOfObjectsAreTheirCoverage) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const Cryptomatte objects(read("all.exr"), "CryptoObject");
  EXPECT_EQ(objects.manifest().size(), kThings.size());
  int mixed = 0;  // pixels that are covered in part
  for (const Thing& thing : kThings) {
    const std::string name = &thing == &kThings[4] ? "twin#2" : thing.name;  // the second of two
    ASSERT_TRUE(objects.manifest().contains(name)) << name;
    const std::vector<float> coverage = coverageOf([&](const Thing& other) { return &other == &thing; });
    expectSame(objects.matte({name}), coverage, name);
    mixed += static_cast<int>(std::ranges::count_if(coverage, [](float c) { return c > 0 && c < 1; }));
  }
  EXPECT_GT(mixed, 60);
  expectSame(objects.matte({"twin", "twin#2", "small"}),
             coverageOf([](const Thing& thing) { return thing.size < 0.45f; }), "three");
}

TEST_F(CryptomatteFile, MattesOfMaterialsAreTheirCoverage) {
  writeAll();
  render("all.gltf", "all.exr", layers_);
  const Cryptomatte materials(read("all.exr"), "CryptoMaterial");
  for (const char* name : {"wall \"A\"", kClear, "other", "third"}) {
    ASSERT_TRUE(materials.manifest().contains(name)) << name;
    expectSame(materials.matte({name}),
               coverageOf([&](const Thing& thing) { return std::string(thing.material) == name; }), name);
  }
}

// The same in the second part of a lossy file, in a region, and joined from parts.
TEST_F(CryptomatteFile, HoweverTheFileWasMade) {
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
    other.expectRanked();
    EXPECT_EQ(other.manifest(), all.manifest()) << file;
    for (const auto& [name, hex] : all.manifest().items()) {
      std::vector<float> matte = all.matte({name});
      for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t x = i % kWidth, y = i / kWidth;
        const bool inside = std::string(file) != "region.exr" || (x >= 5 && x < 14 && y >= 3 && y < 11);
        if (!inside) matte[i] = 0;
      }
      EXPECT_EQ(other.matte({name}), matte) << file << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace quintet::test
