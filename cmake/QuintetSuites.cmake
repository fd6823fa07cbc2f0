# SPDX-License-Identifier: Apache-2.0
# quintet_add_suites(TARGET LABEL TIMEOUT source…)         tests that use the device
# quintet_add_host_suites(TARGET LABEL TIMEOUT source…)    tests that use none
#
# Adds one CTest entry LABEL.SUITE per GoogleTest suite of TARGET: the tests of a suite share the device, its compiled
# shaders, and the tables of the GLSL compiler. Suites are found by the TEST macros of the sources; CMake runs again if a
# source changes. A suite below the folder scene/ also has the label layer-scene (scripts/check_fast.sh).
#
# Suites share the device. On a CPU they spend most of their time in the driver's compiler, which has one thread. On
# machines with many cores each suite counts as several jobs, so that at most eight suites use the device at a time.
# lavapipe gets four threads instead of eight per core, because most launches are so small that waking 32 threads takes
# longer than the work. The command line tests use the default number of threads.
#
# GALLIVM_PERF=nopt makes lavapipe compile a pipeline without the optimizations of LLVM, in less than half of the time.
# Tests that compile much and trace few rays take half as long with it. The tests of images, the lessons, the oracle and
# the long ones of the command line and the window use the driver as users do. Other drivers ignore the variable.
include(ProcessorCount)
ProcessorCount(QUINTET_CORES)
math(EXPR QUINTET_DEVICE_JOBS "(${QUINTET_CORES} + 7) / 8")
if(QUINTET_DEVICE_JOBS EQUAL 0)
  set(QUINTET_DEVICE_JOBS 1)
endif()

# Labels of the suites that compile without optimization, and suites of these labels that trace too many rays for it.
set(QUINTET_UNOPTIMIZED_LABELS gpu api)
set(QUINTET_OPTIMIZED_SUITES gpu.BsdfFurnace gpu.ErrorEstimate gpu.LightTreeDevice)

# The longest suites: those that compare many samples with integrals or images with closed forms, for every lobe, solid, medium or
# stack of panes, the ones that explain samples or apply every kind of edit, the coverage of error estimates, those that check all
# built-in programs or programs with a mistake of each kind, and thousands of random inputs. 'make test' leaves them to
# `make test SUITES=long`.
set(QUINTET_LONG_SUITES api.ApiExplanation
  gpu.AnisotropyRender gpu.Aov gpu.BsdfAlbedo gpu.BsdfFurnace gpu.BsdfLobes gpu.BsdfReference gpu.BsdfSampling gpu.CameraInMedium
  gpu.Csg gpu.DiffuseTransmission gpu.DispersionRender gpu.ErrorEstimate gpu.ExplainedPrograms gpu.Instrument
  gpu.IridescenceRender gpu.LampBehindABubble gpu.LampBehindPanes gpu.LampInABubble gpu.LightTreeDevice gpu.NestedMedia
  gpu.OpenMedium gpu.PixelExplainer gpu.ProgramDraft gpu.Scattering gpu.SessionEdits gpu.SessionExplains
  gpu.SheenRender gpu.SolidAlpha gpu.SolidFarSide gpu.SolidGlass gpu.SolidLight gpu.Solids gpu.TriangleLight
  unit.BuiltInPrograms unit.CheckBuiltIn unit.EngineShaders unit.ExplainedProgram unit.ExplainHooks unit.ForeignModules
  unit.GltfFuzz unit.LectureFuzz unit.LibraryMutation unit.Mistakes unit.ModuleCheck unit.Procedural
  unit.ProgramFuzz unit.UntilError)

# Those that would take minutes of CI each, and whose code other suites cover.
set(QUINTET_NIGHTLY_SUITES gpu.PaneWeights unit.Mutation)

# Suites that measure the time of a launch and therefore run alone.
set(QUINTET_SERIAL_SUITES gpu.GpuSubmissions gpu.GpuTimer)

