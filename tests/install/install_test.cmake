# Installs the build into a fresh prefix, then configures, builds and runs a program of another project against it.
#   cmake -DBUILD=... -DSCRATCH=... -DUSER=kernel_user -DSOURCES=... -DCOMPILER=... -DFLAGS=... -P install_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCES}/${USER} -B ${SCRATCH}/build -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/${USER})

# Nothing that was installed may lean on the tree it was built from.
file(GLOB_RECURSE installed ${SCRATCH}/prefix/*.cmake ${SCRATCH}/prefix/*.hpp)
if(installed STREQUAL "")
  message(FATAL_ERROR "nothing was installed")
endif()
foreach(file IN LISTS installed)
  file(READ ${file} text)
  foreach(place IN ITEMS ${BUILD} ${TREE})
    # Not lib/cmake/plumb/, where the tree is /plumb.
    string(REGEX REPLACE "([][+.*()^$?|\\\\])" "\\\\\\1" literal "${place}")
    if(text MATCHES "(^|[^A-Za-z0-9_.}])${literal}/")
      message(FATAL_ERROR "${file} names ${place}")
    endif()
  endforeach()
endforeach()
