# quintet_embed(TARGET SYMBOL ROOT FILES…): adds a C++ source to TARGET that holds the files'
# bytes, as the function   std::span<const quintet::EmbeddedFile> quintet::SYMBOL();
# (base/embedded.h; declare it where it is used), with paths relative to ROOT, sorted.
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
