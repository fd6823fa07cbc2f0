// What a scene file gets wrong: one line with the file, the line, the key and the nearest name. And mutated files:
// whatever they say, they load or give such an error, within a memory limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "base/file.h"
#include "scene/auto_camera.h"
#include "scene/keyframes.h"
#include "scene/load.h"
#include "scene/scene_toml.h"
#include "scene/validate.h"

namespace quintet::test {
namespace {

std::string errorOf(const std::string& text, std::size_t limit = 0) {
  try {
    scene::validate(scene::parseSceneToml(text, "s.toml", {limit}));
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

struct Mistake {
  const char* text;
  const char* message;
};

const Mistake kMistakes[] = {
    {"[[mesh]\n", "s.toml: line 1: "},
    {"a = 1979-05-27\n", "s.toml: line 1: dates and times have no place in a scene"},
    {"[[spehres]]\n", "s.toml: line 1: the scene has no key 'spehres'; did you mean 'spheres'?"},
    {"[spheres]\nitems = []\n", "s.toml: line 1: 'spheres' is written as [[spheres]]"},
    {"mesh = 3\n", "s.toml: line 1: 'mesh' is written as [[mesh]]"},
    {"[[material]]\nname = 'a'\nrougness = 1\n",
     "s.toml: line 3: [[material]] 'a' has no key 'rougness'; did you mean 'roughness'?"},
    {"[[material]]\nroughness = 1\n", "s.toml: line 1: [[material]] needs 'name'"},
    {"[[material]]\nname = 'a/b'\n", "s.toml: line 2: 'a/b': a name has no '/', which leads into a [[file]]"},
    {"[[material]]\nname = 'a'\n[[material]]\nname = 'a'\n", "s.toml: line 4: there are two materials 'a'"},
    {"[[material]]\nname = 'a'\nroughness = 2\n",
     "s.toml: line 3: 'roughness' of [[material]] 'a' must be a number from 0 to 1"},
    {"[[material]]\nname = 'a'\nroughness = nan\n",
     "s.toml: line 3: 'roughness' of [[material]] 'a' must be a number from 0 to 1"},
    {"[[material]]\nname = 'a'\nior = 0.5\n", "s.toml: line 3: 'ior' of [[material]] 'a' must be a number from 1 up"},
    {"[[material]]\nname = 'a'\nattenuation_distance = 0\n",
     "s.toml: line 3: 'attenuation_distance' of [[material]] 'a' must be a number above 0"},
    {"[[material]]\nname = 'a'\nbase_color = 'red'\n",
     "s.toml: line 3: 'base_color' of [[material]] 'a' must be three linear numbers or an sRGB colour such as "
     "\"#ff8000\""},
    {"[[material]]\nname = 'a'\nalpha_mode = 'masked'\n",
     "s.toml: line 3: 'alpha_mode' of [[material]] 'a' is one of opaque, mask, blend, not 'masked'; did you mean "
     "'mask'?"},
    {"[[material]]\nname = 'a'\nbase_color_texture = 'nothing.png'\n",
     "s.toml: line 3: there is no file 'nothing.png'"},
    {"[[material]]\nname = 'a'\n[[spheres]]\nmaterial = 'b'\nitems = [{}]\n",
     "s.toml: line 4: there is no material 'b'; did you mean 'a'?"},
    {"[[spheres]]\nname = 's'\n", "s.toml: line 1: [[spheres]] 's' needs 'items', 'random' or 'grid'"},
    {"[[spheres]]\nitems = [\n {},\n { radius = 0 } ]\n",
     "s.toml: line 4: 'radius' of items[1] of [[spheres]] must be a number above 0"},
    {"[[spheres]]\nitems = [{ height = 1 }]\n", "s.toml: line 2: items[0] of [[spheres]] has no key 'height'"},
    {"[[spheres]]\nitems = [{ scale = [1, 0, 1] }]\n",
     "s.toml: line 2: 'scale' of items[0] of [[spheres]] must not be 0"},
    {"[[spheres]]\nitems = [{ radius = 1e-30, scale = 1e-30 }]\n",
     "s.toml: line 2: the transform of items[0] of [[spheres]] has no inverse"},
    {"[[spheres]]\nitems = [{ center = [0, 0] }]\n",
     "s.toml: line 2: 'center' of items[0] of [[spheres]] must be a list of 3 numbers"},
    {"[[spheres]]\nrandom = { count = 10 }\n", "s.toml: line 2: 'random' of [[spheres]] needs 'box'"},
    {"[[spheres]]\nrandom = { count = 1e3, box = [[0,0,0],[1,1,1]] }\n",
     "s.toml: line 2: 'count' of 'random' of [[spheres]] must be a whole number from 1 to 268435456"},
    {"[[spheres]]\ngrid = { count = [100000, 100000, 1], spacing = 1 }\n",
     "s.toml: line 2: 'count' of 'grid' of [[spheres]]: more than 268435456 in all"},
    {"[[boxes]]\nitems = [{ min = [0, 0, 0], max = [1, 0, 1] }]\n",
     "s.toml: line 2: 'min' of items[0] of [[boxes]] must be below 'max' on each axis"},
    {"[[boxes]]\nitems = [{ min = [0, 0, 0], max = [1, 1, 1], size = 1 }]\n",
     "s.toml: line 2: 'min' and 'size' of items[0] of [[boxes]] exclude each other"},
    {"[[cylinders]]\nitems = [{ from = [0, 0, 0], to = [0, 0, 0] }]\n",
     "s.toml: line 2: 'from' and 'to' of items[0] of [[cylinders]] are the same point"},
    {"[[tori]]\nitems = [{ tube = 1 }]\n",
     "s.toml: line 2: 'tube' of items[0] of [[tori]] must be smaller than its 'radius'"},
    {"[[custom]]\nboxes = [{ min = [1, 0, 0], max = [0, 1, 1] }]\n",
     "s.toml: line 2: 'min' of boxes[0] of [[custom]] must not be above 'max'"},
    {"[[csg]]\ntree = { spheer = {} }\n",
     "s.toml: line 2: 'tree' of [[csg]] has no key 'spheer'; did you mean 'sphere'?"},
    {"[[csg]]\ntree = { union = [ { sphere = {} } ] }\n",
     "s.toml: line 2: 'union' must be a list of at least two operands"},
    {"[[csg]]\ntree = { union = [ { sphere = {} },\n {} ] }\n",
     "s.toml: line 3: operand 1 of 'union' needs one of sphere, box, cylinder, cone, torus, union, intersection, "
     "difference, csg"},
    {"[[csg]]\ntree = { sphere = {}, box = {} }\n",
     "s.toml: line 2: 'sphere' and 'box' of 'tree' of [[csg]] exclude each other"},
    {"[[csg]]\nname = 'a'\ntree = { csg = 'a' }\n", "s.toml: line 3: there is no [[csg]] 'a' with one tree above"},
    {"[[csg]]\ntree = { sphere = {}, matrix = [1] }\n",
     "s.toml: line 2: 'matrix' of 'tree' of [[csg]] must be a list of 16 numbers"},
    {"[[mesh]]\nname = 'm'\n", "s.toml: line 1: [[mesh]] 'm' needs 'shape' or 'positions'"},
    {"[[mesh]]\nshape = 'sphere'\n",
     "s.toml: line 2: 'shape' of [[mesh]] is one of quad, plane, cube, uv_sphere, tetrahedron, not 'sphere'; did you "
     "mean 'uv_sphere'?"},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0],[0,1,0]]\nindices = [0, 1, 3]\n",
     "s.toml: line 3: 'indices' of [[mesh]] must be a whole number from 0 to 2"},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0],[0,1,0]]\nuvs = [[0, 0]]\n",
     "s.toml: line 3: 'uvs' of [[mesh]] has 1 elements for 3 positions"},
    {"[[mesh]]\npositions = [[0,0,0],[1,0,0]]\n",
     "s.toml: line 1: [[mesh]] has 2 positions and no 'indices': not whole triangles"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[spheres]]\nname = 'm'\nitems = [{}]\n",
     "s.toml: line 4: 'm' is already the name of what line 1 describes"},
    {"[[mesh]]\nname = 'helm'\nshape = 'quad'\n[[instance]]\nof = 'helmet'\n",
     "s.toml: line 5: 'of' of [[instance]]: there is nothing called 'helmet'; did you mean 'helm'?"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nmask = 256\n",
     "s.toml: line 6: 'mask' of [[instance]] must be a whole number from 0 to 255"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nflags = ['opaque']\n",
     "s.toml: line 6: there is no instance flag 'opaque', but force_opaque, force_no_opaque, cull_disable, "
     "flip_facing"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nmatrix = [[1,0,0,0],[0,0,0,0],[0,0,1,0]]\n",
     "s.toml: line 6: the transform of [[instance]] has no inverse"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nscale = 2\nmatrix = "
     "[[1,0,0,0],[0,1,0,0],[0,0,1,0]]\n",
     "s.toml: line 7: 'matrix' and 'scale' of [[instance]] exclude each other"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nkeyframes = [{frame=1},{frame=1}]\n",
     "s.toml: line 6: keyframes[1] of [[instance]]: frames must ascend"},
    {"[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nkeyframes = [{frame=1},{frame=2, scale=-1}]\n",
     "s.toml: line 6: keyframes[1] of [[instance]]: 'scale' changes its sign and would be 0 on the way"},
    {"[[light]]\nposition = [0,0,0]\n", "s.toml: line 1: [[light]] needs 'type'"},
    {"[[light]]\ntype = 'point'\nposition = [0,0,0]\ndirection = [0,1,0]\n",
     "s.toml: line 4: [[light]] has no key 'direction'"},
    {"[[light]]\ntype = 'spot'\nposition = [0,0,0]\ndirection = [0,0,0]\n",
     "s.toml: line 4: 'direction' of [[light]] must be a vector with a length"},
    {"[[camera]]\nlook_from = [0,0,0]\nlook_at = [0,0,0]\n",
     "s.toml: line 2: [[camera]]: the camera is at the point that it looks at"},
    {"[[camera]]\nlook_from = [0,0,1]\nlook_at = [0,0,0]\nfov = 180\n",
     "s.toml: line 4: 'fov' of [[camera]] must be a number between 0 and 180"},
    {"[environment]\ncolor = [1,1,1]\nnone = true\n",
     "s.toml: line 3: 'color' and 'none' of [environment] exclude each other"},
    {"[environment]\nintensity = 2\n",
     "s.toml: line 1: [environment] needs 'image', 'color', 'default = true' or 'none = true'"},
    {"[[file]]\nname = 'f'\npath = 'nothing.glb'\n", "s.toml: line 3: there is no file 'nothing.glb'"},
    {"[[file]]\nname = 'f'\npath = '/dev/zero'\n", "s.toml: line 3: there is no file '/dev/zero'"},
};

