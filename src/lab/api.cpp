// SPDX-License-Identifier: Apache-2.0
#include "lab/api.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/diagnostic.h"
#include "base/embedded.h"
#include "base/error.h"
#include "base/json.h"
#include "check/catalog.h"
#include "check/diagnostic_text.h"
#include "lab/course.h"
#include "lab/lecture_limits.h"
#include "lab/page.h"
#include "lab/program_files.h"
#include "lab/source_format.h"
#include "lab/zip.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "shader/library.h"

namespace quintet::lab {

std::span<const EmbeddedFile> embeddedDocumentation();

namespace {

using OrderedJson = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::string_view kFiles = "/api/files/", kDocs = "/api/docs/";
constexpr std::string_view kText = "text/plain; charset=utf-8";

HttpResponse jsonResponse(const OrderedJson& json, unsigned status = 200) {
  return {.status = status, .body = json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace)};
}

// A method that the route does not have.
struct MethodError {
  std::string allowed;
};

void requireMethod(const HttpRequest& request, const std::string& method) {
  if (request.method != method) throw MethodError{method};
}

std::string required(const RequestTarget& target, const std::string& name) {
  const auto found = target.query.find(name);
  if (found == target.query.end() || found->second.empty())
    throw UsageError(fmt::format("'{}' is missing in the URL", name));
  return found->second;
}

// "\"0f3c\"" → "0f3c"; nothing for "*".
std::optional<std::string> hashOf(const std::string& header) {
  if (header == "*") return {};
  if (header.size() < 2 || header.front() != '"' || header.back() != '"')
    throw UsageError("If-Match must be * or a hash in quotes");
  return header.substr(1, header.size() - 2);
}

// Nothing if the request does not state which version it replaces.
std::optional<ProjectFolder::Condition> conditionOf(const HttpRequest& request) {
  if (request.header("if-none-match") == "*") return ProjectFolder::Condition{.mustNotExist = true};
  if (request.header("if-match").empty()) return {};
  return ProjectFolder::Condition{.hash = hashOf(request.header("if-match"))};
}

HttpResponse conditionMissing() {
  return errorResponse(428, "the request must state which version it replaces: If-Match or If-None-Match");
}

OrderedJson summaryJson(const ProgramSummary& summary) {
  return {{"name", summary.name}, {"title", summary.title}, {"description", summary.description}};
}

std::string_view documentText(std::string_view name) {
  const std::span<const EmbeddedFile> files = embeddedDocumentation();
  const auto found = std::ranges::find(files, name, &EmbeddedFile::path);
  return found == files.end() ? std::string_view() : found->data;
}

// A lecture or a zip file: names in the program's folder, and contents.
std::map<std::string, std::string> importedFiles(const std::string& body, const std::string& type,
                                                 const std::string& folder) {
  if (!type.starts_with("application/zip"))
    return {{fs::path(folder).filename().string() + std::string(program::kLectureExtension), body}};
  std::map<std::string, std::string> files = unzipFiles(body);
  // A folder that has everything is that of the program.
  const std::string first = files.empty() ? "" : files.begin()->first;
  const std::string top = first.substr(0, first.find('/') == first.npos ? 0 : first.find('/') + 1);
  if (!top.empty() && std::ranges::all_of(files, [&](const auto& file) { return file.first.starts_with(top); })) {
    std::map<std::string, std::string> inner;
    for (auto& [name, content] : files) inner[name.substr(top.size())] = std::move(content);
    files = std::move(inner);
  }
  if (files.empty()) throw UsageError("the zip file contains no files");
  return files;
}

class PendingFormat : public PendingAnswer {
 public:
  // `running`: number of such objects.
  PendingFormat(const fs::path& formatter, const std::string& text, std::shared_ptr<int> running)
      : name_(formatter.filename().string()), format_(formatter, text), running_(std::move(running)) {
    ++*running_;
  }
  ~PendingFormat() override { --*running_; }

  std::optional<HttpResponse> poll() override {
    try {
      const std::optional<std::string> text = format_.poll();
      if (!text) return {};
      return jsonResponse({{"text", *text}, {"formatter", name_}});
    } catch (const Error& error) {
      return errorResponse(500, error.what());
    }
  }

 private:
  const std::string name_;
  SourceFormat format_;
  const std::shared_ptr<int> running_;
};

}  // namespace

std::uint64_t maxBodyBytes(const std::string& method, const std::string& target) {
  if (method == "PUT" && target.starts_with(kFiles)) return kMaxUploadBytes;
  if (method == "POST" && target.starts_with("/api/import")) return kMaxImportBytes;
  return kMaxBodyBytes;
}

