# SPDX-License-Identifier: Apache-2.0
# Finds a way to link shaderc. In the packages of Debian and Ubuntu (2023.2), neither libshaderc.so nor
# libshaderc_combined.a contains glslang and SPIRV-Tools, so neither links alone. On other systems the combined archive is
# complete. Static linking is preferred: the binary then runs where shaderc is not installed.
include(CheckCXXSourceCompiles)

function(quintet_try_shaderc RESULT)
  set(CMAKE_REQUIRED_LIBRARIES ${ARGN} Threads::Threads)
  set(CMAKE_REQUIRED_QUIET ON)
  check_cxx_source_compiles("#include <shaderc/shaderc.hpp>
    int main() { return shaderc::Compiler().CompileGlslToSpv(\"\", 0, shaderc_compute_shader, \"\").GetNumErrors() != 0; }"
    ${RESULT})
endfunction()

function(quintet_link_shaderc TARGET)
  set(glslang glslang MachineIndependent GenericCodeGen OSDependent OGLCompiler SPIRV SPIRV-Tools-opt SPIRV-Tools)
  quintet_try_shaderc(QUINTET_SHADERC_COMBINED shaderc_combined)
  if(QUINTET_SHADERC_COMBINED)
    set(libraries shaderc_combined)
  else()
    quintet_try_shaderc(QUINTET_SHADERC_STATIC shaderc_combined ${glslang})
    if(QUINTET_SHADERC_STATIC)
      set(libraries shaderc_combined ${glslang})
    else()
      quintet_try_shaderc(QUINTET_SHADERC_SHARED PkgConfig::shaderc)
      if(NOT QUINTET_SHADERC_SHARED)
        message(FATAL_ERROR "shaderc does not link: install libshaderc-dev, glslang-dev and spirv-tools")
      endif()
      set(libraries PkgConfig::shaderc SPIRV-Tools-opt SPIRV-Tools)  # shader/optimizer.cpp calls SPIRV-Tools itself
    endif()
  endif()
  message(STATUS "shaderc: ${libraries}")
  target_link_libraries(${TARGET} PRIVATE ${libraries} Threads::Threads)
endfunction()
