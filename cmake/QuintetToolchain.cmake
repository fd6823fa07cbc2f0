# Compiler flags, sanitizers, ccache and a fast linker where they exist.
set(QUINTET_SANITIZE "" CACHE STRING "Sanitizers for the whole build, e.g. address,undefined")

add_library(quintet_flags INTERFACE)
target_compile_options(quintet_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                               -Woverloaded-virtual -Wconversion -Wno-sign-conversion
                                               $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)  # GCC bug 105651: false alarms in std::string
if(QUINTET_WERROR)
  target_compile_options(quintet_flags INTERFACE -Werror)
endif()
if(QUINTET_SANITIZE)
  add_compile_options(-fsanitize=${QUINTET_SANITIZE} -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${QUINTET_SANITIZE})
endif()

# The shaders' own arithmetic must not depend on the host's contraction: results of the host
# side of a computation are compared with the device's in the tests.
add_compile_options(-ffp-contract=off)

find_program(QUINTET_CCACHE ccache)
if(QUINTET_CCACHE)
  # Paths below the source folder do not count: another clone finds the same objects.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${QUINTET_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
endif()

find_package(Threads REQUIRED)
