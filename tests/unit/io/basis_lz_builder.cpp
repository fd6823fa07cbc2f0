// SPDX-License-Identifier: Apache-2.0
#include "io/basis_lz_builder.h"

#include <algorithm>
#include <cstring>

namespace quintet::io::test {
namespace {

// Lengths of a complete code for `count` symbols that differ by at most 1, plus `more`.
std::vector<std::uint8_t> evenLengths(std::size_t count, std::size_t more) {
  std::size_t bits = 0;
  while ((std::size_t{1} << bits) < count) ++bits;
  const std::size_t shorter = (std::size_t{1} << bits) - count;
  std::vector<std::uint8_t> lengths(count, static_cast<std::uint8_t>(bits + more));
  std::fill_n(lengths.begin(), shorter, static_cast<std::uint8_t>(bits + more - 1));
  return lengths;
}

// Symbols for 0 to 16 are lengths; others repeat the previous length or 0.
struct LengthSymbol {
  std::uint32_t symbol, extra, extraBits;
};
std::vector<LengthSymbol> symbolsOf(const std::vector<std::uint8_t>& lengths) {
  std::vector<LengthSymbol> symbols;
  for (std::size_t i = 0; i < lengths.size();) {
    std::size_t end = i;
    while (end < lengths.size() && lengths[end] == lengths[i]) ++end;
    auto left = static_cast<std::uint32_t>(end - i);
    const bool zero = lengths[i] == 0;
    if (!zero) symbols.push_back({lengths[i], 0, 0}), --left;
    while (left > 0) {
      const std::uint32_t longest = zero ? 138 : 134, shortest = zero ? 11 : 7, shortRun = zero ? 10 : 6;
      if (left >= shortest) {
        const std::uint32_t run = std::min(left, longest);
        symbols.push_back({zero ? 18u : 20u, run - shortest, 7}), left -= run;
      } else if (left >= 3) {
        const std::uint32_t run = std::min(left, shortRun);
        symbols.push_back({zero ? 17u : 19u, run - 3, zero ? 3u : 2u}), left -= run;
      } else {
        symbols.push_back({lengths[i], 0, 0}), --left;
      }
    }
    i = end;
  }
  return symbols;
}

class HistoryWriter {
 public:
  explicit HistoryWriter(std::size_t size) : values_(size), next_(size / 2) {}
  std::size_t find(std::uint32_t selector) const {
    return static_cast<std::size_t>(std::ranges::find(values_, selector) - values_.begin());
  }
  std::size_t size() const { return values_.size(); }
  void add(std::uint32_t selector) {
    if (values_.empty()) return;
    values_[next_] = selector;
    next_ = next_ + 1 == values_.size() ? values_.size() / 2 : next_ + 1;
  }
  void use(std::size_t i) { std::swap(values_[i], values_[i / 2]); }
  std::uint32_t front() const { return values_.empty() ? ~0u : values_[0]; }

