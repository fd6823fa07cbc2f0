// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

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
}

}  // namespace quintet::fuzz
