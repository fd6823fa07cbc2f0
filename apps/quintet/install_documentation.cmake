# SPDX-License-Identifier: Apache-2.0
# Installs the man pages and the completions of shells, which the binary prints from its tables of options. Runs during
# 'cmake --install' with QUINTET (the binary), FOLDER (for the files), MAN and DATA (relative or absolute folders).
function(quintet_generate FILE)
  execute_process(COMMAND ${QUINTET} help ${ARGN} OUTPUT_FILE ${FOLDER}/${FILE} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(quintet_install_file FILE DESTINATION)
  cmake_path(ABSOLUTE_PATH DESTINATION BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX})
  file(INSTALL ${FOLDER}/${FILE} DESTINATION ${DESTINATION})
endfunction()

file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${QUINTET} help --commands OUTPUT_VARIABLE commands OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" commands "${commands}")
quintet_generate(quintet.1 --man)
quintet_install_file(quintet.1 ${MAN}/man1)
foreach(command IN LISTS commands)
  quintet_generate(quintet-${command}.1 --man ${command})
  quintet_install_file(quintet-${command}.1 ${MAN}/man1)
endforeach()
quintet_generate(quintet --completion bash)
quintet_install_file(quintet ${DATA}/bash-completion/completions)
quintet_generate(_quintet --completion zsh)
quintet_install_file(_quintet ${DATA}/zsh/site-functions)
quintet_generate(quintet.fish --completion fish)
quintet_install_file(quintet.fish ${DATA}/fish/vendor_completions.d)
