// SPDX-License-Identifier: Apache-2.0
// The SPIR-V disk cache: hits are identical, keys cover all inputs, corrupt entries are ignored.
#include "shader/spirv_cache.h"

#include <chrono>
#include <fstream>

#include "shader_test_support.h"

namespace quintet::shader {
namespace {

class ShaderCache : public testing::Test {
 protected:
  ShaderCache() { options.cacheFolder = cache.path() / "deep" / "er"; }
  Result compile(const Source& source) const { return Compiler(options).compile(source); }
  std::vector<std::filesystem::path> entries() const {
    std::vector<std::filesystem::path> files;
    if (std::filesystem::exists(options.cacheFolder))
      for (const auto& entry : std::filesystem::directory_iterator(options.cacheFolder)) files.push_back(entry.path());
    return files;
  }

  TemporaryFolder cache;
  CompilerOptions options;
};

TEST_F(ShaderCache, ReturnsTheSameSpirvWarningsAndFiles) {
  const TemporaryFolder folder;
  folder.write("one.glsl", "#extension GL_EXT_does_not_exist : enable\n");
  const Source source = computeSource("#include \"one.glsl\"", "b.x = 3;", (folder.path() / "m.comp").string());
  const Result first = compile(source), second = compile(source);
  ASSERT_TRUE(first.ok()) << all(first);
  EXPECT_FALSE(first.fromCache);
  EXPECT_TRUE(second.fromCache);
  EXPECT_EQ(first.spirv, second.spirv);
  EXPECT_EQ(all(first), all(second));
  EXPECT_FALSE(all(second).empty());
  EXPECT_EQ(first.files, second.files);
  EXPECT_EQ(first.fileHashes, second.fileHashes);
  EXPECT_EQ(first.fileHashes.size(), 1u);
  EXPECT_EQ(entries().size(), 1u);
}

// Large modules are also found by the output of glslang.
TEST_F(ShaderCache, OptimizesEqualModulesOnce) {
  std::string body;
  for (int k = 0; k < 2000; ++k) body += "b.x = b.x * K + " + std::to_string(k) + ";\n";
  Source source = computeSource("#ifndef K\n#define K 3\n#endif", body);
  const Result plain = compile(source);
  ASSERT_TRUE(plain.ok()) << all(plain);
  EXPECT_EQ(entries().size(), 2u);
  source.defines = {{"UNUSED", ""}};
  const Result same = compile(source);
  EXPECT_FALSE(same.fromCache);
  EXPECT_EQ(same.spirv, plain.spirv);
  EXPECT_EQ(entries().size(), 3u);
  source.defines = {{"K", "5"}};
  EXPECT_NE(compile(source).spirv, plain.spirv);
  EXPECT_EQ(entries().size(), 5u);
}

TEST_F(ShaderCache, DependsOnSourceStageDefinesIncludesAndOptions) {
  const TemporaryFolder folder;
  Source source = computeSource("#include <x.glsl>\n#ifdef D\n#endif", "b.x = 3;");
  folder.write("x.glsl", "int f();\n");
  options.includeFolders = {folder.path()};
  const auto misses = [&] { return !compile(source).fromCache && compile(source).fromCache; };
  EXPECT_TRUE(misses());
  source.defines = {{"D", ""}};
  EXPECT_TRUE(misses());
  source.defines = {{"D", "1"}};
  EXPECT_TRUE(misses());
  folder.write("x.glsl", "int g();\n");
  EXPECT_TRUE(misses());
  source.virtualFiles["x.glsl"] = "int h();\n";
  EXPECT_TRUE(misses());
  source.text += "\n";
  EXPECT_TRUE(misses());
  options.optimize = false;
  EXPECT_TRUE(misses());
  options.debugInfo = false;
  EXPECT_TRUE(misses());
  source.name = "other.comp";
  EXPECT_TRUE(misses());
}

TEST_F(ShaderCache, NoticesAFileEarlierInTheSearchOrder) {
  const TemporaryFolder first, second;
  options.includeFolders = {first.path(), second.path()};
  second.write("x.glsl", "#define X 1\n");
  const Source source = computeSource("#include <x.glsl>", "b.x = X;");
  const Result before = compile(source);
  first.write("x.glsl", "#define X 2\n");
  const Result after = compile(source);
  EXPECT_FALSE(after.fromCache);
  EXPECT_NE(before.spirv, after.spirv);
}

TEST_F(ShaderCache, DoesNotStoreResultsWithUnknownIncludes) {
  Source source = computeSource("/**/ #include <x.glsl>", "b.x = X;");
  source.virtualFiles["x.glsl"] = "#define X 1\n";
  Source hidden = computeSource("# /**/ include <x.glsl>", "b.x = X;");
  hidden.virtualFiles = source.virtualFiles;
  for (const Source& s : {source, hidden}) {
    const Result before = compile(s);
    ASSERT_TRUE(before.ok()) << all(before);
    Source changed = s;
    changed.virtualFiles["x.glsl"] = "#define X 2\n";
    EXPECT_NE(compile(changed).spirv, before.spirv);
  }
}

TEST_F(ShaderCache, DoesNotStoreFailures) {
  EXPECT_FALSE(compile(computeSource("int f() { return nowhere; }")).ok());
  EXPECT_TRUE(entries().empty());
}

TEST_F(ShaderCache, ReplacesCorruptEntries) {
  const Compiler compiler(options);
  const Source source = computeSource("", "b.x = 3;");
  const Result good = compiler.compile(source);
  ASSERT_EQ(entries().size(), 1u);
  const std::filesystem::path file = entries()[0];
  const std::vector<std::byte> bytes = readFile(file);
  std::vector<std::vector<std::byte>> corrupt;
  for (std::size_t size = 0; size < bytes.size(); size += 23)
    corrupt.emplace_back(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    corrupt.push_back(bytes);
    corrupt.back()[at] ^= std::byte{0x40};
  }
  corrupt.push_back(bytes);
  corrupt.back().push_back(std::byte{0});
  for (const auto& data : corrupt) {
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data.data()), std::ssize(data));
    const Result result = compiler.compile(source);
    ASSERT_FALSE(result.fromCache);
    ASSERT_EQ(result.spirv, good.spirv);
    ASSERT_EQ(readFile(file), bytes);  // replaced
  }
}

