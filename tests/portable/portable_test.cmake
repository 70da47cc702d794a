# Builds a preset for another processor and runs rows of the golden table with it. It says that it was left out where a
# program that it needs is missing.
#   cmake -DTREE=... -DPRESET=... -DEVERY=N -DTARGETS=target;target -DNEEDS=program;program -DLAUNCHER=...
#         -P portable_test.cmake
foreach(program IN LISTS NEEDS)
  find_program(found_${program} ${program})
  if(NOT found_${program})
    message("left out: ${program} is missing, see tools/setup --ports")
    return()
  endif()
endforeach()
list(REMOVE_ITEM TARGETS "")
execute_process(COMMAND ${CMAKE_COMMAND} --preset ${PRESET} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
                        -DPLUMB_PORTABLE_EVERY=${EVERY}
                WORKING_DIRECTORY ${TREE} COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build --preset ${PRESET} -j2 --target ${TARGETS}
                WORKING_DIRECTORY ${TREE} COMMAND_ERROR_IS_FATAL ANY)
