// SPDX-License-Identifier: Apache-2.0
#include "render/film/film_reader.h"

#include <sys/stat.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <future>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/memory_budget.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "render/film/film_format.h"
#include "render/film/fixed_sum.h"

namespace quintet::render {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 20;
constexpr std::size_t kBlocksPerThread = 2;  // in memory, and as many that are being read

// The content of a file from its start, hashed as it is read.
class FilmInput {
 public:
  explicit FilmInput(const std::filesystem::path& path) : path_(path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode)) {
      file_ = std::fopen(path.c_str(), "rbe");
      if (!file_) fail(errno);
      bytes_ = static_cast<std::uint64_t>(info.st_size);
      std::setvbuf(file_, nullptr, _IONBF, 0);  // reads are exact, so that a header costs no more than its bytes
    } else {  // a pipe has no length; missing files and folders get the error of readFile()
      read_ = readFile(path);
      memory_ = read_;
      bytes_ = memory_.size();
    }
    start();
  }
  // Of `bytes`, which must outlive it; `path` is used in messages only.
  FilmInput(std::span<const std::byte> bytes, const std::filesystem::path& path)
      : path_(path), memory_(bytes), bytes_(bytes.size()) {
    start();
  }
  ~FilmInput() {
    if (file_) std::fclose(file_);
  }
  FilmInput(const FilmInput&) = delete;
  FilmInput& operator=(const FilmInput&) = delete;

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t position() const { return position_; }
  // Reads exactly this many bytes, which the file has; `hashed`: unless they are the checksum.
  void read(std::span<std::byte> out, bool hashed = true) {
    if (file_) {
      errno = 0;
      if (std::fread(out.data(), 1, out.size(), file_) != out.size()) {
        if (errno != 0) fail(errno);
        throw FileError(path_, "became shorter while it was read");
      }
    } else {
      std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(position_), out.size(), out.begin());
    }
    position_ += out.size();
    if (hashed) hash_.append(out);
  }
  // Hashes up to the checksum. Returns whether that agrees.
  bool checksumAgrees() {
    std::vector<std::byte> buffer(kReadBytes);
    while (position_ + kFilmHashBytes < bytes_)
      read(std::span(buffer).first(std::min<std::size_t>(kReadBytes, bytes_ - kFilmHashBytes - position_)));
    const auto hash = filmHash(hash_.finish());
    std::array<std::byte, kFilmHashBytes> stored{};
    read(stored, false);
    return std::memcmp(hash.data(), stored.data(), kFilmHashBytes) == 0;
  }

 private:
  void start() { hash_.add(bytes_ - std::min<std::uint64_t>(bytes_, kFilmHashBytes)); }  // all but the checksum itself
  [[noreturn]] void fail(int code) const {
    throw FileError(path_, "cannot be read: " + std::generic_category().message(code));
  }

  const std::filesystem::path& path_;
  std::FILE* file_ = nullptr;
  std::vector<std::byte> read_;
  std::span<const std::byte> memory_;  // the content, unless it is read from file_
  std::uint64_t bytes_ = 0, position_ = 0;
  Hasher hash_;
};

// What happens to an array of the file.
enum class ArrayUse { store, addSums, addCoverage, addStatistics, skip };

struct FilmArray {
  std::span<std::byte> target;  // its bytes in the film; empty data for `skip`
  std::size_t bytes = 0, elementBytes = 1;
  ArrayUse use = ArrayUse::skip;
};

struct FilmBlock {
  std::vector<std::byte> compressed;
  std::span<std::byte> target;
  std::size_t bytes = 0, elementBytes = 1;
  ArrayUse use = ArrayUse::skip;
};

using PixelCoverage = std::array<shared::CoverageSlot, shared::kCoverageSlots>;

// Adds the elements of `from` to those of `into`.
template <class T, class Add>
void addElements(std::span<std::byte> into, std::span<const std::byte> from, const Add& add) {
  auto* const to = reinterpret_cast<T*>(into.data());
  const auto* const more = reinterpret_cast<const T*>(from.data());
  for (std::size_t i = 0; i < into.size() / sizeof(T); ++i) add(to[i], more[i]);
}

