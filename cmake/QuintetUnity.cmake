# SPDX-License-Identifier: Apache-2.0
# quintet_unity(TARGET [SIZE]) compiles the sources of a target in groups, by default of 8, which takes half of the time in a
# new clone: the sources of a group share the headers and their templates. Groups of 16 save another quarter, but more
# names can meet. A changed source compiles with its group; use -DQUINTET_UNITY=OFF while you work on them. Sources of a group
# must not define the same name, even in unnamed namespaces. Sources with compile options of their own stay alone.
option(QUINTET_UNITY "Compile sources in groups" ON)

function(quintet_unity TARGET)
  if(QUINTET_UNITY)
    set(size 8)
    if(ARGC GREATER 1)
      set(size ${ARGV1})
    endif()
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
    # GCC assumes that a file which is included can be included twice.
    target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()
