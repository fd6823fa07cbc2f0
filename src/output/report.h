// SPDX-License-Identifier: Apache-2.0
// A finished render for machines and for people: --json and the line at the end.
#ifndef QUINTET_OUTPUT_REPORT_H
#define QUINTET_OUTPUT_REPORT_H

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/result.h"
#include "output/frame_files.h"
#include "output/write.h"

namespace quintet::output {

// One object on one line. `files`: written by the command, in their order; `totalSeconds`: of the command so far;
// `frames`: of an animation with an image of each, else empty.
std::string resultJson(const job::RenderResult& result, const std::vector<WrittenFile>& files, double totalSeconds,
                       const std::vector<FrameFiles>& frames = {});

// A failed command as one object on one line: {"error": {"message", "file", "location", "exitStatus"}}. `file`: the error if
// it is about a file, else null; then the file and its location are null, as is a location that is unknown. `scene`: of
// several, the one that failed, as "scene" in the object; empty for a command with one scene.
std::string errorJson(const std::string& message, const FileError* file, int exitStatus, const std::string& scene = {});

// {"scene": "fox.glb"} on one line: begins the progress of one of several scenes.
std::string sceneJson(const std::filesystem::path& scene);

// A line that a program printed: "hit.rchit:12: pixel 3,4, sample 0: t = 1.5". Further lines of its text are indented.
std::string printedText(const job::PrintedLine& line);
// The same as an object on one line, as in the array of resultJson().
std::string printedJson(const job::PrintedLine& line);

// "out.png: 1280x720, 64 samples per pixel, error 1.2 %, 12.3 s, 4.56 Mrays/s"; of several frames their number and the
// last file: "f0009.png: 10 frames (7 written before), 1280x720, …"
std::string resultSummary(const job::RenderResult& result, const std::vector<WrittenFile>& files,
                          const std::vector<FrameFiles>& frames = {});

}  // namespace quintet::output
#endif
