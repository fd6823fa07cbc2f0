# SPDX-License-Identifier: Apache-2.0
# quintet_embed(TARGET SYMBOL ROOT FILES…) adds a C++ source to TARGET with the bytes of the files. Its function
#   std::span<const quintet::EmbeddedFile> quintet::SYMBOL();
# returns them (base/embedded.h) with paths relative to ROOT, sorted by path. Declare the function where it is used.
function(quintet_embed TARGET SYMBOL ROOT)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${SYMBOL}.cpp)
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DSYMBOL=${SYMBOL} -DROOT=${ROOT} "-DFILES=${ARGN}"
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding ${SYMBOL}"
    VERBATIM)
  set_source_files_properties(${out} PROPERTIES COMPILE_OPTIONS "-Wno-overlength-strings")
  target_sources(${TARGET} PRIVATE ${out})
endfunction()

# quintet_embed_folders(TARGET SYMBOL ROOT NAMESPACE namespace FOLDERS folder… [BUILT] [DEPENDS file…]) does the same for
# all files of folders below ROOT ("." is ROOT itself), recursively and as they are when the target is built: the assembler
# copies them, which is faster for images and pages. A folder can be missing. BUILT: a command of the build, whose output is
# in DEPENDS, writes the folders.
function(quintet_embed_folders TARGET SYMBOL ROOT)
  cmake_parse_arguments(ARG "BUILT" "NAMESPACE" "FOLDERS;DEPENDS" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${SYMBOL}.cpp)
  set(files)
  set(globbed ${ARG_FOLDERS})
  if(ARG_BUILT)
    set(globbed)
  endif()
  foreach(folder IN LISTS globbed)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${ROOT}/${folder}/*)
    list(APPEND files ${found})
  endforeach()
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DSYMBOL=${SYMBOL} -DROOT=${ROOT} -DNAMESPACE=${ARG_NAMESPACE} "-DFOLDERS=${ARG_FOLDERS}"
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_folders.cmake
    DEPENDS ${files} ${ARG_DEPENDS} ${PROJECT_SOURCE_DIR}/cmake/embed_folders.cmake
    COMMENT "Embedding ${SYMBOL}"
    VERBATIM)
  # ccache does not know the files that the assembler reads.
  set_source_files_properties(${out} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${TARGET} PRIVATE ${out})
endfunction()
