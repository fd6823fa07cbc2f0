# SPDX-License-Identifier: Apache-2.0
# Sets QUINTET_PAGE to the folder with the built page, and QUINTET_PAGE_STAMP to a file that is newer than the page's
# sources once it is built; empty if npm is missing.
set(web ${CMAKE_SOURCE_DIR}/web)
set(QUINTET_PAGE ${web}/dist)
set(QUINTET_PAGE_STAMP)
find_program(QUINTET_NPM npm)
find_program(QUINTET_NODE node)
if(NOT EXISTS ${web}/package-lock.json)
  return()
endif()
if(NOT QUINTET_NPM OR NOT QUINTET_NODE)
  message(STATUS "The page of the lab is not built: Node.js or npm is missing (scripts/setup.sh page)")
  return()
endif()
file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${web}/src/* ${web}/build/*)
set(QUINTET_PAGE ${CMAKE_BINARY_DIR}/page)
set(QUINTET_PAGE_STAMP ${CMAKE_BINARY_DIR}/page.stamp)
add_custom_command(
  OUTPUT ${QUINTET_PAGE_STAMP}
  COMMAND ${CMAKE_COMMAND} -DWEB=${web} -DOUT=${QUINTET_PAGE} -DNPM=${QUINTET_NPM} -DSTAMP=${QUINTET_PAGE_STAMP}
          -P ${CMAKE_CURRENT_LIST_DIR}/build_page.cmake
  DEPENDS ${page_sources} ${web}/package.json ${web}/package-lock.json ${CMAKE_CURRENT_LIST_DIR}/build_page.cmake
  COMMENT "Building the page of the lab"
  VERBATIM)
