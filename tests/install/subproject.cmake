# SPDX-License-Identifier: Apache-2.0
# Quintet inside another project: add_subdirectory() with a static library, which runs; then its installation, with CMake and
# with pkg-config.
#   cmake -DBUILD=… -DSOURCE=… -DCXX=… -P subproject.cmake
cmake_minimum_required(VERSION 3.25)
set(work ${BUILD}/tests/subproject-test)
file(REMOVE_RECURSE ${work}/prefix ${work}/consumer)  # the objects are kept
file(MAKE_DIRECTORY ${work})

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${work} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
  message(STATUS "${ARGV}\n${output}")
endfunction()

file(WRITE ${work}/app.cpp "#include <quintet/quintet.h>
int main() {
  try {
    quintet::prepareDrivers();
    quintet::Device device;
    quintet::Scene scene;
    quintet::Renderer renderer(device, scene, quintet::Program::load(\"normals\"), {.width = 8, .height = 8});
    renderer.render(4);
    return renderer.image().at(4, 4)[3] >= 0 ? 0 : 2;
  } catch (const quintet::Error&) {
    return 1;
  }
}
")
file(WRITE ${work}/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(parent CXX)
set(BUILD_SHARED_LIBS OFF)
add_subdirectory(\${QUINTET_FOLDER} quintet)
add_executable(app app.cpp)
target_link_libraries(app PRIVATE quintet::quintet)
")
run(${CMAKE_COMMAND} -S ${work} -B ${work}/build -G Ninja -DQUINTET_FOLDER=${SOURCE} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX} -DQUINTET_INSTALL=ON -DQUINTET_SHIPPED_SHADERS=OFF)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/app)
if(EXISTS ${work}/build/quintet/bin/quintet)
  message(FATAL_ERROR "a project gets only the library by default")
endif()

run(${CMAKE_COMMAND} --install ${work}/build --prefix ${work}/prefix)
file(WRITE ${work}/consumer/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(consumer CXX)
find_package(quintet 0.1 REQUIRED)
add_executable(consumer ../app.cpp)
target_link_libraries(consumer PRIVATE quintet::quintet)
")
run(${CMAKE_COMMAND} -S ${work}/consumer -B ${work}/consumer/build -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_CXX_COMPILER=${CXX})
run(${CMAKE_COMMAND} --build ${work}/consumer/build)
run(${work}/consumer/build/consumer)
run(sh -c "${CXX} -std=c++20 app.cpp -o linked $(PKG_CONFIG_PATH=${work}/prefix/lib/pkgconfig pkg-config --cflags --libs quintet)")
run(${work}/linked)
