// SPDX-License-Identifier: Apache-2.0
// Files that cannot be written and devices that do not exist: status 1, one line, and no incomplete files.
#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

class Output : public CliTest {
 protected:
  void expectNoNewFiles() { EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"}); }
};

TEST_F(Output, MissingFolder) {
  expectError(quintet(quick({"-o", "no/such/out.png"})), 1, {"no/such/out.png", "does not exist"});
  expectNoNewFiles();
}

TEST_F(Output, FolderInsteadOfAFile) {
  std::filesystem::create_directory(folder_ / "out.png");
  std::filesystem::create_directory(folder_ / "out");
  expectError(quintet(quick({"-o", "out.png"})), 1, {"out.png", "directory"});
  expectError(quintet(quick({"-o", "out"})), 1, {"out", "directory"});
}

TEST_F(Output, FolderWithoutPermission) {
  if (::geteuid() == 0) {
    // Root may write everywhere except in the kernel's own folders.
    expectError(quintet(quick({"-o", "/proc/out.png"})), 1, {"/proc/out.png", "cannot be written"});
  } else {
    std::filesystem::create_directory(folder_ / "locked");
    std::filesystem::permissions(folder_ / "locked", std::filesystem::perms::owner_read);
    expectError(quintet(quick({"-o", "locked/out.png"})), 1, {"locked/out.png", "cannot be written"});
  }
}

TEST_F(Output, FullDevice) {
  expectError(quintet(quick({"-o", "/dev/full"})), 1, {"/dev/full", "No space left"});
  expectNoNewFiles();
}

// Like a full disk: the temporary file is created, but no byte can be written. (A device on the CPU would not start under
// this limit, because its memory is in files without names.)
TEST_F(Output, FileSizeLimit) {
  write(folder_ / "a.png", io::encodePng(testImage(8, 8)));
  write(folder_ / "old.png", "older contents");
  RunOptions options;
  options.shell = "ulimit -f 0";
  expectError(quintet({"compare", "a.png", "a.png", "-o", "new.png"}, options), 1, {"new.png", "cannot be written"});
  expectError(quintet({"compare", "a.png", "a.png", "-o", "old.png"}, options), 1, {"old.png", "cannot be written"});
  EXPECT_EQ(std::filesystem::file_size(folder_ / "old.png"), 14u);
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"a.png", "old.png", "scene.gltf"}));
}

TEST_F(Output, StandardOutputFullOrClosed) {
  RunOptions full;
  full.out = "/dev/full";
  expectError(quintet(quick({"-o", "-"}), full), 1, {"standard output", "No space left"});
  expectError(quintet({"info", "scene.gltf"}, full), 1, {"standard output", "No space left"});
  expectError(quintet({"--version"}, full), 1, {"standard output", "No space left"});
  RunOptions closed;
  closed.shell = "exec >&-";
  expectError(quintet(quick({"-o", "-"}), closed), 1, {"standard output", "cannot be written"});
  expectError(quintet(quick({"-o", "out.png", "--json"}), closed), 1, {"standard output", "cannot be written"});
  expectError(quintet({"info", "scene.gltf"}, closed), 1, {"standard output", "cannot be written"});
}

TEST_F(Output, SuccessWithAllStreamsClosed) {
  RunOptions closed;
  closed.shell = "exec <&- >&- 2>&-";
  const RunResult result = quintet(quick({"-o", "out.png"}), closed);
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(readImage("out.png").width, 32u);
}

TEST_F(Output, ImagesOfCompare) {
  write(folder_ / "a.png", io::encodePng(testImage(8, 8)));
  expectError(quintet({"compare", "a.png", "a.png", "-o", "no/diff.png"}), 1, {"no/diff.png"});
  expectError(quintet({"compare", "a.png", "a.png", "-o", "diff.jpg"}), 2, {"diff.jpg", ".png"});
  expectError(quintet({"compare", "a.png", "a.png", "--side-by-side", "-"}), 2, {"--side-by-side"});
}

