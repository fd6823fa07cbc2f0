# SPDX-License-Identifier: Apache-2.0
# Builds the page of WEB into the folder OUT, and then writes STAMP. If npm cannot install the packages, for example without
# a network, the folder stays empty, the build continues, and the server shows what is missing.
set(installed ${WEB}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${WEB}/package-lock.json IS_NEWER_THAN ${installed})
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error --fetch-retries=1 --fetch-timeout=60000 WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
  if(failed)
    message(WARNING "The page of the lab is not built: 'npm ci' failed in ${WEB}")
    file(REMOVE_RECURSE ${OUT})
    file(TOUCH ${STAMP})
    return()
  endif()
endif()
file(REMOVE_RECURSE ${OUT})
execute_process(COMMAND ${NPM} run --silent build -- --outdir ${OUT} WORKING_DIRECTORY ${WEB} RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "The page of the lab does not build; to see why, run 'npm run build' in ${WEB}")
endif()
file(TOUCH ${STAMP})