// Returns false for an invalid block.
bool useBlock(const FilmBlock& block) {
  if (block.use == ArrayUse::skip) return true;
  if (block.use == ArrayUse::store) return decodeFilmBlock(block.compressed, block.target, block.elementBytes);
  std::vector<std::byte> decoded(block.bytes);
  if (!decodeFilmBlock(block.compressed, decoded, block.elementBytes)) return false;
  switch (block.use) {
    case ArrayUse::addSums:
      addElements<shared::FixedSum>(block.target, decoded, [](auto& to, const auto& more) { to = addFixed(to, more); });
      break;
    case ArrayUse::addStatistics:
      addElements<uvec2>(block.target, decoded, [](auto& to, const auto& more) { to += more; });
      break;
    default:
      addElements<PixelCoverage>(block.target, decoded,
                                 [](auto& to, const auto& more) { mergeCoverage(to.data(), more.data()); });
  }
  return true;
}

}  // namespace

struct FilmReader::Impl {
  explicit Impl(const std::filesystem::path& file) : path(file), input(path) { readHeader(); }
  Impl(std::span<const std::byte> bytes, const std::filesystem::path& file) : path(file), input(bytes, path) {
    readHeader();
  }
  void readHeader() {
    std::vector<std::byte> start(std::min<std::uint64_t>(input.bytes(), kFilmPrefixBytes));
    input.read(start);
    prefix = checkedFilmPrefix(start, input.bytes(), path);
    std::vector<std::byte> text(prefix.headerBytes);
    input.read(text);
    explained([&] { header = parseFilmHeader(text, path); });
  }

  // Reports damage of the file instead of what follows from it. Afterwards nothing more can be read.
  template <class Read>
  void explained(const Read& read) {
    try {
      read();
    } catch (const FileError&) {
      requireChecksum();
      throw;
    }
  }
  void requireChecksum() {
    if (!input.checksumAgrees()) throw FileError(path, "is damaged: its checksum does not match its content");
  }
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(path, "payload", problem); }

  // ---- Arrays ----

  std::uint64_t payloadLeft() const { return input.bytes() - kFilmHashBytes - input.position(); }

  void readArrays(const std::vector<FilmArray>& arrays) {
    struct Source {
      const FilmArray* array = nullptr;
      std::size_t offset = 0;
    };
    std::vector<Source> sources;
    for (const FilmArray& array : arrays)
      for (std::size_t at = 0; at < array.bytes; at += filmBlockBytes(array.elementBytes))
        sources.push_back({&array, at});
    const std::size_t groupSize = kBlocksPerThread * hardwareThreads();
    const auto readGroup = [&](std::size_t first) {
      std::vector<FilmBlock> group;
      for (std::size_t i = first; i < std::min(first + groupSize, sources.size()); ++i)
        group.push_back(readBlock(*sources[i].array, sources[i].offset));
      return group;
    };
    std::vector<FilmBlock> group = readGroup(0);
    for (std::size_t next = groupSize; !group.empty(); next += groupSize) {
      // Reads the next blocks while these are decoded.
      std::future<std::vector<FilmBlock>> reading;
      if (next < sources.size()) reading = std::async(std::launch::async, readGroup, next);
      std::atomic<bool> valid = true;
      std::exception_ptr failure;
      try {
        parallelFor(group.size(), [&](std::size_t i) {
          if (!useBlock(group[i])) valid = false;
        });
      } catch (...) {
        failure = std::current_exception();
      }
      group = reading.valid() ? reading.get() : std::vector<FilmBlock>{};
      if (failure) std::rethrow_exception(failure);
      if (!valid) failBlocks();
    }
    if (payloadLeft() != 0) fail(counted(payloadLeft(), "excess byte"));
  }
  [[noreturn]] void failBlocks() const { fail("the blocks do not match the header"); }

  FilmBlock readBlock(const FilmArray& array, std::size_t offset) {
    FilmBlock block;
    block.bytes = std::min(filmBlockBytes(array.elementBytes), array.bytes - offset);
    block.elementBytes = array.elementBytes;
    block.use = array.use;
    if (array.use != ArrayUse::skip) block.target = array.target.subspan(offset, block.bytes);
    std::uint32_t length = 0;
    if (payloadLeft() < sizeof length) failBlocks();
    input.read(std::as_writable_bytes(std::span(&length, 1)));
    if (payloadLeft() < length || length > largestFilmBlock(block.bytes)) failBlocks();
    block.compressed.resize(length);
    input.read(block.compressed);
    return block;
  }

  // An array of `count` elements, `group` per pixel, that is stored in `values`, or added to them.
  template <class T>
  FilmArray arrayOf(std::vector<T>& values, std::size_t count, ArrayUse use, std::size_t group = 1) const {
    return {std::as_writable_bytes(std::span(values)), count * sizeof(T), sizeof(T) * group, use};
  }

  FilmFile read(MemoryBudget& budget) {
    FilmFile& file = header.file;
    FilmState& film = file.film;
    const std::size_t pixels = film.pixelCount();
    std::uint64_t left = payloadLeft();
    std::vector<FilmArray> arrays;
    const auto store = [&](auto& values, std::size_t count, std::size_t group = 1) {
      const std::size_t bytes = count * sizeof values[0];
      if (!filmBlocksCanHold(bytes, left)) failBlocks();
      budget.take(bytes);
      values.resize(count);
      arrays.push_back(arrayOf(values, count, ArrayUse::store, group));
    };
    store(film.counts.cellBatches, header.cells);
    store(file.plan, header.planned);
    store(film.statistics, pixels);
    for (std::size_t p = 0; p < film.planes.size(); ++p)
      forArrays(film.planes[p], [&](const char* name, auto& values, std::size_t group) {
        if (header.stores(p, name)) store(values, pixels * group, group);
      });
    readArrays(arrays);
    if (!areConsistent(film.counts, file.plan)) fail("no render has these numbers of batches");
    return std::move(file);
  }

  void addTo(FilmState& film, bool takesValues) {
    const std::size_t pixels = film.pixelCount();
    std::vector<std::uint32_t> none;
    std::vector<FilmArray> arrays{arrayOf(none, header.cells, ArrayUse::skip),
                                  arrayOf(none, header.planned, ArrayUse::skip),
                                  arrayOf(film.statistics, pixels, ArrayUse::addStatistics)};
    for (std::size_t p = 0; p < film.planes.size(); ++p)
      forArrays(film.planes[p], [&](std::string_view name, auto& values, std::size_t group) {
        if (!header.stores(p, name)) return;
        const ArrayUse use = name == "coverage" ? ArrayUse::addCoverage
                             : name != "values" ? ArrayUse::addSums
                             : takesValues      ? ArrayUse::store
                                                : ArrayUse::skip;
        arrays.push_back(arrayOf(values, pixels * group, use, group));
      });
    readArrays(arrays);
  }

  const std::filesystem::path path;
  FilmInput input;
  FilmPrefix prefix;
  FilmHeader header;
};