// OpenEXR and Radiance HDR through a pipe have the pixels of the files.
TEST_F(Output, FormatOfStandardOutput) {
  for (const std::string& extension : {std::string(".exr"), std::string(".hdr"), std::string(".png")}) {
    ASSERT_EQ(quintet(quick({"-o", "file" + extension})).status, 0);
    const RunResult result = quintet(quick({"-o", "-" + extension}));
    ASSERT_EQ(result.status, 0) << result.err;
    write(folder_ / "pipe", result.out);
    EXPECT_EQ(readImage("pipe").data, readImage("file" + extension).data) << extension;
    std::filesystem::remove(folder_ / "pipe");
    std::filesystem::remove(folder_ / ("file" + extension));
  }
  const RunResult layers =
      quintet({"render", "scene.gltf", "--size", "8x8", "--spp", "1", "-q", "-o", "-.exr", "--aov", "albedo"});
  EXPECT_NE(layers.out.find("albedo.R"), std::string::npos);
  expectError(quintet(quick({"-o", "-.qfilm"})), 2, {"film"});
  expectJsonError(quintet(quick({"-o", "-.exr", "--json"})), 2, {"--json", "-.exr"});
  expectNoNewFiles();
}

TEST_F(Output, PngWith16Bits) {
  ASSERT_EQ(quintet(quick({"-o", "deep.png", "--png-bits", "16"})).status, 0);
  ASSERT_EQ(quintet(quick({"-o", "flat.png"})).status, 0);
  const io::Image deep = readImage("deep.png"), flat = readImage("flat.png");
  ASSERT_EQ(deep.type, io::PixelType::u16);
  ASSERT_EQ(flat.type, io::PixelType::u8);
  for (std::uint32_t x = 0; x < 32; ++x)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(deep.pixel<std::uint16_t>(x, 12)[c] / 257.0, flat.pixel<std::uint8_t>(x, 12)[c], 0.51) << x;
  expectError(quintet(quick({"-o", "a.png", "--png-bits", "12"})), 2, {"--png-bits", "12"});
  expectError(quintet(quick({"-o", "a.exr", "--png-bits", "16"})), 2, {"a.exr", "PNG"});
}

// Each of several files is checked before the render starts.
TEST_F(Output, ChecksEachFileBeforeItStarts) {
  std::filesystem::create_directory(folder_ / "f0000.png");
  const RunResult result = quintet({"run", "normals", "scene.gltf", "-o", "f####.png", "--size", "4000x4000"});
  expectError(result, 1, {"f0000.png", "directory"});
}

class Device : public CliTest {};

TEST_F(Device, NoVulkanDevice) {
  RunOptions none;
  none.environment = {{"VK_DRIVER_FILES", "/nonexistent/icd.json"}, {"VK_ICD_FILENAMES", "/nonexistent/icd.json"}};
  expectError(quintet(quick({"-o", "out.png"}), none), 1, {"Vulkan"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  const RunResult info = quintet({"info"}, none);
  EXPECT_EQ(info.status, 0);
  EXPECT_NE(info.out.find("Vulkan"), std::string::npos) << info.out;
  EXPECT_EQ(nlohmann::json::parse(quintet({"info", "--json"}, none).out)["devices"].size(), 0u);
}

TEST_F(Device, UnknownDevice) {
  expectError(quintet(quick({"--device", "voodoo2"})), 1, {"'voodoo2'", "0: "});  // and the available ones
  RunOptions requested;
  requested.environment = {{"QUINTET_DEVICE", "voodoo2"}};
  expectError(quintet(quick({}), requested), 1, {"voodoo2"});
}

TEST_F(Device, ImageThatExceedsItsMemory) {
  expectError(quintet(quick({"--size", "65536x65536", "-o", "out.png"})), 1, {"65536x65536", "GiB", "--region"});
}

}  // namespace
}  // namespace quintet::test
