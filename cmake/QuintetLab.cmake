# SPDX-License-Identifier: Apache-2.0
# QUINTET_LAB decides whether the lab is built: ON, OFF, or AUTO (if the headers of Boost are installed). If it is, the
# target quintet_boost has Boost.Asio and Boost.Beast.
set(QUINTET_LAB AUTO CACHE STRING "Build the lab, quintet-lab: ON, OFF or AUTO")
set_property(CACHE QUINTET_LAB PROPERTY STRINGS AUTO ON OFF)

if(NOT QUINTET_LAB STREQUAL OFF)
  find_path(QUINTET_BOOST_INCLUDE_DIR boost/beast/websocket.hpp)
  find_package(Threads REQUIRED)
  if(QUINTET_BOOST_INCLUDE_DIR)
    add_library(quintet_boost INTERFACE)
    target_include_directories(quintet_boost SYSTEM INTERFACE ${QUINTET_BOOST_INCLUDE_DIR})
    # Only headers of Boost are used. Nothing in the lab resolves names or uses other executors.
    target_compile_definitions(quintet_boost INTERFACE BOOST_ERROR_CODE_HEADER_ONLY BOOST_ASIO_NO_DEPRECATED)
    target_link_libraries(quintet_boost INTERFACE Threads::Threads)
  elseif(QUINTET_LAB STREQUAL AUTO)
    message(STATUS "quintet-lab is not built: the headers of Boost are missing (scripts/setup.sh lab)")
  else()
    message(FATAL_ERROR "QUINTET_LAB=ON requires the headers of Boost: run scripts/setup.sh lab")
  endif()
endif()
