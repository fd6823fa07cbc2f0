# SPDX-License-Identifier: Apache-2.0
# Finds all third-party libraries; docs/design/dependencies.md states the reason for each. It is also a part of the installed
# package if libquintet is a static library. Targets are global, for projects that add Quintet with add_subdirectory().
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL TRUE)
find_package(PkgConfig REQUIRED)

find_package(VulkanHeaders CONFIG QUIET)
if(NOT TARGET Vulkan::Headers)
  find_package(Vulkan REQUIRED)  # only the headers: volk loads the loader at runtime
endif()
find_package(fmt REQUIRED)
find_package(glm REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(ZLIB REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
pkg_check_modules(spng REQUIRED IMPORTED_TARGET GLOBAL spng)
pkg_check_modules(turbojpeg REQUIRED IMPORTED_TARGET GLOBAL libturbojpeg)
pkg_check_modules(webp REQUIRED IMPORTED_TARGET GLOBAL libwebp)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET GLOBAL libzstd)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET GLOBAL libxxhash)
pkg_check_modules(shaderc REQUIRED IMPORTED_TARGET GLOBAL shaderc)

# Header-only packages without a usable CMake or pkg-config file.
function(quintet_header_library NAME HEADER)
  if(TARGET ${NAME})
    return()
  endif()
  find_path(${NAME}_INCLUDE_DIR ${HEADER} REQUIRED)
  add_library(${NAME} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${NAME} SYSTEM INTERFACE ${${NAME}_INCLUDE_DIR})
endfunction()
quintet_header_library(quintet_volk volk.h)
quintet_header_library(quintet_vma vk_mem_alloc.h)
quintet_header_library(quintet_tinygltf tiny_gltf.h)
quintet_header_library(quintet_tomlplusplus toml++/toml.h)
# For code points such as U+00E9 version 3.3.0 executes statements that it marks as unreachable. Both branches after
# them give the same result.
if(QUINTET_SANITIZE MATCHES undefined)
  target_compile_options(quintet_tomlplusplus INTERFACE -fno-sanitize=unreachable)
endif()
quintet_header_library(quintet_spirv_headers spirv/unified1/spirv.hpp11)
