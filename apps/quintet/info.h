// What `quintet info` can describe, as text for people or as one JSON object.
#ifndef QUINTET_APP_INFO_H
#define QUINTET_APP_INFO_H

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace quintet::app {

std::string devicesInfo(bool json);                                                                // info_devices.cpp
std::string sceneInfo(const std::filesystem::path&, bool json);                                    // info_scene.cpp
std::string imageInfo(const std::filesystem::path&, std::span<const std::byte> bytes, bool json);  // info_image.cpp
std::string exrInfo(const std::filesystem::path&, std::span<const std::byte> bytes, bool json);    // info_exr.cpp
std::string filmInfo(const std::filesystem::path&, std::span<const std::byte> bytes, bool json);   // info_film.cpp

}  // namespace quintet::app
#endif