TEST(SceneTomlErrors, NameThePlaceAndTheNearestName) {
  for (const Mistake& mistake : kMistakes) {
    SCOPED_TRACE(mistake.text);
    const std::string message = errorOf(mistake.text);
    const std::string expected = mistake.message;
    if (expected.ends_with(": "))
      EXPECT_THAT(message, testing::StartsWith(expected));
    else
      EXPECT_EQ(message, expected);
  }
}

TEST(SceneTomlErrors, AbsurdSizesAreRefusedBeforeTheyAreMade) {
  constexpr std::size_t kLimit = std::size_t{64} << 20;
  for (const char* text : {"[[spheres]]\nrandom = { count = 200000000, box = [[0,0,0],[1,1,1]] }\n",
                           "[[custom]]\ngrid = { count = [1000, 1000, 100], spacing = 1 }\n",
                           "[[mesh]]\nshape = 'quad'\nsegments = 4096\n",
                           "[[mesh]]\nname = 'm'\nshape = 'quad'\n[[instance]]\nof = 'm'\nrandom = { count = 10000000, "
                           "box = [[0,0,0],[1,1,1]] }\n"})
    EXPECT_THAT(errorOf(text, kLimit), testing::HasSubstr("needs more than 0.1 GiB of memory")) << text;
  // Trees that double: 2^40 leaves by name.
  std::string text = "[[csg]]\nname = 't0'\ntree = { sphere = {} }\n";
  for (int i = 1; i <= 40; ++i)
    text += "[[csg]]\nname = 't" + std::to_string(i) + "'\ntree = { union = [ { csg = 't" + std::to_string(i - 1) +
            "' }, { csg = 't" + std::to_string(i - 1) + "' } ] }\n";
  EXPECT_THAT(errorOf(text), testing::HasSubstr("a tree has at most 65536 nodes"));
}

