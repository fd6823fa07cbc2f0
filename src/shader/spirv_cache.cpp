// SPDX-License-Identifier: Apache-2.0
#include "shader/spirv_cache.h"

#include <algorithm>
#include <cstring>
#include <system_error>

#include "base/error.h"
#include "base/file.h"

namespace quintet::shader {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMagic = 0x3130'5650'5351'0a51;  // "Q\nQSPV01"
constexpr std::uint32_t kSpirvMagic = 0x0723'0203;
constexpr std::uint32_t kMaxDiagnostics = 1000;
constexpr unsigned kStoresBetweenPruning = 256;

class Writer {
 public:
  void bytes(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    data_.insert(data_.end(), first, first + size);
  }
  template <class T>
  void value(T v) {
    bytes(&v, sizeof v);
  }
  void text(std::string_view t) {
    value(static_cast<std::uint32_t>(t.size()));
    bytes(t.data(), t.size());
  }
  const std::vector<std::byte>& data() const { return data_; }

 private:
  std::vector<std::byte> data_;
};

// Each read returns false if the data is too short.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> data) : data_(data) {}
  bool bytes(void* to, std::size_t size) {
    if (size > data_.size()) return false;
    if (size > 0) std::memcpy(to, data_.data(), size);
    data_ = data_.subspan(size);
    return true;
  }
  template <class T>
  bool value(T& v) {
    return bytes(&v, sizeof v);
  }
  bool text(std::string& t) {
    std::uint32_t size = 0;
    if (!value(size) || size > data_.size()) return false;
    t.resize(size);
    return bytes(t.data(), size);
  }
  std::span<const std::byte> rest() const { return data_; }

 private:
  std::span<const std::byte> data_;
};

Hash checksum(std::span<const std::byte> payload) { return Hasher().add(payload).finish(); }

std::vector<std::byte> payloadOf(const SpirvEntry& entry) {
  Writer out;
  out.value(static_cast<std::uint32_t>(entry.spirv.size()));
  out.bytes(entry.spirv.data(), entry.spirv.size() * sizeof(std::uint32_t));
  out.value(static_cast<std::uint32_t>(entry.diagnostics.size()));
  for (const Diagnostic& d : entry.diagnostics) {
    out.value(static_cast<std::uint32_t>(d.severity));
    out.value(static_cast<std::int32_t>(d.line));
    out.value(static_cast<std::int32_t>(d.column));
    for (const std::string* text : {&d.file, &d.id, &d.text}) out.text(*text);
  }
  return out.data();
}

bool readDiagnostic(Reader& in, Diagnostic& d) {
  std::uint32_t severity = 0;
  if (!in.value(severity) || severity > static_cast<std::uint32_t>(Severity::error)) return false;
  d.severity = static_cast<Severity>(severity);
  return in.value(d.line) && in.value(d.column) && in.text(d.file) && in.text(d.id) && in.text(d.text);
}

std::optional<SpirvEntry> parsePayload(std::span<const std::byte> payload) {
  Reader in(payload);
  SpirvEntry entry;
  std::uint32_t count = 0;
  if (!in.value(count) || count == 0 || count > in.rest().size() / sizeof(std::uint32_t)) return {};
  entry.spirv.resize(count);
  if (!in.bytes(entry.spirv.data(), count * sizeof(std::uint32_t)) || entry.spirv[0] != kSpirvMagic) return {};
  if (!in.value(count) || count > kMaxDiagnostics) return {};
  entry.diagnostics.resize(count);
  for (Diagnostic& d : entry.diagnostics)
    if (!readDiagnostic(in, d)) return {};
  if (!in.rest().empty()) return {};
  return entry;
}

std::uintmax_t sizeOf(const SpirvEntry& entry) {
  std::uintmax_t bytes = entry.spirv.size() * sizeof(std::uint32_t);
  for (const Diagnostic& d : entry.diagnostics) bytes += sizeof d + d.file.size() + d.id.size() + d.text.size();
  return bytes;
}

}  // namespace

std::optional<SpirvEntry> SpirvCache::load(const Hash& key) const {
  return folder_.empty() ? loadFromMemory(key) : loadFile(key);
}

void SpirvCache::store(const Hash& key, const SpirvEntry& entry) const {
  if (entry.spirv.empty() || entry.diagnostics.size() > kMaxDiagnostics) return;
  if (folder_.empty())
    storeInMemory(key, entry);
  else
    storeFile(key, entry);
}

std::optional<SpirvEntry> SpirvCache::loadFromMemory(const Hash& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = byKey_.find(key);
  if (found == byKey_.end()) return {};
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->second;
}

void SpirvCache::storeInMemory(const Hash& key, const SpirvEntry& entry) const {
  const std::lock_guard lock(mutex_);
  if (byKey_.contains(key)) return;  // another thread compiled the same source
  entries_.emplace_front(key, entry);
  byKey_[key] = entries_.begin();
  bytes_ += sizeOf(entry);
  while (bytes_ > kMaxBytesInMemory) {
    bytes_ -= sizeOf(entries_.back().second);
    byKey_.erase(entries_.back().first);
    entries_.pop_back();
  }
}

std::optional<SpirvEntry> SpirvCache::loadFile(const Hash& key) const {
  const fs::path file = fileOf(key);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  std::vector<std::byte> data;
  try {
    data = readFile(file);
  } catch (const Error&) {
    return {};
  }
  Reader in(data);
  std::uint64_t magic = 0;
  Hash storedKey, storedChecksum;
  if (!in.value(magic) || magic != kMagic || !in.value(storedKey) || storedKey != key) return {};
  if (!in.value(storedChecksum) || storedChecksum != checksum(in.rest())) return {};
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);  // time of the last use, for prune()
  return parsePayload(in.rest());
}

void SpirvCache::storeFile(const Hash& key, const SpirvEntry& entry) const {
  const std::vector<std::byte> payload = payloadOf(entry);
  Writer out;
  out.value(kMagic);
  out.value(key);
  out.value(checksum(payload));
  out.bytes(payload.data(), payload.size());
  try {
    std::error_code ignored;
    fs::create_directories(folder_, ignored);
    writeFile(fileOf(key), out.data());
  } catch (const std::exception&) {
    return;  // e.g. no permission or disk full; the next run compiles again
  }
  if (stores_++ % kStoresBetweenPruning == 0) prune();
}

void SpirvCache::prune(std::uintmax_t maxBytes) const {
  struct Entry {
    fs::file_time_type used;
    std::uintmax_t size;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uintmax_t total = 0;
  std::error_code failed;
  for (fs::directory_iterator at(folder_, failed), end; !failed && at != end; at.increment(failed)) {
    if (at->path().extension() != ".qspv") continue;
    std::error_code gone;
    const Entry entry{at->last_write_time(gone), at->file_size(gone), at->path()};
    if (gone) continue;
    total += entry.size;
    entries.push_back(entry);
  }
  if (total <= maxBytes) return;
  std::ranges::sort(entries, {}, &Entry::used);
  for (const Entry& entry : entries) {
    if (total <= maxBytes) break;
    fs::remove(entry.path, failed);
    total -= entry.size;
  }
}

}  // namespace quintet::shader
