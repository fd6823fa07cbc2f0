// SPDX-License-Identifier: Apache-2.0
// The events of the lab as lines of JSON, besides those of sessions (job/interactive/event_json.h).
// docs/design/lab-protocol.md lists them.
#ifndef QUINTET_LAB_SESSION_EVENTS_H
#define QUINTET_LAB_SESSION_EVENTS_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "job/interactive/event.h"
#include "job/interactive/session.h"

namespace quintet::lab {

struct Statistics {
  std::uint64_t samples = 0;  // per pixel, or frames
  bool frames = false;
  double seconds = 0;           // in which they were rendered
  double raysPerSecond = 0;     // 0 if unknown
  std::optional<double> error;  // relative, upper bound
};

// Programs with a camera of their own ignore navigation.
bool usesCamera(const program::Program& program);

// openingJson(): what follows belongs to the `open` of this number. `device`: its name. At most kMaxListedNames names of each kind.
inline constexpr std::size_t kMaxListedNames = 1000;
std::string openingJson(std::uint32_t number);
std::string openedJson(const job::interactive::Session& session, const std::string& program, const std::string& scene,
                       const std::string& device);
// `still`: all frames of a program that counts them are equal.
std::string stateJson(const job::interactive::Session& session, const std::string& program, bool paused, bool still);
std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics, bool outdated);
std::string statisticsJson(const Statistics& statistics);
std::string imageJson(const job::interactive::ImageUpdated& image, std::uint32_t number);
std::string valueJson(uvec2 pixel, const std::vector<float>& value);
// A file that the page can download in parts (file_message.h). `type`: media type.
std::string fileJson(std::uint32_t number, const std::string& name, const std::string& type, std::uint64_t bytes);
std::string progressJson(std::uint64_t done, std::uint64_t total);
std::string graphJson(const std::string& graph);  // check::pipelineJson()
std::string workerJson(const std::string& state, const std::string& message, unsigned restarts);

// {"event": event, "message": message}; `key`: the name of the second member.
std::string messageJson(const std::string& event, const std::string& message, const std::string& key = "message");

// The event with a member "id", whose value is JSON; unchanged if `id` is empty.
std::string withId(const std::string& event, const std::string& id);

}  // namespace quintet::lab
#endif
