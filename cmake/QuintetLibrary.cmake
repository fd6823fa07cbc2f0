# quintet_library(NAME [DEPENDS layer…] [LINK target…] [LINK_PUBLIC target…] [SYSTEM_INCLUDES dir…])
#
# Makes the static library quintet_NAME from the folder's *.cpp files. Other targets see its
# headers as "NAME/file.h", and only if they link it: each library exports one include root
# that contains nothing but a link to its own folder.
function(quintet_library NAME)
  cmake_parse_arguments(ARG "" "" "DEPENDS;LINK;LINK_PUBLIC;DEFINES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  set(target quintet_${NAME})
  add_library(${target} STATIC ${sources} ${headers})
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)

  set(root ${CMAKE_BINARY_DIR}/include/${NAME})
  file(MAKE_DIRECTORY ${root})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/${NAME} SYMBOLIC)
  target_include_directories(${target} PUBLIC ${root})

  foreach(layer IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC quintet_${layer})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ARG_LINK_PUBLIC} PRIVATE quintet_flags ${ARG_LINK})
  target_compile_definitions(${target} PRIVATE ${ARG_DEFINES})
endfunction()
