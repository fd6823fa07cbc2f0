// SPDX-License-Identifier: Apache-2.0
#include "lab/file_downloads.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/file.h"
#include "lab/file_message.h"
#include "temp_folder.h"

namespace quintet::lab {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(FileMessage, HasAHeaderAndTheBytes) {
  const std::string message =
      fileMessage({.file = 7, .offset = 0x123456789aull, .bytes = std::string_view("ab\0c", 4)});
  EXPECT_EQ(message.size(), kFileHeaderBytes + 4);
  EXPECT_TRUE(message.starts_with("QFIL\x01"));
  const auto part = parseFileMessage(message);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->file, 7u);
  EXPECT_EQ(part->offset, 0x123456789aull);
  EXPECT_EQ(part->bytes, std::string_view("ab\0c", 4));
  EXPECT_FALSE(parseFileMessage(message.substr(0, kFileHeaderBytes - 1)));
  EXPECT_FALSE(parseFileMessage("QIMG" + message.substr(4)));
}

TEST(FileDownloads, OffersOneFileAtATimeInParts) {
  const quintet::test::TempFolder folder;
  FileDownloads downloads(folder.path());
  EXPECT_THROW(downloads.part(0, 0), UsageError);
  const std::string content(kFilePartBytes + 10, 'x');
  writeFile(downloads.pathFor("exr"), content);
  EXPECT_THAT(downloads.offer(downloads.pathFor("exr"), "image.exr", "image/x-exr"),
              HasSubstr(R"("file":1,"name":"image.exr","type":"image/x-exr","size":4194314)"));
  const std::string first = downloads.part(1, 0), second = downloads.part(1, kFilePartBytes);
  EXPECT_EQ(std::string(parseFileMessage(first)->bytes) + std::string(parseFileMessage(second)->bytes), content);
  EXPECT_EQ(parseFileMessage(second)->offset, kFilePartBytes);
  EXPECT_TRUE(parseFileMessage(downloads.part(1, content.size()))->bytes.empty());

  writeFile(downloads.pathFor("gif"), "new");
  downloads.offer(downloads.pathFor("gif"), "video.gif", "image/gif");
  EXPECT_EQ(parseFileMessage(downloads.part(2, 0))->bytes, "new");
  EXPECT_THROW(downloads.part(1, 0), UsageError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "the file before is removed";
}

}  // namespace
}  // namespace quintet::lab
