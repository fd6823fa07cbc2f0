# SPDX-License-Identifier: Apache-2.0
# quintet_test_layer(NAME SOURCE DESCRIPTION)
#
# Adds the Vulkan layer VK_LAYER_QUINTET_<NAME> for tests: the target quintet_<NAME>, and its manifest NAME.json in the current
# binary folder.
function(quintet_test_layer name source description)
  add_library(quintet_${name} MODULE ${source})
  # The loader looks for one exported function. Headers only: the layer must not call the Vulkan loader.
  target_link_libraries(quintet_${name} PRIVATE quintet_flags Vulkan::Headers)
  target_include_directories(quintet_${name} PRIVATE ${PROJECT_SOURCE_DIR}/layer)  # loader_interface.h
  set_target_properties(quintet_${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden)
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.json CONTENT "{
  \"file_format_version\": \"1.2.0\",
  \"layer\": {
    \"name\": \"VK_LAYER_QUINTET_${name}\",
    \"type\": \"GLOBAL\",
    \"library_path\": \"$<TARGET_FILE:quintet_${name}>\",
    \"api_version\": \"1.3.0\",
    \"implementation_version\": \"1\",
    \"description\": \"${description}\"
  }
}
")
endfunction()