 private:
  std::vector<std::uint32_t> values_;
  std::size_t next_;
};

struct Codes {
  BasisCodeWriter prediction, endpointDelta, selector, selectorRun;
};

// Writes one slice of `columns` columns.
Bytes writeSlice(const BasisLzImage& image, const std::vector<EtcBlock>& blocks, const Codes& codes,
                 std::mt19937& random) {
  const std::size_t columns = (image.width + 3) / 4, rows = (image.height + 3) / 4;
  std::vector<std::uint32_t> predictions(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::size_t x = i % columns, y = i / columns;
    const auto same = [&](std::size_t other) { return blocks[other].endpoint == blocks[i].endpoint; };
    std::vector<std::uint32_t> possible;
    if (x > 0 && same(i - 1)) possible.push_back(0);
    if (y > 0 && same(i - columns)) possible.push_back(1);
    if (x > 0 && y > 0 && same(i - columns - 1)) possible.push_back(2);
    if (possible.empty() || random() % 8 == 0) possible = {3};
    predictions[i] = possible[random() % possible.size()];
  }
  std::vector<std::uint32_t> groups;  // predictions of 2 x 2 blocks
  for (std::size_t y = 0; y < rows; y += 2)
    for (std::size_t x = 0; x < columns; x += 2) {
      std::uint32_t group = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (x + k % 2 < columns && y + k / 2 < rows) group |= predictions[(y + k / 2) * columns + x + k % 2] << (2 * k);
      groups.push_back(group);
    }

  BasisBitWriter bits;
  HistoryWriter history(image.historySize);
  const auto selectorCount = static_cast<std::uint32_t>(image.selectors.size());
  std::size_t group = 0, groupRun = 0, selectorRun = 0;
  std::uint32_t lastGroup = 0, endpoint = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::size_t x = i % columns, y = i / columns;
    if (x % 2 == 0 && y % 2 == 0) {
      if (groupRun > 0) {
        --groupRun;
      } else {
        std::size_t run = 0;
        while (group + run < groups.size() && groups[group + run] == lastGroup) ++run;
        if (run >= 3) {
          codes.prediction.write(bits, 256);
          bits.groups(static_cast<std::uint32_t>(run - 3), 4);
          groupRun = run - 1;
        } else {
          codes.prediction.write(bits, lastGroup = groups[group]);
        }
      }
      ++group;
    }
    if (predictions[i] == 3) {
      const auto count = static_cast<std::uint32_t>(image.endpoints.size());
      codes.endpointDelta.write(bits, (blocks[i].endpoint + count - endpoint) % count);
    }
    endpoint = blocks[i].endpoint;

    if (selectorRun > 0) {
      --selectorRun;
      continue;
    }
    std::size_t run = 0;
    while (i + run < blocks.size() && blocks[i + run].selector == history.front()) ++run;
    const std::size_t known = history.find(blocks[i].selector);
    if (run >= 3) {
      codes.selector.write(bits, selectorCount + image.historySize);
      codes.selectorRun.write(bits, static_cast<std::uint32_t>(std::min<std::size_t>(run - 3, 63)));
      if (run - 3 >= 63) bits.groups(static_cast<std::uint32_t>(run - 3), 7);
      selectorRun = run - 1;
    } else if (known < history.size() && random() % 8 != 0) {
      codes.selector.write(bits, selectorCount + static_cast<std::uint32_t>(known));
      history.use(known);
    } else {
      codes.selector.write(bits, blocks[i].selector);
      history.add(blocks[i].selector);
    }
  }
  return bits.bytes();
}

Bytes writeEndpoints(const BasisLzImage& image) {
  BasisBitWriter bits;
  const BasisCodeWriter color(32, image.skewed), intensity(8, image.skewed);
  for (int i = 0; i < 3; ++i) color.writeTable(bits);
  intensity.writeTable(bits);
  bits(image.gray ? 1 : 0, 1);
  EtcEndpoint last{{16, 16, 16}, 0};
  for (const EtcEndpoint& endpoint : image.endpoints) {
    intensity.write(bits, (endpoint.intensity - last.intensity) & 7);
    for (std::size_t c = 0; c < (image.gray ? 1u : 3u); ++c)
      color.write(bits, (endpoint.color[c] - last.color[c]) & 31);
    last = endpoint;
  }
  return bits.bytes();
}

Bytes writeSelectors(const BasisLzImage& image) {
  BasisBitWriter bits;
  bits(image.rawSelectors ? 4 : 0, 3);
  const BasisCodeWriter delta(256, image.skewed);
  if (!image.rawSelectors) delta.writeTable(bits);
  for (std::size_t i = 0; i < image.selectors.size(); ++i)
    for (std::uint32_t row = 0; row < 32; row += 8) {
      if (image.rawSelectors || i == 0)
        bits(image.selectors[i] >> row & 255, 8);
      else
        delta.write(bits, (image.selectors[i] ^ image.selectors[i - 1]) >> row & 255);
    }
  return bits.bytes();
}

void append(Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); }

}  // namespace

BasisBitWriter& BasisBitWriter::operator()(std::uint32_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i, ++at_) {
    if (at_ % 8 == 0) bytes_.push_back(std::byte{0});
    bytes_.back() |= static_cast<std::byte>((value >> i & 1) << (at_ % 8));
  }
  return *this;
}

BasisBitWriter& BasisBitWriter::groups(std::uint32_t value, std::uint32_t count) {
  for (; value >> count > 0; value >>= count) (*this)((value & ((1u << count) - 1)) | 1u << count, count + 1);
  return (*this)(value, count + 1);
}

BasisCodeWriter::BasisCodeWriter(std::size_t symbols, bool skewed) {
  constexpr std::size_t kFrequent = 6;
  if (skewed && symbols > kFrequent + 1) {
    for (std::size_t i = 0; i < kFrequent; ++i) lengths_.push_back(static_cast<std::uint8_t>(i + 1));
    const std::vector<std::uint8_t> others = evenLengths(symbols - kFrequent, kFrequent);
    lengths_.insert(lengths_.end(), others.begin(), others.end());
  } else {
    lengths_ = evenLengths(symbols, symbols == 1 ? 1 : 0);
  }
  std::ranges::reverse(lengths_);
}

