# SPDX-License-Identifier: Apache-2.0
# Copies the page's sources from SOURCE to WEB, builds the page there into the folder OUT, and then writes STAMP. If npm
# cannot install the packages, for example without a network, OUT stays empty, the build continues, and the server shows
# what is missing. STAMP is then missing, too, so that the next build tries again.
cmake_minimum_required(VERSION 3.25)
file(GLOB parts RELATIVE ${SOURCE} ${SOURCE}/*)
list(REMOVE_ITEM parts node_modules dist .gitignore)
list(APPEND parts .npmrc)
foreach(part IN LISTS parts)
  if(IS_DIRECTORY ${SOURCE}/${part})
    file(REMOVE_RECURSE ${WEB}/${part})  # also files that no longer exist
  endif()
  file(COPY ${SOURCE}/${part} DESTINATION ${WEB})
endforeach()

function(quintet_no_page REASON)
  message(WARNING "The page of the lab is not built: ${REASON}. Check the messages of npm above and the network; "
                  "the next build tries again")
  file(REMOVE_RECURSE ${OUT})
  file(REMOVE ${STAMP})
endfunction()

# npm writes this file last. It is older than the copied lock file if that has changed.
set(installed ${WEB}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${WEB}/package-lock.json IS_NEWER_THAN ${installed})
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error --fetch-retries=1 --fetch-timeout=60000
                  WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
  if(failed)
    file(REMOVE ${installed})  # of an earlier version
    quintet_no_page("'npm ci' failed in ${WEB}")
    return()
  endif()
  file(TOUCH ${installed})
endif()
file(REMOVE_RECURSE ${OUT})
cmake_path(GET SOURCE PARENT_PATH repository)
execute_process(COMMAND ${CMAKE_COMMAND} -E env QUINTET_SOURCE=${repository} ${NPM} run --silent build -- --outdir ${OUT}
                WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "The page of the lab does not build; to see why, run 'QUINTET_SOURCE=${repository} npm run build' in ${WEB}")
endif()
file(TOUCH ${STAMP})