TEST(SceneTomlErrors, KeysThatWouldOverflowTheStackAreRefused) {
  std::string dots;
  for (int i = 0; i < 200000; ++i) dots += ".a";
  EXPECT_EQ(errorOf("# x\na" + dots + " = 1\n"), "s.toml: line 2: a dotted key of more than 16 levels");
  EXPECT_EQ(errorOf("[a" + dots + "]\n"), "s.toml: line 1: a dotted key of more than 16 levels");
  EXPECT_EQ(errorOf("[[a" + dots + "]]\n"), "s.toml: line 1: a dotted key of more than 16 levels");
  EXPECT_EQ(errorOf("a = [\n'''it's\n''', { \"a\"" + dots + " = 1 } ]\n"),
            "s.toml: line 3: a dotted key of more than 16 levels");
  EXPECT_EQ(errorOf("a = \"\\\"\"\nb" + dots + " = 2\n"), "s.toml: line 2: a dotted key of more than 16 levels");
  // The deepest that is let through.
  std::string nested = "1";
  for (int i = 0; i < 250; ++i) nested = "{ a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = " + nested + " }";
  EXPECT_EQ(errorOf("b = " + nested + "\n"), "s.toml: line 1: nested more than 300 deep");
  // Dots in strings, comments and numbers are no keys.
  EXPECT_EQ(errorOf("# " + dots + "\n[[mesh]]\nshape = 'quad'\nname = '" + dots + "'\ntranslate = [1.5, 2.5, 3.5]\n"),
            "none");
}