void BasisCodeWriter::writeTable(BasisBitWriter& bits) const {
  constexpr std::array<std::uint32_t, 21> kOrder{17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                 11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
  bits(static_cast<std::uint32_t>(lengths_.size()), 14)(21, 5);
  const std::vector<std::uint8_t> outer = evenLengths(21, 0);
  for (const std::uint32_t symbol : kOrder) bits(outer[symbol], 3);
  const BasisCodeWriter outerCode(outer);
  for (const LengthSymbol& symbol : symbolsOf(lengths_)) {
    outerCode.write(bits, symbol.symbol);
    bits(symbol.extra, symbol.extraBits);
  }
}

void BasisCodeWriter::write(BasisBitWriter& bits, std::uint32_t symbol) const {
  // The code is the number of codes before it, at its length: shorter ones, and those of smaller symbols.
  const std::uint32_t length = lengths_[symbol];
  std::uint32_t code = 0;
  for (std::size_t s = 0; s < lengths_.size(); ++s)
    if (lengths_[s] > 0 && (lengths_[s] < length || (lengths_[s] == length && s < symbol)))
      code += 1u << (length - lengths_[s]);
  for (std::uint32_t i = length; i > 0; --i) bits(code >> (i - 1) & 1, 1);
}

void BasisLzImage::fill(std::mt19937& random, std::size_t endpointCount, std::size_t selectorCount,
                        std::size_t sliceCount) {
  endpoints.resize(endpointCount);
  for (EtcEndpoint& endpoint : endpoints) {
    for (std::uint32_t& c : endpoint.color) c = gray && &c != endpoint.color.data() ? endpoint.color[0] : random() & 31;
    endpoint.intensity = random() & 7;
  }
  selectors.resize(selectorCount);
  for (std::uint32_t& selector : selectors) selector = static_cast<std::uint32_t>(random());
  const std::size_t columns = (width + 3) / 4, rows = (height + 3) / 4;
  slices.assign(sliceCount, std::vector<EtcBlock>(columns * rows));
  for (std::vector<EtcBlock>& slice : slices)
    for (std::size_t i = 0, same = 0; i < slice.size(); ++i) {
      if (same > 0 && i > 0) {
        --same;
        slice[i] = slice[i - 1];
        continue;
      }
      same = random() % 16 == 0 ? random() % 200 : 0;
      slice[i].endpoint = i >= columns && random() % 2 == 0 ? slice[i - columns].endpoint
                                                            : static_cast<std::uint32_t>(random() % endpointCount);
      slice[i].selector = static_cast<std::uint32_t>(
          random() % (random() % 2 ? std::min<std::size_t>(9, selectorCount) : selectorCount));
    }
}

std::uint8_t BasisLzImage::value(std::size_t slice, std::uint32_t x, std::uint32_t y, std::size_t c) const {
  constexpr int kSteps[8][4] = {{-8, -2, 2, 8},     {-17, -5, 5, 17},   {-29, -9, 9, 29},     {-42, -13, 13, 42},
                                {-60, -18, 18, 60}, {-80, -24, 24, 80}, {-106, -33, 33, 106}, {-183, -47, 47, 183}};
  const EtcBlock& block = slices[slice][std::size_t{y / 4} * ((width + 3) / 4) + x / 4];
  const EtcEndpoint& endpoint = endpoints[block.endpoint];
  const std::uint32_t texel = selectors[block.selector] >> (8 * (y % 4) + 2 * (x % 4)) & 3;
  const int base = static_cast<int>(endpoint.color[c] * 8 + endpoint.color[c] / 4);
  return static_cast<std::uint8_t>(std::clamp(base + kSteps[endpoint.intensity][texel], 0, 255));
}

Ktx2 BasisLzImage::file(std::mt19937& random, std::initializer_list<int> channels) const {
  const auto size = [](const auto& v) { return static_cast<std::uint32_t>(v.size()); };
  const Codes codes{BasisCodeWriter(257, skewed), BasisCodeWriter(endpoints.size(), skewed),
                    BasisCodeWriter(selectors.size() + historySize + 1, skewed), BasisCodeWriter(64, skewed)};
  BasisBitWriter tables;
  for (const BasisCodeWriter* code : {&codes.prediction, &codes.endpointDelta, &codes.selector, &codes.selectorRun})
    code->writeTable(tables);
  tables(historySize, 13);
  const Bytes endpointBytes = writeEndpoints(*this), selectorBytes = writeSelectors(*this);

  Ktx2 result{.format = 0, .width = width, .height = height, .scheme = 1};
  result.describe(163, channels);
  std::array<std::uint32_t, 10> header{size(endpoints) | size(selectors) << 16,
                                       size(endpointBytes),
                                       size(selectorBytes),
                                       size(tables.bytes()),
                                       0,
                                       flags};
  for (std::size_t s = 0; s < slices.size(); ++s) {
    const Bytes slice = writeSlice(*this, slices[s], codes, random);
    header[6 + 2 * s] = size(result.level), header[7 + 2 * s] = size(slice);
    append(result.level, slice);
  }
  result.globalData.resize(sizeof header);
  std::memcpy(result.globalData.data(), header.data(), sizeof header);
  append(result.globalData, endpointBytes);
  append(result.globalData, selectorBytes);
  append(result.globalData, tables.bytes());
  return result;
}

}  // namespace quintet::io::test
