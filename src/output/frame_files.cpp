// SPDX-License-Identifier: Apache-2.0
#include "output/frame_files.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "io/codec.h"
#include "output/file_names.h"

namespace quintet::output {
namespace {

bool hasHash(const std::filesystem::path& file, const std::string& hash) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return false;
  try {
    const io::Metadata metadata = io::readMetadata(readFile(file), file.string());
    return std::ranges::find(metadata, std::pair<std::string, std::string>(kFrameHashKey, hash)) != metadata.end();
  } catch (const Error&) {  // no image, or a broken one, is written again
    return false;
  }
}

}  // namespace

std::vector<std::filesystem::path> frameFiles(const OutputPlan& plan, std::uint64_t frame) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : plan.outputNames)
    files.push_back(fileName(plan.request.file, plan.request.allOutputs ? name : "", frame));
  return files;
}

std::string frameHash(const OutputPlan& plan, const job::Provenance& frame) {
  Hasher hasher;
  const auto add = [&](const std::string& text) {
    hasher.add(static_cast<std::uint64_t>(text.size()));
    hasher.add(std::string_view(text));
  };
  for (const auto& [name, value] : job::toFacts(frame, job::ProvenanceField::Role::identity)) {
    add(name);
    add(value);
  }
  const job::OutputNotes notes = plan.notes();
  const ExrFormat exr = plan.request.exr.value_or(ExrFormat());
  add(frame.limits);
  add(fmt::format("{} {} {} {}", notes.exposure, notes.toneMap, notes.allOutputs, notes.layers));
  add(fmt::format("{} {} {} {} {} {}", static_cast<int>(plan.kind), plan.request.pngBits.value_or(8),
                  static_cast<int>(exr.colors), static_cast<int>(exr.options.compression),
                  exr.options.level.value_or(-1), exr.options.tileSize));
  for (const std::string& name : plan.outputNames) add(name);
  return hasher.finish().hex();
}

bool isFrameWritten(const OutputPlan& plan, const job::Provenance& frame) {
  if (plan.kind == FileKind::hdr || plan.kind == FileKind::film || !frame.frame) return false;
  const std::string hash = frameHash(plan, frame);
  return std::ranges::all_of(frameFiles(plan, *frame.frame),
                             [&](const std::filesystem::path& file) { return hasHash(file, hash); });
}

}  // namespace quintet::output
