# Builds portable_hashes by a toolchain file and runs rows of the golden table with it. It says that it was left out
# where a program that it needs is missing.
#   cmake -DTREE=... -DBUILD=... -DTOOLCHAIN=... -DNEEDS=program;program -DLAUNCHER=... -P portable_test.cmake
foreach(program IN LISTS NEEDS)
  find_program(found_${program} ${program})
  if(NOT found_${program})
    message("left out: ${program} is missing, see tools/setup --ports")
    return()
  endif()
endforeach()
set(options -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DPLUMB_TBB=OFF -DPLUMB_BUILD_TOOLS=OFF
            -DPLUMB_BUILD_TESTS=OFF -DPLUMB_BUILD_BENCH=OFF -DPLUMB_BUILD_PORTABLE=ON)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${TREE} -B ${BUILD} --toolchain ${TOOLCHAIN} ${options}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} -j2 --target run_portable_hashes COMMAND_ERROR_IS_FATAL ANY
                OUTPUT_QUIET)