Api::Answer Api::handle(const HttpRequest& request) const {
  const std::optional<RequestTarget> target = parseTarget(request.target);
  if (!target) return errorResponse(400, "the URL is not valid");
  try {
    return route(request, *target);
  } catch (const MethodError& error) {
    HttpResponse response = errorResponse(405, fmt::format("the method {} is not supported here", request.method));
    response.headers.emplace_back("Allow", error.allowed);
    return response;
  } catch (const ConflictError& error) {
    return errorResponse(412, error.what(), {{"hash", OrderedJson(error.hash()).dump()}});
  } catch (const OverwriteError& error) {
    return errorResponse(409, error.what(), {{"files", OrderedJson(error.files()).dump()}});
  } catch (const UsageError& error) {
    return errorResponse(400, error.what());
  } catch (const FileError& error) {
    return errorResponse(error.problem() == "does not exist" ? 404 : 400, error.what());
  } catch (const nlohmann::json::exception&) {
    return errorResponse(400, "the body is not the JSON that the route requires");
  } catch (const std::exception& error) {
    return errorResponse(500, error.what());
  }
}

Api::Answer Api::route(const HttpRequest& request, const RequestTarget& target) const {
  const std::string& path = target.path;
  if (path.starts_with(kFiles)) return file(request, path.substr(kFiles.size()));
  if (path == "/api/programs" && request.method == "POST") return copyProgram(request.body);
  if (path == "/api/import") {
    requireMethod(request, "POST");
    return importProgram(request, target);
  }
  if (path == "/api/format") {
    requireMethod(request, "POST");
    return format(request.body);
  }
  if (request.method != "GET") throw MethodError{path == "/api/programs" ? "GET, POST" : "GET"};
  if (path.starts_with(kDocs)) return documentation(path.substr(kDocs.size()));
  if (path == "/api/project") return describeProject();
  if (path == "/api/files") return files();
  if (path == "/api/programs") return programs();
  if (path == "/api/program") return program(required(target, "name"));
  if (path == "/api/lessons") return lessons();
  if (path == "/api/export") return exportProgram(target);
  if (path == "/api/diagnostics") {
    OrderedJson list = OrderedJson::array();
    for (const check::DiagnosticInfo& info : check::allDiagnostics())
      list.push_back({{"id", info.id},
                      {"severity", severityName(info.severity)},
                      {"title", info.title},
                      {"why", info.why},
                      {"fix", info.fix}});
    return jsonResponse(list);
  }
  if (path == "/api/library") {
    OrderedJson list = OrderedJson::array();
    for (const EmbeddedFile& library : embeddedShaderLibrary())
      list.push_back({{"path", library.path}, {"text", library.data}});
    return jsonResponse(list);
  }
  return errorResponse(404, "this page does not exist");
}

HttpResponse Api::describeProject() const {
  return jsonResponse({{"folder", project_.root().string()},
                       {"version", QUINTET_VERSION},
                       {"program", defaults_.program},
                       {"scene", defaults_.scene},
                       {"size", {defaults_.size.x, defaults_.size.y}},
                       {"samples", defaults_.samples},
                       {"timeout", defaults_.timeout},
                       {"workers", defaults_.maxSessions}});
}

HttpResponse Api::files() const {
  const ProjectFolder::Listing listing = project_.list();
  OrderedJson entries = OrderedJson::array();
  for (const ProjectFolder::Entry& entry : listing.files)
    entries.push_back({{"path", entry.name}, {"size", entry.size}, {"modified", entry.modified}});
  return jsonResponse({{"files", std::move(entries)}, {"truncated", listing.truncated}});
}

HttpResponse Api::file(const HttpRequest& request, const std::string& name) const {
  if (request.method == "PUT") return putFile(request, name);
  if (request.method == "DELETE") {
    const auto condition = conditionOf(request);
    if (!condition) return conditionMissing();
    project_.remove(name, *condition);
    return jsonResponse({{"path", name}});
  }
  if (request.method != "GET") throw MethodError{"GET, PUT, DELETE"};
  std::string content = project_.read(name);
  const std::string tag = fmt::format("\"{}\"", contentHash(content));
  HttpResponse response{
      .type = std::string(contentType(name)),
      .body = std::move(content),
      .headers = {{"ETag", tag}, {"Cache-Control", "no-cache"}, {"Content-Disposition", "attachment"}}};
  if (response.type.starts_with("text/html")) response.type = kText;  // nothing of the project is a page
  if (request.header("if-none-match") == tag) {
    response.status = 304;
    response.body.clear();
  }
  return response;
}

HttpResponse Api::putFile(const HttpRequest& request, const std::string& name) const {
  const auto condition = conditionOf(request);
  if (!condition) return conditionMissing();
  const ProjectFolder::Written written = project_.write(name, request.body, *condition);
  return jsonResponse({{"path", name}, {"hash", written.hash}, {"size", request.body.size()}},
                      written.created ? 201 : 200);
}

HttpResponse Api::programs() const {
  OrderedJson builtIn = OrderedJson::array(), own = OrderedJson::array();
  static const std::vector<ProgramSummary> kBuiltIn = builtInSummaries();
  for (const ProgramSummary& summary : kBuiltIn) builtIn.push_back(summaryJson(summary));
  for (const ProgramSummary& summary : projectSummaries(project_)) own.push_back(summaryJson(summary));
  return jsonResponse(
      {{"builtIn", std::move(builtIn)}, {"project", std::move(own)}, {"scenes", projectScenes(project_)}});
}

