# SPDX-License-Identifier: Apache-2.0
# QUINTET_VIEWER decides whether the window is built: ON, OFF, or AUTO (if GLFW and Dear ImGui are installed). If it is,
# the target quintet_imgui has both libraries.
set(QUINTET_VIEWER AUTO CACHE STRING "Build the window, quintet-view: ON, OFF or AUTO")
set_property(CACHE QUINTET_VIEWER PROPERTY STRINGS AUTO ON OFF)

if(NOT QUINTET_VIEWER STREQUAL OFF)
  find_package(glfw3 3.3 QUIET)
  pkg_check_modules(imgui QUIET IMPORTED_TARGET imgui)
  if(TARGET glfw AND TARGET PkgConfig::imgui)
    add_library(quintet_imgui INTERFACE)
    # Headers of a system library are not checked for warnings.
    target_include_directories(quintet_imgui SYSTEM INTERFACE ${imgui_INCLUDE_DIRS})
    target_link_libraries(quintet_imgui INTERFACE ${imgui_LINK_LIBRARIES} glfw)
  elseif(QUINTET_VIEWER STREQUAL AUTO)
    message(STATUS "quintet-view is not built: GLFW 3.3 or Dear ImGui is missing (scripts/setup.sh viewer)")
  else()
    message(FATAL_ERROR "QUINTET_VIEWER=ON requires GLFW 3.3 and Dear ImGui: run scripts/setup.sh viewer")
  endif()
endif()
