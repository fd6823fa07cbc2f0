# SPDX-License-Identifier: Apache-2.0
# The installed documentation has no dead links, and its files are readable text:
#   cmake -DBUILD=… -DSOURCE=… -P docs.cmake
cmake_minimum_required(VERSION 3.25)
set(work ${BUILD}/tests/docs-test)
file(REMOVE_RECURSE ${work})
set(documentation ${work}/share/doc/quintet)
execute_process(COMMAND ${CMAKE_COMMAND} -DSOURCE=${SOURCE} -DWORK=${work}/work -DDESTINATION=${documentation}
                        -P ${SOURCE}/cmake/install_docs.cmake OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND bash ${SOURCE}/tests/style/links ${documentation} COMMAND_ERROR_IS_FATAL ANY)

# Pages without links to sources are the same, and a changed page differs only in its links.
file(READ ${SOURCE}/docs/lab.md before)
file(READ ${documentation}/docs/lab.md after)
if(NOT before STREQUAL after)
  message(FATAL_ERROR "docs/lab.md has only links to installed files, and has changed")
endif()
file(READ ${documentation}/docs/design/dependencies.md page)
if(NOT page MATCHES "\nthem\\. The build downloads nothing" OR NOT page MATCHES "QuintetDependencies\\.cmake" OR
   page MATCHES "\\(\\.\\./\\.\\./cmake/")
  message(FATAL_ERROR "docs/design/dependencies.md: a link to a source is not its text:\n${page}")
endif()
