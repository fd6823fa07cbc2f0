# SPDX-License-Identifier: Apache-2.0
# Installs Quintet into an empty folder, then builds and runs examples/cpp and consumer/ with the installed package:
#   cmake -DBUILD=… -DSOURCE=… -P run.cmake
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
foreach(file IN ITEMS LICENSE README.md CONTRIBUTING.md THIRD-PARTY-NOTICES.txt programs/pathtracer/program.toml docs/README.md docs/cli.md docs/diagnostics/Q101.md docs/images/demo.png)
  if(NOT EXISTS ${work}/prefix/share/doc/quintet/${file})
    message(FATAL_ERROR "not installed: share/doc/quintet/${file}")
  endif()
endforeach()
run(bash ${SOURCE}/tests/style/links ${work}/prefix/share/doc/quintet)
# The manifest of the layer names the library relative to itself.
file(GLOB manifest ${work}/prefix/share/vulkan/explicit_layer.d/VkLayer_quintet_link_check.json)
file(READ "${manifest}" text)
string(JSON library GET "${text}" layer library_path)
if(NOT EXISTS ${work}/prefix/share/vulkan/explicit_layer.d/${library})
  message(FATAL_ERROR "not installed: ${library}")
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/examples/cpp -B ${work}/build -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${work}/build)
foreach(example IN ITEMS first_ray mesh_from_memory animated_instances own_program error_target explain_pixel)
  file(STRINGS ${SOURCE}/examples/cpp/${example}.cpp lines)
  list(LENGTH lines count)
  if(count GREATER 60)
    message(FATAL_ERROR "examples/cpp/${example}.cpp has ${count} lines; an example has at most 60")
  endif()
  run(${work}/build/${example})
endforeach()
foreach(image IN ITEMS mesh_from_memory.png animated_instances_0.png animated_instances_3.png own_program_1.png
        own_program_8.png layers.exr error_target.png)
  run(${work}/prefix/bin/quintet info ${image})
endforeach()
run(${work}/prefix/bin/quintet info first_ray.png)
# The command-line program must explain the same sample.
run(${work}/prefix/bin/quintet explain-pixel --program pathtracer --size 240x160 --pixel 120,100 --spp 64
    --against explain_pixel.json)
# The command-line program must render the same image.
run(${work}/prefix/bin/quintet run lessons/01_first_ray -o command.png --size 480x320)
run(${work}/prefix/bin/quintet compare first_ray.png command.png --max 0)

# Other parts of the API.
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/install/consumer -B ${work}/consumer -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${work}/consumer)
run(${work}/consumer/consumer)
run(${work}/prefix/bin/quintet run lessons/19_dynamic -o frames.png --size 96x64 --frames 14)
run(${work}/prefix/bin/quintet compare animation.png frames.png --max 0)
