// SPDX-License-Identifier: Apache-2.0
// Whether the parts of a plan are finished and belong to it, and the list of frames by which parts of animations prove
// it. Nothing is rendered, and films are not loaded.
#ifndef QUINTET_FARM_PART_CHECK_H
#define QUINTET_FARM_PART_CHECK_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "farm/plan.h"

namespace quintet::farm {

enum class PartState {
  done,
  missing,
  incomplete,    // ended early: only some of its samples or frames exist
  damaged,       // truncated, or a checksum does not match
  foreign,       // belongs to a different plan, or is a different part of this one
  wrongVersion,  // rendered by a different version of Quintet
};
std::string_view partStateName(PartState state);  // "done", "wrong version"
inline constexpr std::size_t kPartStates = 6;

struct PartCheck {
  PartState state = PartState::missing;
  std::string problem;  // one line with the file; empty if done, and if missing without a recorded failure
};

enum class CheckDepth {
  header,   // header and length of films, names and sizes of images
  content,  // reads everything and compares the checksums
};

PartCheck checkPart(const Plan& plan, std::size_t part, CheckDepth depth);

// All parts, on all cores.
std::vector<PartCheck> checkParts(const Plan& plan, CheckDepth depth);

// Films and lists of frames in the folder of the parts that are not the file of any part.
std::vector<std::filesystem::path> unexpectedFiles(const Plan& plan);

// Throws Error that names the unusable parts (the first ones, and the number of the others) unless all are done and
// nothing is unexpected. `allowMissing`: missing and incomplete ones are no problem.
void requireUsable(const Plan& plan, const std::vector<PartCheck>& checks,
                   const std::vector<std::filesystem::path>& unexpected, bool allowMissing = false);

// The images of a frame, all of which a part has written.
struct WrittenFrame {
  std::uint64_t frame = 0;
  std::vector<std::filesystem::path> files;  // absolute
};
// Writes the list of the frames of a part with the size and the hash of each file. Throws FileError.
void writeFrameList(const Plan& plan, std::size_t part, const std::vector<WrittenFrame>& frames);

}  // namespace quintet::farm
#endif
