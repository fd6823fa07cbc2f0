# SPDX-License-Identifier: Apache-2.0
# quintet_notices() builds ${PROJECT_BINARY_DIR}/notices/THIRD-PARTY-NOTICES.txt, the license texts of the code by others in
# the binaries (components.txt, and the npm packages in the page of the lab), with the target quintet_notices_file, and sets
# QUINTET_NOTICES_FILE to it. Call it after the parts of the build are known.
set(QUINTET_NOTICES AUTO CACHE STRING "Missing license texts: ON is an error, AUTO a warning that the notices repeat")
set_property(CACHE QUINTET_NOTICES PROPERTY STRINGS AUTO ON)
set(QUINTET_LICENSES "" CACHE STRING "Folders with license texts, FOLDER/PACKAGE/*, before those of the system")

# Each library that the build finds must be in components.txt.
function(quintet_check_components COMPONENTS)
  file(STRINGS ${COMPONENTS} rows REGEX "^[^#]")
  foreach(row IN LISTS rows)
    string(REGEX REPLACE " *\\|.*" "" name "${row}")
    list(APPEND known ${name})
  endforeach()
  file(GLOB finders ${PROJECT_SOURCE_DIR}/cmake/Quintet*.cmake)
  foreach(finder IN LISTS finders)
    file(STRINGS ${finder} calls REGEX "^ *(find_package|pkg_check_modules|quintet_header_library)\\(")
    foreach(call IN LISTS calls)
      string(REGEX REPLACE "^ *[a-z_]+\\(([^ )]+).*" "\\1" name "${call}")
      if(NOT name IN_LIST known AND NOT name MATCHES "^(PkgConfig|Threads|GTest)$")
        message(FATAL_ERROR "${finder} finds '${name}', whose license is missing in cmake/components.txt")
      endif()
    endforeach()
  endforeach()
endfunction()

function(quintet_notices)
  set(components ${PROJECT_SOURCE_DIR}/cmake/components.txt)
  set(script ${PROJECT_SOURCE_DIR}/cmake/write_notices.cmake)
  quintet_check_components(${components})
  set(parts)
  set(page)
  if(TARGET quintet_imgui AND QUINTET_APPS)
    list(APPEND parts viewer)
  endif()
  if(TARGET quintet_boost AND QUINTET_APPS)
    list(APPEND parts lab)
    find_package(mimalloc CONFIG QUIET)
    if(TARGET mimalloc AND NOT QUINTET_SANITIZE)
      list(APPEND parts mimalloc)
    endif()
    set(page ${QUINTET_PAGE}/licenses.txt)
  endif()
  set(out ${PROJECT_BINARY_DIR}/notices/THIRD-PARTY-NOTICES.txt)
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DCOMPONENTS=${components} "-DPARTS=${parts}" -DPAGE=${page} -DOUT=${out}
            "-DFOLDERS=${QUINTET_LICENSES};/usr/share/doc;/usr/share/licenses" -DCOMMON=/usr/share/common-licenses
            -DREQUIRED=${QUINTET_NOTICES} -P ${script}
    DEPENDS ${components} ${script} ${QUINTET_PAGE_STAMP}
    COMMENT "Collecting license texts"
    VERBATIM)
  set(all)
  if(QUINTET_INSTALL)
    set(all ALL)
  endif()
  add_custom_target(quintet_notices_file ${all} DEPENDS ${out})
  set(QUINTET_NOTICES_FILE ${out} PARENT_SCOPE)
endfunction()
