# SPDX-License-Identifier: Apache-2.0
# The notices of the build (cmake/write_notices.cmake) with made-up packages: each text is in them, and a missing one is an
# error or stated.
#   cmake -DSOURCE=… -DBUILD=… -P notices.cmake
cmake_minimum_required(VERSION 3.25)
set(work ${BUILD}/tests/notices-test)
file(REMOVE_RECURSE ${work})
file(WRITE ${work}/components.txt "# name | title
one | First library | libone-dev one |
two | Second | libtwo-dev two |
three | Third | three | viewer
four | Fourth | four | lab
five | Fifth | libfive*-dev | | Five-1.0
")
file(WRITE ${work}/doc/libone-dev/copyright "Text of one; see /usr/share/common-licenses/Apache-2.0.\n")
file(WRITE ${work}/licenses/two/LICENSE.md "Text of two [x]\n")
file(WRITE ${work}/licenses/two/COPYING "Copying of two\n")
file(WRITE ${work}/doc/three/copyright "Text of three\n")
file(WRITE ${work}/doc/libfive5-dev/copyright "Files: *\nLicense: Five-1.0\n\nFiles: x\nLicense: Six\n Text of six\n
License: Five-1.0\n Text of five\n .\n Its end\n\nLicense: Seven\n Text of seven\n")
file(WRITE ${work}/common/Apache-2.0 "Long text\n")
file(WRITE ${work}/page/index.html "page\n")
file(WRITE ${work}/page/licenses.txt "Text of a package of npm\n")

# Writes the notices with these options, and sets STATUS, OUTPUT (messages) and TEXT.
macro(write_notices)
  file(REMOVE ${work}/out.txt)
  execute_process(COMMAND ${CMAKE_COMMAND} -DCOMPONENTS=${work}/components.txt "-DPARTS=viewer;other" -DPAGE=${work}/page/licenses.txt
                          -DOUT=${work}/out.txt "-DFOLDERS=;${work}/doc;${work}/licenses" -DCOMMON=${work}/common ${ARGN}
                          -P ${SOURCE}/cmake/write_notices.cmake
                  RESULT_VARIABLE STATUS OUTPUT_VARIABLE OUTPUT ERROR_VARIABLE OUTPUT)
  set(TEXT)
  if(EXISTS ${work}/out.txt)
    file(READ ${work}/out.txt TEXT)
  endif()
endmacro()

function(expect_text WHAT)
  foreach(text IN LISTS ARGN)
    string(FIND "${WHAT}" "${text}" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "'${text}' is missing in:\n${WHAT}")
    endif()
  endforeach()
endfunction()

write_notices(-DREQUIRED=ON)
if(NOT STATUS EQUAL 0 OR TEXT MATCHES "INCOMPLETE|Fourth")
  message(FATAL_ERROR "all texts exist:\n${OUTPUT}${TEXT}")
endif()
expect_text("${TEXT}" "Text of one; see" "Text of two [x]" "Copying of two" "Text of three" "Long text"
            "Text of a package of npm" "    Third\n")

expect_text("${TEXT}" "License: Five-1.0\n Text of five\n .\n Its end\n")
if(TEXT MATCHES "Text of (six|seven)")
  message(FATAL_ERROR "only one license of a package is named:\n${TEXT}")
endif()

file(REMOVE ${work}/page/licenses.txt)
file(REMOVE_RECURSE ${work}/licenses ${work}/common)
write_notices(-DREQUIRED=AUTO)
if(NOT STATUS EQUAL 0)
  message(FATAL_ERROR "a missing text is a warning:\n${OUTPUT}")
endif()
foreach(name IN ITEMS "Second (package libtwo-dev two)" "/usr/share/common-licenses/Apache-2.0" "npm packages")
  expect_text("${TEXT}" "INCOMPLETE" "${name}" "not found when Quintet was built")
endforeach()
expect_text("${OUTPUT}" "license texts are missing")

write_notices(-DREQUIRED=ON)
if(STATUS EQUAL 0 OR NOT "${TEXT}" STREQUAL "")
  message(FATAL_ERROR "QUINTET_NOTICES=ON: a missing text is an error")
endif()
expect_text("${OUTPUT}" "Second" "QUINTET_LICENSES")
