# SPDX-License-Identifier: Apache-2.0
# quintet_embed(TARGET SYMBOL ROOT FILES…) adds a C++ source to TARGET with the bytes of the files. Its function
#   std::span<const quintet::EmbeddedFile> quintet::SYMBOL();
# returns them (base/embedded.h) with paths relative to ROOT, sorted by path. Declare the function where it is used.
function(quintet_embed TARGET SYMBOL ROOT)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${SYMBOL}.cpp)
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DSYMBOL=${SYMBOL} -DROOT=${ROOT} "-DFILES=${ARGN}"
            -P ${CMAKE_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${ARGN} ${CMAKE_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding ${SYMBOL}"
    VERBATIM)
  set_source_files_properties(${out} PROPERTIES COMPILE_OPTIONS "-Wno-overlength-strings")
  target_sources(${TARGET} PRIVATE ${out})
endfunction()
