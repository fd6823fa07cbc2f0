// SPDX-License-Identifier: Apache-2.0
// Errors in scene files: one line with the file, the line, the key and the nearest name. Mutated files load or give
// such an error, within a memory limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"
#include "base/file.h"
#include "scene/animation/keyframes.h"
#include "scene/defaults/auto_camera.h"
#include "scene/error_matcher.h"
#include "scene/load.h"
#include "scene/model/validate.h"
#include "scene/toml/scene_toml.h"

namespace quintet::test {
namespace {

std::string errorOf(const std::string& text, std::size_t limit = 0) {
  try {
    scene::validate(scene::parseSceneToml(text, "s.toml", {.maxMemory = limit}));
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

struct Mistake {
  const char* text;
  int line;
  std::vector<std::string> words;  // that the message contains: keys, names, numbers
};

const Mistake kMistakes[] = {
    {"[[mesh]\n", 1, {}},
    {"a = 1979-05-27\n", 1, {"dates"}},
    {"[[spehres]]\n", 1, {"'spehres'", "'spheres'"}},
    {"[spheres]\nitems = []\n", 1, {"'spheres'", "[[spheres]]"}},
    {"mesh = 3\n", 1, {"'mesh'", "[[mesh]]"}},
    {"[[material]]\nname = 'a'\nrougness = 1\n", 3, {"[[material]]", "'a'", "'rougness'", "'roughness'"}},
    {"[[material]]\nroughness = 1\n", 1, {"[[material]]", "'name'"}},
    {"[[material]]\nname = 'a/b'\n", 2, {"'a/b'", "'/'"}},
    {"[[material]]\nname = 'a'\n[[material]]\nname = 'a'\n", 4, {"'a'"}},
    {"[[material]]\nname = 'a'\nroughness = 2\n", 3, {"'roughness'", "[[material]]", "'a'"}},
    {"[[material]]\nname = 'a'\nroughness = nan\n", 3, {"'roughness'", "[[material]]", "'a'"}},
    {"[[material]]\nname = 'a'\nior = 0.5\n", 3, {"'ior'", "[[material]]", "'a'"}},
    {"[[material]]\nname = 'a'\nattenuation_distance = 0\n", 3, {"'attenuation_distance'", "[[material]]", "'a'"}},
    {"[[material]]\nname = 'a'\nbase_color = 'red'\n", 3, {"'base_color'", "[[material]]", "'a'", "#ff8000"}},
    {"[[material]]\nname = 'a'\nalpha_mode = 'masked'\n",
     3,
     {"'alpha_mode'", "[[material]]", "'a'", "'masked'", "'mask'"}},
    {"[[material]]\nname = 'a'\nbase_color_texture = 'nothing.png'\n", 3, {"'nothing.png'"}},
    {"[[material]]\nname = 'a'\n[[spheres]]\nmaterial = 'b'\nitems = [{}]\n", 4, {"'b'", "'a'"}},
    {"[[spheres]]\nname = 's'\n", 1, {"[[spheres]]", "'s'", "'items'", "'random'", "'grid'"}},
    {"[[spheres]]\nitems = [\n {},\n { radius = 0 } ]\n", 4, {"'radius'", "items[1]", "[[spheres]]"}},
    {"[[spheres]]\nitems = [{ height = 1 }]\n", 2, {"items[0]", "[[spheres]]", "'height'"}},
    {"[[spheres]]\nitems = [{ scale = [1, 0, 1] }]\n", 2, {"'scale'", "items[0]", "[[spheres]]"}},
    {"[[spheres]]\nitems = [{ radius = 1e-30, scale = 1e-30 }]\n", 2, {"items[0]", "[[spheres]]", "inverse"}},
    {"[[spheres]]\nitems = [{ center = [0, 0] }]\n", 2, {"'center'", "items[0]", "[[spheres]]", "3 numbers"}},
    {"[[spheres]]\nrandom = { count = 10 }\n", 2, {"'random'", "[[spheres]]", "'box'"}},
    {"[[spheres]]\nrandom = { count = 1e9, box = [[0,0,0],[1,1,1]] }\n",
     2,
     {"'count'", "'random'", "[[spheres]]", "268435456"}},
    {"[[spheres]]\ngrid = { count = [100000, 100000, 1], spacing = 1 }\n",
     2,
     {"'count'", "'grid'", "[[spheres]]", "268435456"}},
    {"[[boxes]]\nitems = [{ min = [0, 0, 0], max = [1, 0, 1] }]\n", 2, {"'min'", "items[0]", "[[boxes]]", "'max'"}},
    {"[[boxes]]\nitems = [{ min = [0, 0, 0], max = [1, 1, 1], size = 1 }]\n",
     2,
     {"'min'", "'size'", "items[0]", "[[boxes]]"}},
    {"[[cylinders]]\nitems = [{ from = [0, 0, 0], to = [0, 0, 0] }]\n",
     2,
     {"'from'", "'to'", "items[0]", "[[cylinders]]", "point"}},
    {"[[tori]]\nitems = [{ tube = 1 }]\n", 2, {"'tube'", "items[0]", "[[tori]]", "'radius'"}},
    {"[[custom]]\nboxes = [{ min = [1, 0, 0], max = [0, 1, 1] }]\n", 2, {"'min'", "boxes[0]", "[[custom]]", "'max'"}},
    {"[[csg]]\ntree = { spheer = {} }\n", 2, {"'tree'", "[[csg]]", "'spheer'", "'sphere'"}},
    {"[[csg]]\ntree = { union = [ { sphere = {} } ] }\n", 2, {"'union'", "two"}},
    {"[[csg]]\ntree = { union = [ { sphere = {} },\n {} ] }\n", 3, {"'union'", "operand 1", "csg"}},
    {"[[csg]]\ntree = { sphere = {}, box = {} }\n", 2, {"'sphere'", "'box'", "'tree'", "[[csg]]"}},
    {"[[csg]]\nname = 'a'\ntree = { csg = 'a' }\n", 3, {"[[csg]]", "'a'"}},
    {"[[csg]]\ntree = { sphere = {}, matrix = [1] }\n", 2, {"'matrix'", "'tree'", "[[csg]]", "16", "16 numbers"}},
    {"[[mesh]]\nname = 'm'\n", 1, {"[[mesh]]", "'m'", "'shape'", "'positions'"}},
    {"[[mesh]]\nshape = 'sphere'\n", 2, {"'shape'", "[[mesh]]", "'sphere'", "'uv_sphere'"}},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0],[0,1,0]]\nindices = [0, 1, 3]\n", 3, {"'indices'", "[[mesh]]"}},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0],[0,1,0]]\nuvs = [[0, 0]]\n",
     3,
     {"'uvs'", "[[mesh]]", "1 element for 3 positions"}},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0]]\n", 1, {"[[mesh]]", "'indices'", "2 positions"}},
    {"[[mesh]]\npositions = [[0,0,0]]\n", 1, {"[[mesh]]", "'indices'", "1 position and"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[spheres]]\nname = 'm'\nitems = [{}]\n", 4, {"'m'", "line 1"}},
    {"[[mesh]]\nname = 'helm'\nshape = 'quad'\n[[instance]]\nof = 'helmet'\n",
     5,
     {"'of'", "[[instance]]", "'helmet'", "'helm'"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nmask = 256\n",
     6,
     {"'mask'", "[[instance]]", "255"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nflags = ['opaque']\n", 6, {"'opaque'"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nmatrix = [[1,0,0,0],[0,0,0,0],[0,0,1,0]]\n",
     6,
     {"[[instance]]", "inverse"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nscale = 2\nmatrix = "
     "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]\n",
     7,
     {"'matrix'", "'scale'", "[[instance]]"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nkeyframes = [{frame=1},{frame=1}]\n",
     6,
     {"keyframes[1]", "[[instance]]", "frames"}},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nkeyframes = [{frame=1},{frame=2, scale=-1}]\n",
     6,
     {"keyframes[1]", "[[instance]]", "'scale'"}},
    {"[[light]]\nposition = [0,0,0]\n", 1, {"[[light]]", "'type'"}},
    {"[[light]]\ntype = 'point'\nposition = [0,0,0]\ndirection = [0,1,0]\n", 4, {"[[light]]", "'direction'"}},
    {"[[light]]\ntype = 'spot'\nposition = [0,0,0]\ndirection = [0,0,0]\n", 4, {"'direction'", "[[light]]", "length"}},
    {"[[camera]]\nlook_from = [0,0,0]\nlook_at = [0,0,0]\n", 2, {"[[camera]]", "camera position"}},
    {"[[camera]]\nlook_from = [0,0,1]\nlook_at = [0,0,0]\nfov = 180\n", 4, {"'fov'", "[[camera]]", "180"}},
    {"[environment]\ncolor = [1,1,1]\nnone = true\n", 3, {"'color'", "'none'", "[environment]"}},
    {"[environment]\nintensity = 2\n", 1, {"[environment]", "'image'", "'color'", "'default = true'", "'none = true'"}},
    {"[[file]]\nname = 'f'\npath = 'nothing.glb'\n", 3, {"'nothing.glb'"}},
    {"[[file]]\nname = 'f'\npath = '/dev/zero'\n", 3, {"'/dev/zero'"}},
};

TEST(SceneTomlErrors, ReportTheLineAndTheNearestName) {
  for (const Mistake& mistake : kMistakes) {
    SCOPED_TRACE(mistake.text);
    const std::string message = errorOf(mistake.text);
    EXPECT_THAT(message, testing::StartsWith("s.toml: line " + std::to_string(mistake.line) + ": "));
    for (const std::string& word : mistake.words) EXPECT_THAT(message, testing::HasSubstr(word));
  }
}

TEST(SceneTomlErrors, RejectsExcessiveSizesBeforeAllocation) {
  constexpr std::size_t kLimit = std::size_t{64} << 20;
  for (const char* text : {"[[spheres]]\nrandom = { count = 200000000, box = [[0,0,0],[1,1,1]] }\n",
                           "[[custom]]\ngrid = { count = [1000, 1000, 100], spacing = 1 }\n",
                           "[[mesh]]\nshape = 'quad'\nsegments = 4096\n",
                           "[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nrandom = { count = 10000000, "
                           "box = [[0,0,0],[1,1,1]] }\n"})
    EXPECT_THAT(errorOf(text, kLimit), testing::HasSubstr("64.0 MiB")) << text;
  // Each tree contains the one before twice: 2^40 leaves.
  std::string text = "[[csg]]\nname = 't0'\ntree = { sphere = {} }\n";
  for (int i = 1; i <= 40; ++i)
    text += "[[csg]]\nname = 't" + std::to_string(i) + "'\ntree = { union = [ { csg = 't" + std::to_string(i - 1) +
            "' }, { csg = 't" + std::to_string(i - 1) + "' } ] }\n";
  EXPECT_THAT(errorOf(text), testing::HasSubstr("65536"));
}

TEST(SceneTomlErrors, RejectsDeeplyNestedKeys) {
  std::string dots;
  for (int i = 0; i < 200000; ++i) dots += ".a";
  EXPECT_THAT(errorOf("# x\na" + dots + " = 1\n"), IsErrorAt("s.toml: line 2", "16"));
  EXPECT_THAT(errorOf("[a" + dots + "]\n"), IsErrorAt("s.toml: line 1", "16"));
  EXPECT_THAT(errorOf("[[a" + dots + "]]\n"), IsErrorAt("s.toml: line 1", "16"));
  EXPECT_THAT(errorOf("a = [\n'''it's\n''', { \"a\"" + dots + " = 1 } ]\n"), IsErrorAt("s.toml: line 3", "16"));
  EXPECT_THAT(errorOf("a = \"\\\"\"\nb" + dots + " = 2\n"), IsErrorAt("s.toml: line 2", "16"));
  // The deepest nesting that the parser accepts.
  std::string nested = "1";
  for (int i = 0; i < 250; ++i) nested = "{ a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = " + nested + " }";
  EXPECT_THAT(errorOf("b = " + nested + "\n"), IsErrorAt("s.toml: line 1", "300"));
  // Dots in strings, comments and numbers are not in keys.
  EXPECT_EQ(errorOf("# " + dots + "\n[[mesh]]\nshape = 'quad'\nname = '" + dots + "'\ntranslate = [1.5, 2.5, 3.5]\n"),
            "none");
}

// Replaces, deletes and duplicates bytes, words and lines, and replaces numbers by extreme ones.
std::string mutated(std::string text, std::mt19937& random) {
  static const char* const kTokens[] = {"0",
                                        "-1",
                                        "1e38",
                                        "-1e-38",
                                        "nan",
                                        "inf",
                                        "999999999",
                                        "\"x\"",
                                        "[]",
                                        "{}",
                                        "[[",
                                        "]]",
                                        "[[1,2,3],[4,5,6]]",
                                        "true",
                                        "=",
                                        "\n",
                                        "\x01",
                                        "\xff",
                                        "'''",
                                        "{ csg = 'hexagon' }",
                                        "[[csg]]",
                                        "1979-05-27",
                                        "-0.0",
                                        "4294967296"};
  static const char* const kNumbers[] = {"0",  "1",    "-1",  "0.5",  "2",    "-0.001", "3",
                                         "30", "1000", "1e6", "1e20", "1e38", "1e-20",  "-0.0"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % std::max<std::size_t>(1, n); };
  const std::size_t changes = 1 + below(3);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = below(text.size());
    const std::size_t end = text.find_first_of(" ,\n]}", at), lineEnd = text.find('\n', at);
    switch (below(12)) {
      case 0: text[at] = static_cast<char>(random()); break;
      case 1: text.replace(at, end == std::string::npos ? 1 : end - at, kTokens[below(std::size(kTokens))]); break;
      case 2: text.insert(at, kTokens[below(std::size(kTokens))]); break;
      case 3: text.erase(at, 1 + below(20)); break;
      case 4: text.erase(at, lineEnd == std::string::npos ? std::string::npos : lineEnd - at); break;
      case 5: text.insert(at, text.substr(below(text.size()), 1 + below(60))); break;
      default: {  // replaces a number
        const std::size_t number = text.find_first_of("0123456789", at);
        if (number != std::string::npos)
          text.replace(number, text.find_first_not_of("0123456789.", number) - number,
                       kNumbers[below(std::size(kNumbers))]);
      }
    }
  }
  return text;
}

// Calls the functions that a renderer calls on the host.
void useEverything(const scene::Scene& s) {
  const Bounds3 bounds = scene::worldBounds(s);
  EXPECT_TRUE(bounds.empty() || (isFinite(bounds.min) && isFinite(bounds.max)));
  for (const scene::Mesh& mesh : s.meshes)
    for (const scene::PrimitiveSet& set : mesh.primitiveSets)
      for (const Bounds3& box : scene::boxesOf(set)) EXPECT_FALSE(box.empty());
  for (const scene::Instance& instance : s.instances)
    for (const float frame : {0.0f, 7.5f, 1e6f})
      EXPECT_NE(glm::determinant(glm::dmat3(glm::dmat4(scene::worldFromObjectAt(instance, frame)))), 0.0);
  scene::frameScene(bounds, 1.5f);
}

TEST(SceneTomlFuzz, LoadsMutatedScenesOrReportsAnError) {
  const std::filesystem::path folder = std::filesystem::path(QUINTET_SOURCE_ROOT) / "examples/scenes";
  std::mt19937 random(20261121);
  std::size_t loaded = 0, rejected = 0;
  for (const char* name : {"csg.scene.toml", "spheres.scene.toml", "instances.scene.toml", "moving.scene.toml"}) {
    const std::string original = readTextFile(folder / name);
    EXPECT_NO_THROW(scene::validate(scene::loadScene(folder / name))) << name;
    for (int i = 0; i < 400; ++i) {
      try {
        const scene::Scene loadedScene =
            scene::parseSceneToml(mutated(original, random), folder / name, {.maxMemory = std::size_t{4} << 20});
        scene::validate(loadedScene);
        useEverything(loadedScene);
        ++loaded;
      } catch (const Error& error) {
        const std::string message = error.what();
        ++rejected;
        ASSERT_FALSE(message.empty());
        for (const char c : message) ASSERT_FALSE(c >= 0 && c < ' ') << message;
        ASSERT_TRUE(message.find("scene: ") == std::string::npos) << "only found by validate: " << message;
      }
    }
  }
  EXPECT_GT(loaded, 200u);
  EXPECT_GT(rejected, 500u);
}

}  // namespace
}  // namespace quintet::test
