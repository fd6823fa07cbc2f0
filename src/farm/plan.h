// SPDX-License-Identifier: Apache-2.0
// The plan of a render on many machines: one file (plan.json) that says what is rendered, by which version of Quintet, and
// how it is split into parts. Its id is the hash of all of this, and each finished part names the id. A folder holds the
// plan and everything that belongs to it:
//
//   plan.json           this file
//   parts/000/000007.*  part 7: its film or its list of frames, its checkpoint, its last failure
//   logs/               output of the tasks
//   *.sbatch, *.sh      scripts (scripts.h)
#ifndef QUINTET_FARM_PLAN_H
#define QUINTET_FARM_PLAN_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "render/film/film_state.h"

namespace quintet::farm {

inline constexpr const char* kPlanFile = "plan.json";
inline constexpr std::size_t kMaxParts = 1'000'000;

// Batches of an image, or frames of an animation; both ends included.
struct Part {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  bool operator==(const Part&) const = default;
};

enum class PartKind { batches, frames };
const char* partKindName(PartKind kind);  // "batches", "frames"

struct Plan {
  // Together they make the id.
  std::string version;                  // of Quintet
  std::string libraryHash;              // of its shader library
  std::filesystem::path scene;          // absolute
  std::string sceneHash;                // of its content, as in films
  std::string environmentHash;          // the same
  std::string programHash;              // of the program's files, without what they include from outside
  std::vector<std::string> options;     // of the render, as on a command line, without scene and output
  std::filesystem::path workingFolder;  // absolute; relative names in `options` refer to it
  std::filesystem::path image;          // absolute: the image, or the name of the frames with their number as ####
  PartKind kind = PartKind::batches;
  std::uint64_t samples = 0;  // of the whole image per pixel; 0 for frames
  std::vector<Part> parts;

  std::filesystem::path folder;  // of the plan; not stored, because it can be moved
};

// A machine has a different version of Quintet than the plan.
class VersionError : public Error {
 public:
  using Error::Error;
};

// Splits [first, last] into `count` parts whose sizes differ by at most one. Throws UsageError for more parts than
// elements, or more than kMaxParts. `noun`: of an element, "batch".
std::vector<Part> splitWork(std::uint64_t first, std::uint64_t last, std::uint64_t count, std::string_view noun,
                            std::string_view plural);

std::string planId(const Plan& plan);  // 32 hex digits

std::string planText(const Plan& plan);  // JSON
// `path`: the file, or the folder that holds it. Throws FileError for a file that is missing, no plan, or was changed
// after it was made.
Plan readPlan(const std::filesystem::path& path);

// Throws VersionError unless this program is the version that made the plan. `machine`: its name, for the message.
void requireSameVersion(const Plan& plan, const std::string& machine);
// Throws FileError if the scene, the environment or the program were changed since the plan was made.
void requireSameContent(const Plan& plan, const std::string& sceneHash, const std::string& environmentHash,
                        const std::string& programHash);

// "part 3 (batches 12–15)"
std::string partName(const Plan& plan, std::size_t part);
// Of a part of an image.
render::SampleRange samplesOf(const Plan& plan, std::size_t part);

// Files of a part. The first is its result: a film, or the list of its frames.
std::filesystem::path partFile(const Plan& plan, std::size_t part);
std::filesystem::path checkpointFile(const Plan& plan, std::size_t part);
std::filesystem::path failureFile(const Plan& plan, std::size_t part);
// Folders that the plan requires.
std::vector<std::filesystem::path> planFolders(const Plan& plan);

}  // namespace quintet::farm
#endif
