// SPDX-License-Identifier: Apache-2.0
#include "lab/zip.h"

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::lab {
namespace {

using Files = std::map<std::string, std::string>;

const Files kFiles{{"mine/program.toml", "[program]\n"},
                   {"mine/empty.glsl", ""},
                   {"mine/long.glsl", std::string(100000, 'x')},
                   {"mine/größe.bin", std::string("\0\1\2\xFF", 4)}};

TEST(Zip, ReadsWhatItWrote) { EXPECT_EQ(unzipFiles(zipFiles(kFiles)), kFiles); }

TEST(Zip, CompressesAndIsDeterministic) {
  EXPECT_EQ(zipFiles(kFiles), zipFiles(kFiles));
  EXPECT_LT(zipFiles(kFiles).size(), 2000u);
}

TEST(Zip, ReadsArchivesWithAComment) {
  std::string archive = zipFiles(kFiles);
  archive[archive.size() - 2] = 5;
  EXPECT_EQ(unzipFiles(archive + "hello"), kFiles);
}

TEST(Zip, RejectsEveryTruncation) {
  const std::string archive = zipFiles({{"a", "text"}, {"b", std::string(300, 'b')}});
  for (std::size_t size = 0; size < archive.size(); ++size)
    EXPECT_THROW(unzipFiles(std::string_view(archive).substr(0, size)), FileError) << size;
}

// A changed byte is either rejected or belongs to a field that is not read, such as the time.
TEST(Zip, NeverReturnsDifferentContents) {
  const Files files{{"a", "some text"}, {"b", std::string(300, 'b')}};
  const std::string archive = zipFiles(files);
  for (std::size_t i = 0; i < archive.size(); ++i) {
    std::string changed = archive;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    try {
      for (const auto& [name, content] : unzipFiles(changed))
        EXPECT_TRUE(content == files.at("a") || content == files.at("b")) << i;
    } catch (const FileError&) {
    }
  }
}

TEST(Zip, RejectsContentsAboveTheLimit) {
  std::string archive = zipFiles({{"a", "text"}});
  const std::size_t central = archive.find("PK\1\2");
  for (std::size_t i = 0; i < 4; ++i) archive[central + 24 + i] = '\x7F';  // the stated size
  EXPECT_THROW(unzipFiles(archive), FileError);
}

}  // namespace
}  // namespace quintet::lab
