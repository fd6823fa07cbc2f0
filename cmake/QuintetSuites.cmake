# quintet_add_suites(TARGET LABEL TIMEOUT source…)
#
# One CTest entry LABEL.SUITE per GoogleTest suite of TARGET: the tests of a suite share the device and its compiled
# shaders. Suites are found by the TEST macros of the sources; a source that changes is read again.
#
# Suites share the device: on a CPU most of their time is that of the driver's compiler, which has one thread. On a
# machine of many cores they count as several jobs each, so that no more than eight are on one device at a time. Four
# threads of lavapipe instead of eight per core: most launches are tiny, and to wake 32 threads for one takes longer than
# what they do. The tests of the command line run with as many as a user's.
include(ProcessorCount)
ProcessorCount(QUINTET_CORES)
math(EXPR QUINTET_DEVICE_JOBS "(${QUINTET_CORES} + 7) / 8")
if(QUINTET_DEVICE_JOBS EQUAL 0)
  set(QUINTET_DEVICE_JOBS 1)
endif()

# Suites that measure the time of a launch: nothing else runs beside them.
set(QUINTET_SERIAL_SUITES gpu.GpuSubmissions gpu.GpuTimer)

# CTest starts the longest first, and a fresh clone knows of none how long it takes: seconds of those above ten, on four
# cores without a GPU (docs/measurements.md).
set(QUINTET_SUITE_COSTS
  gpu.PaneWeights 70 gpu.SolidAlpha 50 gpu.SolidLight 50 gpu.Aov 40 gpu.Renderer 40
  gpu.BsdfSampling 30 gpu.SolidFarSide 25 gpu.TriangleLight 25 gpu.LampBehindPanes 22 gpu.StatedError 22
  gpu.LightTreeDevice 20 gpu.Instrument 17 gpu.BsdfFurnace 15 gpu.SolidGlass 15 gpu.Csg 13 gpu.Furnace 11
  gpu.SolidLamp 10
)

# The seconds of an entry in QUINTET_SUITE_COSTS; 0 if it is not there.
function(quintet_suite_cost OUT NAME)
  list(FIND QUINTET_SUITE_COSTS ${NAME} index)
  set(cost 0)
  if(NOT index EQUAL -1)
    math(EXPR index "${index} + 1")
    list(GET QUINTET_SUITE_COSTS ${index} cost)
  endif()
  set(${OUT} ${cost} PARENT_SCOPE)
endfunction()

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
    set(name ${LABEL}.${suite})
    quintet_suite_cost(cost ${name})
    add_test(NAME ${name} COMMAND ${TARGET} --gtest_filter=${suite}.*:*/${suite}.*:${suite}/*)
    set_tests_properties(${name} PROPERTIES ENVIRONMENT "QUINTET_VALIDATE=1;LP_NUM_THREADS=4" LABELS ${LABEL} TIMEOUT ${TIMEOUT}
      PROCESSORS ${QUINTET_DEVICE_JOBS} COST ${cost})
    if(name STREQUAL gpu.GpuContext)  # asks for the variables that we set for lavapipe
      set_tests_properties(${name} PROPERTIES ENVIRONMENT QUINTET_VALIDATE=1)
    endif()
    if(name IN_LIST QUINTET_SERIAL_SUITES)
      set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
    endif()
  endforeach()
endfunction()
