// SPDX-License-Identifier: Apache-2.0
// Films: layers as arrays, files, and merging.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("api_" + name);
}

TEST(ApiFilm, HoldsRequestedLayers) {
  Settings settings = smallImage();
  settings.outputs = {"albedo", "depth", "instance_id", "cryptomatte_object"};
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  renderer.render(8);
  const Film film = renderer.film();
  EXPECT_EQ(film.width(), 48u);
  EXPECT_EQ(film.height(), 32u);
  EXPECT_EQ(film.sampleCount(), 8);
  EXPECT_THAT(film.layers(), Contains("albedo"));
  EXPECT_THAT(film.layers(), Contains("variance"));
  EXPECT_THAT(film.layers(), Not(Contains("normal")));
  EXPECT_THROW(film.layer("normal"), UsageError);
  EXPECT_EQ(film.image().pixels, renderer.image().pixels);
  EXPECT_EQ(film.image("albedo").pixels, renderer.image("albedo").pixels);

  const Layer depth = film.layer("depth");
  EXPECT_THAT(depth.channels, ElementsAre("Z"));
  ASSERT_EQ(depth.values.size(), 48u * 32u);
  const Layer ids = film.layer("instance_id");
  ASSERT_EQ(ids.ids.size(), 48u * 32u);
  EXPECT_TRUE(ids.values.empty());
  EXPECT_EQ((std::set<std::uint32_t>(ids.ids.begin(), ids.ids.end())),
            (std::set<std::uint32_t>{0, 1, 3}));  // the lamp is above the image
  for (std::size_t i = 0; i < ids.ids.size(); ++i)
    EXPECT_EQ(ids.ids[i] != 0, std::isfinite(depth.values[i]) && depth.values[i] > 2.5f && depth.values[i] < 10) << i;
  const Layer albedo = film.layer("albedo");
  EXPECT_THAT(albedo.channels, ElementsAre("R", "G", "B"));
  EXPECT_EQ(albedo.values[3 * (28 * 48 + 24)], film.image("albedo").at(24, 28)[0]);
  EXPECT_EQ(film.layer("cryptomatte_object").values.size() % (48 * 32), 0u);
  EXPECT_EQ(film.layer("sample_count").values[7], 8.0f);
}

TEST(ApiFilm, AllOutputsOfAProgramCanBeRead) {
  Settings settings = smallImage();
  settings.outputs = {"all"};
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  renderer.render(4);
  const Film film = renderer.film();
  const std::vector<OutputInfo> outputs = pathTracer().outputs();
  ASSERT_GT(outputs.size(), 10u);
  EXPECT_FALSE(outputs[0].optional);
  for (std::size_t i = 1; i < outputs.size(); ++i) {
    const Layer layer = film.layer(outputs[i].name);
    EXPECT_EQ(layer.values.size() + layer.ids.size(), layer.channels.size() * 48 * 32) << layer.name;
  }
}

TEST(ApiFilm, SurvivesAFile) {
  Settings settings = smallImage();
  settings.outputs = {"albedo"};
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  renderer.render(4);
  const Film film = renderer.film();
  const std::filesystem::path file = temporary("film.qfilm");
  film.write(file);
  const Film loaded = Film::load(file);
  EXPECT_EQ(loaded.image().pixels, film.image().pixels);
  EXPECT_EQ(loaded.layer("albedo").values, film.layer("albedo").values);
  EXPECT_EQ(loaded.layers(), film.layers());
  EXPECT_THROW(Film::load(temporary("missing.qfilm")), FileError);
  EXPECT_THROW(Film::load(file, 1000), MemoryError);
  EXPECT_THROW(Film::merge({file}, 1000), MemoryError);
  settings.maxMemory = 1000;
  Renderer limited(device(), lampScene(), pathTracer(), settings);
  EXPECT_THROW(limited.resume(file), MemoryError);
  std::filesystem::remove(file);
}

