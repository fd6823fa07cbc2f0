# Installs Quintet into an empty folder, and builds and runs examples/cpp against it, as a user would:
#   cmake -DBUILD=… -DSOURCE=… -DMAKE_SCENES=… -P run.cmake
set(work ${BUILD}/tests/install-test)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${work} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  message(STATUS "${ARGV}\n${output}")
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/examples/cpp -B ${work}/build -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${MAKE_SCENES} ${work})
run(${work}/build/first_ray normals ${work}/cornell.glb)
run(${work}/prefix/bin/quintet info first_ray.png)
if(NOT EXISTS ${work}/first_ray.png)
  message(FATAL_ERROR "no picture")
endif()
# An error is one line and exit status 1.
execute_process(COMMAND ${work}/build/first_ray normals ${work}/absent.glb WORKING_DIRECTORY ${work} RESULT_VARIABLE status
                ERROR_VARIABLE output)
if(NOT status EQUAL 1 OR NOT output MATCHES "^first_ray: .*absent.glb[^\n]*\n$")
  message(FATAL_ERROR "status ${status}: ${output}")
endif()
