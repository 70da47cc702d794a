# Builds a shared plumb, without its programs, for the tests of what it installs. What it shows and where it is found
# does not depend on optimisation, nor on what debuggers read, which are most of the time that a compiler takes. Or it is
# linked from objects of another build, which a sanitizer may have instrumented.
#   cmake -DTREE=... -DBUILD=... -DCOMPILER=... -DLAUNCHER=... -DGENERATOR=... -DFLAGS=... -DTBB=ON
#         -DOBJECTS_OF=... -DSANITIZE=... -P shared_build.cmake
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${TREE} -B ${BUILD} -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=
          -DBUILD_SHARED_LIBS=ON
          -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_CXX_FLAGS=${FLAGS}
          -DPLUMB_TBB=${TBB} -DPLUMB_OBJECTS_OF=${OBJECTS_OF} -DPLUMB_SANITIZE=${SANITIZE} -DPLUMB_ISAS=scalar -DPLUMB_LARGE_UNITS=ON -DPLUMB_BUILD_TOOLS=OFF -DPLUMB_BUILD_TESTS=OFF -DPLUMB_BUILD_BENCH=OFF
          --log-level=WARNING
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --parallel 2 COMMAND_ERROR_IS_FATAL ANY)