HttpResponse Api::program(const std::string& name) const {
  ProgramFiles found;
  try {
    found = programFiles(project_, name);
  } catch (const NameError&) {
    throw;
  } catch (const UsageError& error) {  // no program has this name
    return errorResponse(404, error.what());
  }
  OrderedJson entries = OrderedJson::array();
  for (const ProgramFile& entry : found.files)
    entries.push_back({{"path", entry.name}, {"role", entry.role}, {"hash", entry.hash}, {"text", entry.text}});
  return jsonResponse({{"name", found.name},
                       {"title", found.title},
                       {"builtIn", isBuiltIn(found.name)},
                       {"form", found.form},
                       {"main", found.main},
                       {"scene", found.scene},
                       {"files", std::move(entries)},
                       {"diagnostics", OrderedJson::parse(check::diagnosticsJson(found.diagnostics))}});
}

HttpResponse Api::copyProgram(const std::string& body) const {
  const nlohmann::json request = parseJson(body);
  const std::string from = request.at("from"), to = request.at("to");
  const bool replace = request.value("replace", false);
  const std::vector<std::string> written = writeFiles(project_, to, copiedFiles(project_, from), replace);
  return jsonResponse({{"name", to}, {"files", written}}, 201);
}

HttpResponse Api::lessons() const {
  static const std::vector<Lesson> kCourse =
      courseLessons(documentText("lessons/README.md"), documentText, program::builtInPrograms());
  OrderedJson list = OrderedJson::array();
  for (const Lesson& lesson : kCourse) {
    const std::string copy = "lessons/" + lesson.name;
    std::error_code ignored;
    list.push_back({{"name", lesson.name},
                    {"number", lesson.number},
                    {"title", lesson.title},
                    {"page", lesson.page},
                    {"image", lesson.image},
                    {"program", fmt::format("<programs/{}>", lesson.program)},
                    {"copy", copy},
                    {"copied", fs::is_directory(project_.root() / copy, ignored)}});
  }
  return jsonResponse(list);
}

HttpResponse Api::documentation(const std::string& name) const {
  constexpr std::string_view kDiagnostics = "diagnostics/", kPage = ".md";
  std::string_view text = documentText(name);
  if (text.empty() && name.starts_with(kDiagnostics) && name.ends_with(kPage))
    text = check::explanation(
        std::string_view(name).substr(kDiagnostics.size(), name.size() - kDiagnostics.size() - kPage.size()));
  if (text.empty()) return errorResponse(404, "this page does not exist");
  return {
      .type = std::string(contentType(name)), .body = std::string(text), .headers = {{"Cache-Control", "no-cache"}}};
}

Api::Answer Api::format(const std::string& text) const {
  const fs::path formatter = findFormatter();
  if (formatter.empty()) return errorResponse(501, "clang-format is not installed on the machine of the server");
  if (*formatters_ >= kMaxFormatters) return errorResponse(503, "other sources are being formatted; try again");
  return std::make_unique<PendingFormat>(formatter, text, formatters_);
}

HttpResponse Api::exportProgram(const RequestTarget& target) const {
  const std::string name = required(target, "name"), form = required(target, "form");
  const ProgramFiles found = programFiles(project_, name);
  const std::string stem = fs::path(found.title).filename().string();
  const auto download = [](const std::string& file) {
    return std::pair<std::string, std::string>("Content-Disposition", fmt::format("attachment; filename=\"{}\"", file));
  };
  if (form == "zip") {
    std::map<std::string, std::string> files;
    for (auto& [file, text] : copiedFiles(project_, name)) files[stem + "/" + file] = std::move(text);
    return {.type = "application/zip", .body = zipFiles(files), .headers = {download(stem + ".zip")}};
  }
  if (form != "lecture") throw UsageError(fmt::format("unknown form '{}'; available: zip, lecture", form));
  if (found.form != "lecture" || found.files.empty()) {
    std::vector<std::string> reasons = lectureObstacles(program::loadProgram(loadableName(project_, name)));
    if (reasons.empty()) reasons.emplace_back("it has several files");
    return errorResponse(409, fmt::format("a lecture file cannot express this program: {}; export it as a zip file",
                                          fmt::join(reasons, "; ")));
  }
  return {.type = std::string(kText),
          .body = found.files.front().text,
          .headers = {download(fs::path(found.main).filename().string())}};
}

HttpResponse Api::importProgram(const HttpRequest& request, const RequestTarget& target) const {
  const std::string folder = required(target, "to");
  const auto replace = target.query.find("replace");
  const std::vector<std::string> written =
      writeFiles(project_, folder, importedFiles(request.body, request.header("content-type"), folder),
                 replace != target.query.end() && replace->second == "1");
  return jsonResponse({{"name", folder}, {"files", written}}, 201);
}

}  // namespace quintet::lab
