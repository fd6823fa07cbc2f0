# SPDX-License-Identifier: Apache-2.0
# Compiler flags, sanitizers, and ccache if it is installed.
set(QUINTET_SANITIZE "" CACHE STRING "Sanitizers for the whole build, for example address,undefined")

add_library(quintet_flags INTERFACE)
target_compile_options(quintet_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                               -Woverloaded-virtual -Wconversion -Wno-sign-conversion
                                               # Structs are initialized partially, with designators or as
                                               # {VK_STRUCTURE_TYPE_…}.
                                               -Wno-missing-field-initializers
                                               # GCC bug 105651: false positives in std::string, more with precompiled headers
                                               $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds>)
if(QUINTET_WERROR)
  target_compile_options(quintet_flags INTERFACE -Werror)
endif()
if(QUINTET_SANITIZE)
  add_compile_options(-fsanitize=${QUINTET_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${QUINTET_SANITIZE})
  # By default UBSan prints a finding and continues, and the test passes.
  if(QUINTET_SANITIZE MATCHES undefined)
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
endif()

# Tests compare results of the host with results of the device, so the host must not contract multiplications and
# additions.
add_compile_options(-ffp-contract=off)

find_program(QUINTET_CCACHE ccache)
if(QUINTET_CCACHE)
  # Paths below the source folder are not part of the key, so different clones share objects. ccache requires
  # -fpch-preprocess and this sloppiness to cache sources with precompiled headers; no source uses time macros.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
               CCACHE_SLOPPINESS=pch_defines,time_macros ${QUINTET_CCACHE})
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
  # Clang rejects a precompiled header if the time of a header has changed, even if its content has not.
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
endif()

find_package(Threads REQUIRED GLOBAL)