TEST_F(ShaderCache, IgnoresAnEntryWithADifferentKey) {
  const Source one = computeSource("", "b.x = 1;"), two = computeSource("", "b.x = 2;");
  const Result first = compile(one);
  const std::filesystem::path file = entries().at(0);
  compile(two);
  for (const auto& other : entries())
    if (other != file) std::filesystem::copy_file(file, other, std::filesystem::copy_options::overwrite_existing);
  const Result second = compile(two);
  EXPECT_FALSE(second.fromCache);
  EXPECT_NE(first.spirv, second.spirv);
}

TEST_F(ShaderCache, IgnoresAFolderThatCannotBeWritten) {
  const auto file = cache.write("file", "not a folder");
  options.cacheFolder = file / "sub";
  EXPECT_TRUE(compile(computeSource("")).ok());
  options.cacheFolder = "/proc/nowhere";
  EXPECT_TRUE(compile(computeSource("")).ok());
}

TEST_F(ShaderCache, IsInMemoryWithoutAFolder) {
  const Source source = computeSource("", "b.x = 1;");
  const Compiler compiler({.cacheFolder = {}});
  const Result first = compiler.compile(source), second = compiler.compile(source);
  EXPECT_FALSE(first.fromCache);
  EXPECT_TRUE(second.fromCache);
  EXPECT_EQ(first.spirv, second.spirv);
  EXPECT_EQ(all(first), all(second));
  EXPECT_FALSE(Compiler({.cacheFolder = {}}).compile(source).fromCache) << "each compiler has its own";
}

TEST_F(ShaderCache, KeepsTheMostRecentlyUsedEntriesInMemory) {
  const SpirvCache memory({});
  SpirvEntry entry;
  entry.spirv.assign(SpirvCache::kMaxBytesInMemory / 10 / sizeof(std::uint32_t), 0x0723'0203);
  for (std::uint64_t k = 0; k < 10; ++k) memory.store({0, k}, entry);
  ASSERT_TRUE(memory.load({0, 0}));  // now the most recently used
  for (std::uint64_t k = 10; k < 15; ++k) memory.store({0, k}, entry);
  for (std::uint64_t k = 0; k < 15; ++k) EXPECT_EQ(memory.load({0, k}).has_value(), k == 0 || k > 5) << k;
  memory.store({0, 99}, {});  // a failed compilation
  EXPECT_FALSE(memory.load({0, 99}));
}

TEST_F(ShaderCache, PrunesTheLeastRecentlyUsedEntries) {
  const SpirvCache store(cache.path());
  SpirvEntry entry;
  entry.spirv.assign(1000, 0x0723'0203);
  const auto now = std::filesystem::file_time_type::clock::now();
  for (std::uint64_t k = 0; k < 10; ++k) {
    store.store({0, k}, entry);
    std::filesystem::last_write_time(cache.path() / (Hash{0, k}.hex() + ".qspv"), now - std::chrono::hours(10 - k));
  }
  cache.write("other.txt", "kept");
  ASSERT_TRUE(store.load({0, 0}));  // now the most recently used
  store.prune(5 * 4200);
  for (std::uint64_t k = 0; k < 10; ++k) EXPECT_EQ(store.load({0, k}).has_value(), k == 0 || k > 5) << k;
  EXPECT_TRUE(std::filesystem::exists(cache.path() / "other.txt"));
}

}  // namespace
}  // namespace quintet::shader
