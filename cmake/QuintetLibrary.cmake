# SPDX-License-Identifier: Apache-2.0
# quintet_library(NAME [UNITY size] [DEPENDS layer…] [LINK target…] [LINK_PUBLIC target…] [DEFINES definition…] [EXCLUDE folder…])
#
# Creates the static library quintet_NAME from the sources of the current folder and its subfolders, except the folders
# of EXCLUDE. Other targets include its headers as "NAME/file.h", but only if they link the library: each library
# exports one include root that contains only a link to its folder. UNITY compiles the sources in groups of this
# size (QuintetUnity.cmake).
function(quintet_library NAME)
  cmake_parse_arguments(ARG "" "UNITY" "DEPENDS;LINK;LINK_PUBLIC;DEFINES;EXCLUDE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  foreach(folder IN LISTS ARG_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${folder}/")
  endforeach()
  set(target quintet_${NAME})
  add_library(${target} STATIC ${sources})
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)

  set(root ${PROJECT_BINARY_DIR}/include/${NAME})
  file(MAKE_DIRECTORY ${root})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/${NAME} SYMBOLIC)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}>)

  foreach(layer IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC quintet_${layer})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ARG_LINK_PUBLIC} PRIVATE $<BUILD_INTERFACE:quintet_flags> ${ARG_LINK})
  target_compile_definitions(${target} PRIVATE ${ARG_DEFINES})
  quintet_precompile(${target})
  if(ARG_UNITY)
    quintet_unity(${target} ${ARG_UNITY})
  endif()
endfunction()