# CTest starts the longest suites first, but has no times in a new clone. These are the seconds of suites above ten
# seconds on four cores without a GPU.
set(QUINTET_SUITE_COSTS
  gpu.PaneWeights 70 gpu.SolidAlpha 50 gpu.SolidLight 50 gpu.Aov 40 gpu.Renderer 40
  gpu.BsdfSampling 30 gpu.SolidFarSide 25 gpu.TriangleLight 25 gpu.LampBehindPanes 22 gpu.ErrorEstimate 22
  gpu.LightTreeDevice 20 gpu.Instrument 17 gpu.BsdfFurnace 15 gpu.SolidGlass 15 gpu.Csg 13 gpu.Furnace 11
  gpu.SolidLamp 10
  unit.Mistakes 60 unit.Idioms 30 unit.Mutation 30 unit.LibraryMutation 30 unit.CheckBuiltIn 25 unit.BuiltInPrograms 20
)

# Sets OUT to the seconds of an entry of QUINTET_SUITE_COSTS; 0 if it is missing.
function(quintet_suite_cost OUT NAME)
  list(FIND QUINTET_SUITE_COSTS ${NAME} index)
  set(cost 0)
  if(NOT index EQUAL -1)
    math(EXPR index "${index} + 1")
    list(GET QUINTET_SUITE_COSTS ${index} cost)
  endif()
  set(${OUT} ${cost} PARENT_SCOPE)
endfunction()

# Adds the entries and sets OUT to their names.
function(quintet_add_suite_tests OUT TARGET LABEL TIMEOUT)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${ARGN})
  if(QUINTET_SANITIZE)
    math(EXPR TIMEOUT "4 * ${TIMEOUT}")
  endif()
  foreach(source IN LISTS ARGN)
    set(layer)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    if(path MATCHES "^([a-z_]+)/")
      set(layer layer-${CMAKE_MATCH_1})
    endif()
    file(STRINGS ${source} lines REGEX "^(TYPED_)?TEST(_F|_P)?\\(")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[A-Z_]+\\( *([A-Za-z0-9_]+).*" "\\1" suite "${line}")
      list(APPEND suites ${suite})
      list(APPEND layers_${suite} ${layer})
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES suites)
  foreach(suite IN LISTS suites)
    set(name ${LABEL}.${suite})
    list(APPEND names ${name})
    quintet_suite_cost(cost ${name})
    add_test(NAME ${name} COMMAND ${TARGET} --gtest_filter=${suite}.*:*/${suite}.*:${suite}/*)
    list(REMOVE_DUPLICATES layers_${suite})
    set_tests_properties(${name} PROPERTIES LABELS "${LABEL};${layers_${suite}}" TIMEOUT ${TIMEOUT} COST ${cost})
    if(name IN_LIST QUINTET_LONG_SUITES)
      set_property(TEST ${name} APPEND PROPERTY LABELS long)
    elseif(name IN_LIST QUINTET_NIGHTLY_SUITES)
      set_property(TEST ${name} APPEND PROPERTY LABELS nightly)
    endif()
  endforeach()
  set(${OUT} ${names} PARENT_SCOPE)
endfunction()

function(quintet_add_host_suites TARGET LABEL TIMEOUT)
  quintet_add_suite_tests(names ${TARGET} ${LABEL} ${TIMEOUT} ${ARGN})
endfunction()

function(quintet_add_suites TARGET LABEL TIMEOUT)
  quintet_add_suite_tests(names ${TARGET} ${LABEL} ${TIMEOUT} ${ARGN})
  foreach(name IN LISTS names)
    set_tests_properties(${name} PROPERTIES ENVIRONMENT "QUINTET_VALIDATE=1;LP_NUM_THREADS=4"
      PROCESSORS ${QUINTET_DEVICE_JOBS})
    if(LABEL IN_LIST QUINTET_UNOPTIMIZED_LABELS AND NOT name IN_LIST QUINTET_OPTIMIZED_SUITES)
      set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT GALLIVM_PERF=nopt)
    endif()
    if(name STREQUAL gpu.GpuContext)  # tests the variables that the library sets for lavapipe
      set_tests_properties(${name} PROPERTIES ENVIRONMENT QUINTET_VALIDATE=1)
    endif()
    if(name IN_LIST QUINTET_SERIAL_SUITES)
      set_tests_properties(${name} PROPERTIES RUN_SERIAL ON)
    endif()
  endforeach()
endfunction()
