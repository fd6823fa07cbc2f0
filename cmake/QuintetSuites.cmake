# quintet_add_suites(TARGET LABEL TIMEOUT source…)
#
# One CTest entry LABEL.SUITE per GoogleTest suite of TARGET: the tests of a suite share the device and its compiled
# shaders. Suites are found by the TEST macros of the sources; a source that changes is read again. The lock: two
# processes on one device would only wait for each other.
function(quintet_add_suites TARGET LABEL TIMEOUT)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  foreach(source IN LISTS ARGN)
    file(STRINGS ${source} lines REGEX "^(TYPED_)?TEST(_F|_P)?\\(")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[A-Z_]+\\( *([A-Za-z0-9_]+).*" "\\1" suite "${line}")
      list(APPEND suites ${suite})
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  foreach(suite IN LISTS suites)
    add_test(NAME ${LABEL}.${suite} COMMAND ${TARGET} --gtest_filter=${suite}.*:*/${suite}.*:${suite}/*)
    set_tests_properties(${LABEL}.${suite} PROPERTIES
      ENVIRONMENT QUINTET_VALIDATE=1 LABELS ${LABEL} RESOURCE_LOCK device TIMEOUT ${TIMEOUT})
  endforeach()
endfunction()
