// SPDX-License-Identifier: Apache-2.0
// The HTTP routes below /api/ (docs/design/lab-protocol.md, "HTTP routes"): files of the project, programs, lessons and
// documentation. Nothing here uses a device.
#ifndef QUINTET_LAB_API_H
#define QUINTET_LAB_API_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/math.h"
#include "lab/http_message.h"
#include "lab/project_folder.h"
#include "lab/request_target.h"

namespace quintet::lab {

inline constexpr std::uint64_t kMaxUploadBytes = std::uint64_t{256} << 20;
inline constexpr std::uint64_t kMaxImportBytes = std::uint64_t{16} << 20;
inline constexpr int kMaxFormatters = 4;                                // that run at a time
inline constexpr std::uint64_t kMaxBodyBytes = std::uint64_t{1} << 20;  // of all other requests

// What a session shows if the page asks for nothing else, and what the page should know.
struct LabDefaults {
  std::string program;  // as programs are named in the protocol
  std::string scene;    // file of the project; empty means that of the program
  uvec2 size{640, 360};
  std::uint32_t samples = 64;
  double timeout = 30;  // seconds that a launch may take
  std::size_t maxSessions = 16;
};

// The largest body that a request may have, bytes.
std::uint64_t maxBodyBytes(const std::string& method, const std::string& target);

// An answer that a process is still making.
class PendingAnswer {
 public:
  virtual ~PendingAnswer() = default;
  // Nothing before the process has ended.
  virtual std::optional<HttpResponse> poll() = 0;
};

class Api {
 public:
  // Both must outlive the object.
  Api(const ProjectFolder& project, const LabDefaults& defaults) : project_(project), defaults_(defaults) {}

  // The answer to a request below /api/, which is an error for all that fails; or one that takes long.
  using Answer = std::variant<HttpResponse, std::unique_ptr<PendingAnswer>>;
  Answer handle(const HttpRequest& request) const;

 private:
  Answer route(const HttpRequest& request, const RequestTarget& target) const;
  HttpResponse file(const HttpRequest& request, const std::string& name) const;
  HttpResponse putFile(const HttpRequest& request, const std::string& name) const;
  HttpResponse describeProject() const;
  HttpResponse files() const;
  HttpResponse programs() const;
  HttpResponse program(const std::string& name) const;
  HttpResponse copyProgram(const std::string& body) const;
  HttpResponse lessons() const;
  HttpResponse documentation(const std::string& name) const;
  Answer format(const std::string& text) const;
  HttpResponse exportProgram(const RequestTarget& target) const;
  HttpResponse importProgram(const HttpRequest& request, const RequestTarget& target) const;

  const ProjectFolder& project_;
  const LabDefaults& defaults_;
  const std::shared_ptr<int> formatters_ = std::make_shared<int>(0);  // that run now
};

}  // namespace quintet::lab
#endif