FilmReader::FilmReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}
FilmReader::FilmReader(std::span<const std::byte> bytes, const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(bytes, file)) {}
FilmReader::~FilmReader() = default;

const FilmFile& FilmReader::header() const { return impl_->header.file; }
std::uint64_t FilmReader::fileBytes() const { return impl_->input.bytes(); }

bool FilmReader::hasArraysOf(const FilmState& film) const {
  const FilmState& ours = impl_->header.file.film;
  if (ours.region != film.region || ours.planes.size() != film.planes.size()) return false;
  for (std::size_t p = 0; p < film.planes.size(); ++p) {
    const FilmPlane& plane = film.planes[p];
    bool same = plane.name == ours.planes[p].name && plane.pixel == ours.planes[p].pixel;
    forArrays(plane, [&](const char* name, const auto& values, std::size_t) {
      same = same && values.empty() != impl_->header.stores(p, name);
    });
    if (!same) return false;
  }
  return true;
}

FilmFile FilmReader::read(std::size_t maxMemory) {
  MemoryBudget budget(impl_->path, maxMemory);
  return read(budget);
}

FilmFile FilmReader::read(MemoryBudget& budget) {
  FilmFile file;
  impl_->explained([&] { file = impl_->read(budget); });
  impl_->requireChecksum();
  return file;
}

void FilmReader::addTo(FilmState& film) {
  assert(hasArraysOf(film));
  const SampleCounts& ours = impl_->header.file.film.counts;
  if (!film.counts.cellBatches.empty() || impl_->header.cells > 0)
    throw UsageError("films of adaptive sampling, whose pixels have different numbers of samples, cannot be merged");
  SampleCounts counts = film.counts;
  for (const SampleRange& range : ours.ranges) counts.add(range);
  const bool takesValues = !ours.ranges.empty() && ours.ranges.front().begin == 0;
  impl_->explained([&] { impl_->addTo(film, takesValues); });
  impl_->requireChecksum();
  film.counts = std::move(counts);
}

void FilmReader::verify() { impl_->requireChecksum(); }

}  // namespace quintet::render
