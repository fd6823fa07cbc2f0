# SPDX-License-Identifier: Apache-2.0
# Installs the library with a CMake package and a file for pkg-config.

# Sets ARCHIVES to the static libraries of Quintet that TARGET links, itself included, and FLAGS to what a linker needs for
# them, each item before those that it uses.
function(quintet_link_closure ARCHIVES FLAGS TARGET)
  set(open ${TARGET})
  set(order)
  while(open)
    list(POP_FRONT open item)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" item "${item}")
    if(item STREQUAL "" OR item MATCHES "^\\$<")
      continue()
    endif()
    list(REMOVE_ITEM order ${item})  # it follows all that link it
    list(APPEND order ${item})
    if(TARGET ${item})
      get_target_property(links ${item} INTERFACE_LINK_LIBRARIES)
      if(links)
        list(APPEND open ${links})
      endif()
    endif()
  endwhile()
  set(archives)
  set(flags)
  foreach(item IN LISTS order)
    if(NOT TARGET ${item})
      if(NOT item MATCHES "^[-/]")
        string(PREPEND item "-l")
      endif()
      list(APPEND flags ${item})
      continue()
    endif()
    get_target_property(imported ${item} IMPORTED)
    get_target_property(kind ${item} TYPE)
    if(imported AND NOT kind STREQUAL INTERFACE_LIBRARY)
      list(APPEND flags $<TARGET_LINKER_FILE:${item}>)
    elseif(NOT imported)
      list(APPEND archives ${item})
      list(APPEND flags -l$<TARGET_FILE_BASE_NAME:${item}>)
    endif()
  endforeach()
  set(${ARCHIVES} ${archives} PARENT_SCOPE)
  set(${FLAGS} ${flags} PARENT_SCOPE)
endfunction()

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/quintet)
set(archives quintet_api)
set(flags -lquintet)
set(dependencies)
if(type STREQUAL STATIC)
  quintet_link_closure(archives flags quintet_api)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/QuintetDependencies.cmake DESTINATION ${package})
  set(dependencies "find_package(Threads REQUIRED)\ninclude(\${CMAKE_CURRENT_LIST_DIR}/QuintetDependencies.cmake)\n")
endif()
install(TARGETS ${archives} EXPORT quintet)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/quintet DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT quintet NAMESPACE quintet:: DESTINATION ${package} FILE quintetTargets.cmake)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/quintetConfig.cmake
     "${dependencies}include(\${CMAKE_CURRENT_LIST_DIR}/quintetTargets.cmake)\n")
write_basic_package_version_file(quintetConfigVersion.cmake COMPATIBILITY ${compatibility})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/quintetConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/quintetConfigVersion.cmake
        DESTINATION ${package})

# The paths are relative to the file, so that an installation can be moved.
list(JOIN flags " " flags)
file(RELATIVE_PATH prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/quintet.pc CONTENT "prefix=\${pcfiledir}/${prefix}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: Quintet
Description: Vulkan ray tracing: five shaders in, image out
Version: ${PROJECT_VERSION}
Cflags: -I\${includedir}
Libs: -L\${libdir} ${flags}
")
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/quintet.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
