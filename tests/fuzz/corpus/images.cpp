// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <random>

#include "io/basis_lz_builder.h"
#include "io/exr_samples.h"
#include "io/ktx2_builder.h"
#include "io/samples.h"
#include "seeds.h"

namespace quintet::fuzz {
namespace {

using io::test::Bytes;

// A file of each supported format (VkFormat): 5 x 5 pixels fill four blocks.
void addKtx2Formats(std::vector<Seed>& seeds) {
  for (std::uint32_t format = 9; format <= 146; ++format) {
    // The size is that of the format; other sizes are not valid.
    for (const std::size_t size : {25u, 32u, 50u, 64u, 75u, 100u, 150u, 200u, 300u, 400u}) {
      io::test::Ktx2 file{.format = format, .width = 5, .height = 5, .level = Bytes(size)};
      for (std::size_t i = 0; i < size; ++i) file.level[i] = static_cast<std::byte>(101 * i + 7 * format);
      Bytes bytes = file.build();
      try {
        (void)io::decodeImage(bytes, "seed");
      } catch (const std::exception&) {
        continue;
      }
      seeds.push_back({"format_" + std::to_string(format) + ".ktx2", std::move(bytes)});
    }
  }
}

// Basis Universal with every kind of symbol of BasisLZ, and arbitrary blocks of UASTC.
void addBasisUniversal(std::vector<Seed>& seeds) {
  std::mt19937 random(1);
  for (unsigned i = 0; i < 16; ++i) {
    io::test::BasisLzImage image;
    image.width = static_cast<std::uint32_t>(1 + random() % 60);
    image.height = static_cast<std::uint32_t>(1 + random() % 60);
    image.gray = i % 4 == 1, image.rawSelectors = i % 4 == 2, image.skewed = i % 2 == 1;
    image.historySize = i % 3 * 7;
    image.fill(random, 1 + random() % 40, 1 + random() % 40, 1 + i % 2);
    io::test::Ktx2 file = i % 2 == 0 ? image.file(random, {i == 0 ? 3 : 0}) : image.file(random, {0, 15});
    seeds.push_back({"basis_lz_" + std::to_string(i) + ".ktx2", file.build()});
  }
  io::test::Ktx2 blocks{.format = 0, .width = 128, .height = 4, .level = Bytes(32 * 16)};
  for (std::byte& byte : blocks.level) byte = static_cast<std::byte>(random());
  for (const int channels : {0, 3, 4, 5, 6}) {
    blocks.describe(166, {channels});
    seeds.push_back({"uastc_" + std::to_string(channels) + ".ktx2", blocks.build()});
  }
}

}  // namespace

void addImageSeeds(Corpora& corpora) {
  const std::map<std::string, std::string> targets{{"png", "png"}, {"jpg", "jpeg"}, {"webp", "webp"},
                                                   {"hdr", "hdr"}, {"exr", "exr"},  {"ktx2", "ktx2"}};
  for (const io::test::Sample& sample : io::test::allSamples())
    corpora[targets.at(sample.name.substr(sample.name.rfind('.') + 1))].push_back({sample.name, sample.bytes});
  for (const auto compression : {io::ExrCompression::none, io::ExrCompression::rle, io::ExrCompression::zips,
                                 io::ExrCompression::piz, io::ExrCompression::dwaa, io::ExrCompression::dwab}) {
    const std::string& name = io::exrCompressionNames()[static_cast<std::size_t>(compression)];
    corpora["exr"].push_back(
        {"layers_" + name + ".exr", io::encodeExr(io::test::layeredImage(7, 5), {.compression = compression})});
  }
  addKtx2Formats(corpora["ktx2"]);
  addBasisUniversal(corpora["ktx2"]);
}

}  // namespace quintet::fuzz
