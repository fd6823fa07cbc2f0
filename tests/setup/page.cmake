# SPDX-License-Identifier: Apache-2.0
# The build of the lab's page (apps/lab/build_page.cmake) with a script in place of npm: a failed 'npm ci' is tried again, and
# nothing is written into the source tree.
#   cmake -DSOURCE=… -DBUILD=… -P page.cmake
cmake_minimum_required(VERSION 3.25)
set(work ${BUILD}/tests/page-test)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work}/source/web/src ${work}/source/web/build ${work}/source/web/node_modules)
foreach(name IN ITEMS package.json package-lock.json .npmrc src/main.ts build/build.mjs node_modules/stale)
  file(WRITE ${work}/source/web/${name} "first\n")
endforeach()
# 'npm ci' succeeds if the file 'online' exists. 'npm run build' copies the source.
file(WRITE ${work}/npm "#!/bin/sh
echo \"$1\" >>'${work}/calls'
case $1 in
  ci) [ -e '${work}/online' ] && mkdir -p node_modules && touch node_modules/.package-lock.json ;;
  run) mkdir -p \"$6\" && cp src/*.ts \"$6\" && printf '%s' \"$QUINTET_SOURCE\" >\"$6/repository\" ;;
esac
")
file(CHMOD ${work}/npm PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)

# Runs the build and sets OUTPUT to what it prints.
function(build_page OUTPUT)
  execute_process(COMMAND ${CMAKE_COMMAND} -DSOURCE=${work}/source/web -DWEB=${work}/web -DOUT=${work}/page -DNPM=${work}/npm
                          -DSTAMP=${work}/page.stamp -P ${SOURCE}/apps/lab/build_page.cmake
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "the build of the page failed:\n${output}")
  endif()
  set(${OUTPUT} "${output}" PARENT_SCOPE)
endfunction()

# Fails if the condition is false: expect("what must hold" condition…)
macro(expect WHAT)
  if(NOT (${ARGN}))
    message(FATAL_ERROR "${WHAT}")
  endif()
endmacro()

file(GLOB_RECURSE before RELATIVE ${work}/source ${work}/source/*)
build_page(output)
expect("a failed 'npm ci' is reported" output MATCHES "'npm ci' failed" AND output MATCHES "next[ \n]+build tries again")
expect("without packages, there is no page" NOT EXISTS ${work}/page AND NOT EXISTS ${work}/page.stamp)

file(TOUCH ${work}/online)
build_page(output)
expect("the next build installs the packages" EXISTS ${work}/page.stamp AND EXISTS ${work}/page/main.ts)
file(READ ${work}/page/repository repository)
expect("the script gets the folder of the repository" repository STREQUAL "${work}/source")
expect("packages of the source tree are not copied" NOT EXISTS ${work}/web/node_modules/stale)

file(REMOVE ${work}/source/web/src/main.ts)
file(WRITE ${work}/source/web/src/other.ts "second\n")
build_page(output)
expect("a removed source is gone" EXISTS ${work}/page/other.ts AND NOT EXISTS ${work}/page/main.ts)
file(READ ${work}/calls calls)
string(REPLACE "\n" " " calls "${calls}")
expect("packages are installed once" calls STREQUAL "ci ci run run ")

# A changed lock file that cannot be installed removes the page, and is tried again.
file(REMOVE ${work}/online)
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1.1)  # times of files can have whole seconds
file(WRITE ${work}/source/web/package-lock.json "second\n")
build_page(output)
expect("packages of an earlier lock file do not count" NOT EXISTS ${work}/page.stamp AND NOT EXISTS ${work}/page)
file(TOUCH ${work}/online)
build_page(output)
expect("the changed lock file is installed" EXISTS ${work}/page.stamp)

file(REMOVE ${work}/source/web/src/other.ts)
file(WRITE ${work}/source/web/src/main.ts "first\n")
file(GLOB_RECURSE after RELATIVE ${work}/source ${work}/source/*)
if(NOT before STREQUAL after)
  message(FATAL_ERROR "the source tree has changed: ${after}")
endif()