TEST(ApiFilm, MergesPartsToTheSameBytes) {
  const Scene scene = lampScene();
  std::vector<std::filesystem::path> parts;
  for (const Batches batches : {Batches{0, 1}, Batches{2, 2}}) {
    Settings settings = smallImage();
    settings.plannedSamples = 12;
    settings.batches = batches;
    Renderer renderer(device(), scene, pathTracer(), settings);
    EXPECT_EQ(renderer.render({.samples = 12}).reason, StopReason::samples);
    parts.push_back(temporary("part" + std::to_string(batches.first) + ".qfilm"));
    renderer.film().write(parts.back());
  }
  Settings whole = smallImage();
  whole.plannedSamples = 12;
  EXPECT_EQ(Film::merge(parts).image().pixels, rendered(scene, whole, 12));
  EXPECT_THROW(Film::merge({parts[0], parts[0]}), FileError);
  for (const std::filesystem::path& part : parts) std::filesystem::remove(part);
}

TEST(ApiFilm, WritesPngAsRequested) {
  Renderer renderer(device(), lampScene(), pathTracer(), smallImage());
  renderer.render(4);
  const Film film = renderer.film();
  const std::filesystem::path file = temporary("options.png");
  std::set<std::string> files;
  for (const WriteOptions& options : {WriteOptions{}, WriteOptions{.toneMap = "linear"}, WriteOptions{.toneMap = "agx"},
                                      WriteOptions{.pngBits = 16}}) {
    film.write(file, options);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    ASSERT_GT(bytes.size(), 25u);
    EXPECT_EQ(bytes[24], static_cast<char>(options.pngBits));  // IHDR: bit depth
    files.insert(bytes);
  }
  EXPECT_EQ(files.size(), 4u);
  EXPECT_THROW(film.write(file, {.toneMap = "acess"}), UsageError);
  EXPECT_THROW(film.write(file, {.pngBits = 12}), UsageError);
  std::filesystem::remove(file);
}

TEST(ApiFilm, WritesLayersToOpenExr) {
  Settings settings = smallImage();
  settings.outputs = {"albedo", "depth"};
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  renderer.render(4);
  const std::filesystem::path file = temporary("layers.exr");
  renderer.film().write(file, {.layers = {"albedo", "depth"}});
  std::ifstream in(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  for (const char* channel : {"R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "depth.Z"}) {
    // An entry of the list of channels is a name that ends with a zero, and its type: 2 for float, 1 for half.
    const std::string entry = std::string(1, '\0') + channel + std::string(1, '\0');
    const std::size_t at = bytes.find(entry);
    ASSERT_NE(at, bytes.npos) << channel;
    EXPECT_THAT(bytes[at + entry.size()], testing::AnyOf('\1', '\2')) << channel;
  }
  EXPECT_EQ(bytes.find("normal."), bytes.npos);
  EXPECT_THROW(renderer.film().write(temporary("layers.png"), {.layers = {"albedo"}}), UsageError);
  EXPECT_THROW(renderer.film().write(file, {.layers = {"albdo"}}), UsageError);
  EXPECT_THROW(renderer.film().write(temporary("image.txt")), UsageError);
  EXPECT_THROW(renderer.film().write("/nonexistent/image.png"), FileError);
  for (const char* name : {"-", "-.png", "-.exr"}) {
    EXPECT_THROW(renderer.film().write(name), UsageError) << name << " means standard output";
    EXPECT_THROW(renderer.image().write(name), UsageError) << name;
  }
  EXPECT_THROW(renderer.image().write(temporary("image.qfilm")), UsageError);
  EXPECT_THROW(renderer.image().write(temporary("image.txt")), UsageError);
  std::filesystem::remove(file);
}

TEST(ApiFilm, MetadataNamesTheProgram) {
  Renderer renderer(device(), lampScene(), pathTracer(), smallImage());
  renderer.render(4);
  EXPECT_THAT(renderer.film().metadata(), Contains(std::pair<std::string, std::string>("Program", "pathtracer")));
}

}  // namespace
}  // namespace quintet::test
