# SPDX-License-Identifier: Apache-2.0
# Precompiled headers: the headers that most sources include and that rarely change. They only save compile time. Sources
# include what they use, and CI compiles every header alone (tests/headers/run).
#
# quintet_precompile(TARGET)        the standard library, fmt and glm, in the target QUINTET_CODE_PRECOMPILED
# quintet_precompile(TARGET TESTS)  also GoogleTest and nlohmann-json, in the target QUINTET_TEST_PRECOMPILED
#
# Since GCC 13, all users of a precompiled header require its optimization level. So folders with a different level set a
# different name.
option(QUINTET_PRECOMPILED "Precompile frequent headers" ON)

set(QUINTET_PRECOMPILED_HEADERS
  <algorithm> <array> <atomic> <cmath> <cstdint> <cstring> <filesystem> <functional> <map> <memory> <mutex> <optional> <set>
  <span> <string> <string_view> <unordered_map> <utility> <variant> <vector>
  <fmt/format.h> <fmt/ranges.h>
  <base/math.h>)  # no absolute path: it would be part of the content, and ccache could not share it between clones

# quintet_add_precompiled(NAME LINK target… HEADERS header…): a target that owns the precompiled headers of others.
function(quintet_add_precompiled NAME)
  cmake_parse_arguments(ARG "" "" "LINK;HEADERS" ${ARGN})
  if(QUINTET_PRECOMPILED)
    file(WRITE ${PROJECT_BINARY_DIR}/precompiled/${NAME}.cpp.new "// Owner of precompiled headers.\n")
    file(COPY_FILE ${PROJECT_BINARY_DIR}/precompiled/${NAME}.cpp.new ${PROJECT_BINARY_DIR}/precompiled/${NAME}.cpp ONLY_IF_DIFFERENT)
    add_library(${NAME} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/precompiled/${NAME}.cpp)
    target_link_libraries(${NAME} PRIVATE quintet_flags ${ARG_LINK})
    target_include_directories(${NAME} PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_precompile_headers(${NAME} PRIVATE ${QUINTET_PRECOMPILED_HEADERS} ${ARG_HEADERS})
  endif()
endfunction()

function(quintet_precompile TARGET)
  if(NOT QUINTET_PRECOMPILED)
    return()
  endif()
  if(ARGN STREQUAL TESTS)
    if(NOT TARGET ${QUINTET_TEST_PRECOMPILED})
      quintet_add_precompiled(${QUINTET_TEST_PRECOMPILED} LINK fmt::fmt glm::glm GTest::gmock nlohmann_json::nlohmann_json
        HEADERS <gmock/gmock.h> <gtest/gtest.h> <nlohmann/json.hpp>)
    endif()
    target_precompile_headers(${TARGET} REUSE_FROM ${QUINTET_TEST_PRECOMPILED})
    # A precompiled header requires the same code model in all its users, executables and libraries.
    set_target_properties(${TARGET} ${QUINTET_TEST_PRECOMPILED} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  else()
    if(NOT TARGET ${QUINTET_CODE_PRECOMPILED})
      quintet_add_precompiled(${QUINTET_CODE_PRECOMPILED} LINK fmt::fmt glm::glm)
    endif()
    target_precompile_headers(${TARGET} REUSE_FROM ${QUINTET_CODE_PRECOMPILED})
    # A precompiled header requires the same code model in all its users, and libraries are compiled with -fPIC.
    get_target_property(type ${TARGET} TYPE)
    if(type STREQUAL EXECUTABLE)
      set_target_properties(${TARGET} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
      target_compile_options(${TARGET} PRIVATE -fPIC)
    endif()
  endif()
endfunction()
