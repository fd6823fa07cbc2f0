// SPDX-License-Identifier: Apache-2.0
// Film files: checkpoints and parts of renders. The checksum is corrected, and so are the sizes of the header and the
// payload: the header ends at its last brace.
#include <algorithm>
#include <cstring>
#include <vector>

#include "base/hash.h"
#include "job/film_store.h"
#include "target.h"

namespace quintet::fuzz {
namespace {

constexpr std::size_t kPrefixBytes = 24, kHashBytes = 16;

std::vector<std::byte> withChecksum(Input input) {
  std::vector<std::byte> bytes(input.begin(), input.end());
  if (bytes.size() < kPrefixBytes + kHashBytes) return bytes;
  const auto begin = bytes.begin() + kPrefixBytes, end = bytes.end() - kHashBytes;
  // "}\n" ends the header, and no line in it.
  constexpr std::array kEnd{std::byte{'\n'}, std::byte{'}'}, std::byte{'\n'}};
  const auto last = std::search(begin, end, kEnd.begin(), kEnd.end());
  const auto header = static_cast<std::uint32_t>((last == end ? last : last + kEnd.size()) - begin);
  const std::uint64_t payload = static_cast<std::uint64_t>(end - begin) - header;
  std::memcpy(bytes.data() + 12, &header, sizeof header);
  std::memcpy(bytes.data() + 16, &payload, sizeof payload);
  const Hash hash = Hasher().add(std::span(bytes).first(bytes.size() - kHashBytes)).finish();
  std::memcpy(bytes.data() + bytes.size() - kHashBytes, &hash.high, sizeof hash.high);
  std::memcpy(bytes.data() + bytes.size() - kHashBytes / 2, &hash.low, sizeof hash.low);
  return bytes;
}

}  // namespace

void readInput(Input input) {
  acceptErrors([&] {
    MemoryBudget budget("input.qfilm", kMaxMemory);
    const job::StoredFilm stored = job::decodeStoredFilm(withChecksum(input), "input.qfilm", budget);
    (void)job::samplesText(stored.file.film);
    const std::vector<std::byte> written = render::encodeFilm(stored.file);
    if (render::encodeFilm(render::decodeFilm(written, "written.qfilm")) != written)
      reportFinding("the film changes when it is written and read");
  });
}

}  // namespace quintet::fuzz
