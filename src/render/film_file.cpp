#include "render/film_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "render/film_blocks.h"
#include "render/film_header.h"

namespace quintet::render {
namespace {

using Bytes = std::span<const std::byte>;

// As in PNG: the first byte is no text, the end shows a transfer that has changed line ends.
constexpr std::array<unsigned char, 8> kMagic{0x89, 'Q', 'F', 'I', 'L', 'M', '\r', '\n'};
constexpr std::size_t kPrefixBytes = 24;
constexpr std::size_t kHashBytes = 16;

struct Prefix {
  std::uint32_t version = kFilmFileVersion;
  std::uint32_t headerBytes = 0;
  std::uint64_t payloadBytes = 0;
};
static_assert(sizeof(Prefix) == kPrefixBytes - sizeof kMagic);

std::array<std::uint64_t, 2> hashOf(Bytes bytes) {
  const Hash hash = Hasher().add(bytes).finish();
  return {hash.high, hash.low};
}

template <class T>
void appendArray(std::vector<std::byte>& out, const std::vector<T>& values, std::size_t group = 1) {
  appendBlocks(out, std::as_bytes(std::span(values)), sizeof(T) * group);
}

// Takes the arrays one after the other. The checksum was right, so whatever is wrong was written like that.
class Payload {
 public:
  Payload(const std::filesystem::path& file, Bytes bytes) : file_(file), bytes_(bytes) {}

  FilmFile fill(FilmHeader header) {
    FilmState& film = header.file.film;
    take(film.counts.cellBatches, header.cells);
    take(header.file.plan, header.planned);
    if (!arePossible(film.counts, header.file.plan)) fail("no rendering has such numbers of batches");
    take(film.statistics, film.pixelCount());
    for (std::size_t i = 0; i < film.planes.size(); ++i) {
      const std::vector<std::string>& there = header.arrays[i];
      forArrays(film.planes[i], [&](const char* name, auto& array, std::size_t group) {
        if (std::ranges::find(there, name) != there.end()) take(array, film.pixelCount() * group, group);
      });
    }
    if (!bytes_.empty()) fail(fmt::format("{} bytes belong to nothing", bytes_.size()));
    return std::move(header.file);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(file_, "payload", problem); }

  template <class T>
  void take(std::vector<T>& values, std::size_t count, std::size_t group = 1) {
    bool right = blocksMayHold(count * sizeof(T), bytes_.size());
    if (right) {
      values.resize(count);
      right = takeBlocks(bytes_, std::as_writable_bytes(std::span(values)), sizeof(T) * group);
    }
    if (!right) fail("its blocks do not belong to the header");
  }

  const std::filesystem::path& file_;
  Bytes bytes_;
};

// The file's parts, once its length and checksum are right.
struct Parts {
  Bytes header, payload;
};

Parts checkedParts(Bytes bytes, const std::filesystem::path& file) {
  if (bytes.empty()) throw FileError(file, "is empty");
  const std::size_t known = std::min(bytes.size(), kMagic.size());
  if (std::memcmp(bytes.data(), kMagic.data(), known) != 0) throw FileError(file, "is not a film file (.qfilm)");
  if (bytes.size() < kPrefixBytes) throw FileError(file, fmt::format("is truncated after {} bytes", bytes.size()));
  Prefix prefix;
  std::memcpy(&prefix, bytes.data() + kMagic.size(), sizeof prefix);
  if (prefix.version != kFilmFileVersion)
    throw FileError(file, fmt::format("has version {} of the film format; this Quintet reads version {}",
                                      prefix.version, kFilmFileVersion));
  const std::size_t rest = bytes.size() - kPrefixBytes;
  const std::uint64_t wanted = prefix.headerBytes + kHashBytes;
  if (rest < wanted || rest - wanted < prefix.payloadBytes)
    throw FileError(file, fmt::format("is truncated after {} bytes", bytes.size()));
  if (rest - wanted > prefix.payloadBytes)
    throw FileError(file, fmt::format("is damaged: it has {} bytes too many", rest - wanted - prefix.payloadBytes));
  const auto hash = hashOf(bytes.first(bytes.size() - kHashBytes));
  if (std::memcmp(hash.data(), bytes.last(kHashBytes).data(), kHashBytes) != 0)
    throw FileError(file, "is damaged: its checksum is not that of its content");
  return {bytes.subspan(kPrefixBytes, prefix.headerBytes),
          bytes.subspan(kPrefixBytes + prefix.headerBytes, prefix.payloadBytes)};
}

}  // namespace

const std::string* findFact(const FilmFacts& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &FilmFacts::value_type::first);
  return found == facts.end() ? nullptr : &found->second;
}

std::vector<FactDifference> differences(const FilmFacts& left, const FilmFacts& right) {
  std::vector<FactDifference> result;
  for (const auto& [name, value] : left) {
    const std::string* other = findFact(right, name);
    if (!other || *other != value) result.push_back({name, &value, other});
  }
  for (const auto& [name, value] : right)
    if (!findFact(left, name)) result.push_back({name, nullptr, &value});
  return result;
}

std::vector<std::byte> encodeFilm(const FilmFile& file) {
  const std::string header = filmHeaderText(file);
  std::vector<std::byte> out(kPrefixBytes + header.size());
  std::memcpy(out.data() + kPrefixBytes, header.data(), header.size());
  appendArray(out, file.film.counts.cellBatches);
  appendArray(out, file.plan);
  appendArray(out, file.film.statistics);
  for (const FilmPlane& plane : file.film.planes)
    forArrays(plane, [&](const char*, const auto& array, std::size_t group) { appendArray(out, array, group); });
  const Prefix prefix{kFilmFileVersion, static_cast<std::uint32_t>(header.size()),
                      out.size() - kPrefixBytes - header.size()};
  std::memcpy(out.data(), kMagic.data(), kMagic.size());
  std::memcpy(out.data() + kMagic.size(), &prefix, sizeof prefix);
  const auto hash = hashOf(out);
  const Bytes hashBytes = std::as_bytes(std::span(hash));
  out.insert(out.end(), hashBytes.begin(), hashBytes.end());
  return out;
}

bool isFilmFile(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

FilmFile decodeFilm(Bytes bytes, const std::filesystem::path& file) {
  const Parts parts = checkedParts(bytes, file);
  return Payload(file, parts.payload).fill(readFilmHeader(parts.header, file));
}

void writeFilm(const std::filesystem::path& path, const FilmFile& file) { writeFile(path, encodeFilm(file)); }
FilmFile readFilm(const std::filesystem::path& path) { return decodeFilm(readFile(path), path); }

}  // namespace quintet::render