// Swaps, drops and doubles of bytes, words and lines, and numbers replaced by nasty ones.
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
      default: {  // another number
        const std::size_t number = text.find_first_of("0123456789", at);
        if (number != std::string::npos)
          text.replace(number, text.find_first_not_of("0123456789.", number) - number,
                       kNumbers[below(std::size(kNumbers))]);
      }
    }
  }
  return text;
}

// What a renderer asks of a scene on the host.
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

TEST(SceneTomlFuzz, MutatedScenesLoadOrSayWhy) {
  const std::filesystem::path folder = std::filesystem::path(QUINTET_SOURCE_ROOT) / "examples/scenes";
  std::mt19937 random(20261121);
  std::size_t loaded = 0, refused = 0;
  for (const char* name : {"csg.scene.toml", "spheres.scene.toml", "instances.scene.toml"}) {
    const std::string original = readTextFile(folder / name);
    EXPECT_NO_THROW(scene::validate(scene::loadScene(folder / name))) << name;
    for (int i = 0; i < 400; ++i) {
      try {
        const scene::Scene loadedScene =
            scene::parseSceneToml(mutated(original, random), folder / name, {std::size_t{4} << 20});
        scene::validate(loadedScene);
        useEverything(loadedScene);
        ++loaded;
      } catch (const Error& error) {
        const std::string message = error.what();
        ++refused;
        ASSERT_FALSE(message.empty());
        for (const char c : message) ASSERT_FALSE(c >= 0 && c < ' ') << message;
        ASSERT_TRUE(message.find("scene: ") == std::string::npos) << "only found by validate: " << message;
      }
    }
  }
  EXPECT_GT(loaded, 200u);
  EXPECT_GT(refused, 500u);
}

}  // namespace
}  // namespace quintet::test
