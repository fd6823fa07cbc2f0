# SPDX-License-Identifier: Apache-2.0
# Sets QUINTET_PAGE to the folder with the built page, and QUINTET_PAGE_STAMP to a file that is newer than the page's
# sources once it is built; empty if npm is missing. npm works in a copy of web/ in the build folder, QUINTET_WEB, so that
# the source tree stays as it is.
set(web ${PROJECT_SOURCE_DIR}/web)
set(QUINTET_PAGE ${web}/dist)
set(QUINTET_PAGE_STAMP)
set(QUINTET_WEB ${PROJECT_BINARY_DIR}/web CACHE INTERNAL "The copy of web/ with the packages of npm")
find_program(QUINTET_NPM npm)
find_program(QUINTET_NODE node)
if(NOT EXISTS ${web}/package-lock.json)
  return()
endif()
if(NOT QUINTET_NPM OR NOT QUINTET_NODE)
  message(STATUS "The page of the lab is not built: Node.js or npm is missing (scripts/setup.sh page)")
  return()
endif()
file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${web}/src/* ${web}/build/* ${web}/test/*)
set(QUINTET_PAGE ${PROJECT_BINARY_DIR}/page)
set(QUINTET_PAGE_STAMP ${PROJECT_BINARY_DIR}/page.stamp)
add_custom_command(
  OUTPUT ${QUINTET_PAGE_STAMP}
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${web} -DWEB=${QUINTET_WEB} -DOUT=${QUINTET_PAGE} -DNPM=${QUINTET_NPM}
          -DSTAMP=${QUINTET_PAGE_STAMP} -P ${CMAKE_CURRENT_LIST_DIR}/build_page.cmake
  DEPENDS ${page_sources} ${web}/package.json ${web}/package-lock.json ${web}/.npmrc ${web}/tsconfig.json
          ${CMAKE_CURRENT_LIST_DIR}/build_page.cmake
  COMMENT "Building the page of the lab"
  VERBATIM)
add_custom_target(quintet_page DEPENDS ${QUINTET_PAGE_STAMP})
