# WebAssembly with vectors of 128 bits, by Emscripten. Programs run in Node.js and read files where it runs.
set(PLUMB_EMSCRIPTEN /usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake CACHE FILEPATH
    "Emscripten's own toolchain file")
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)  # libraries of headers alone are those of the machine that compiles
include(${PLUMB_EMSCRIPTEN})
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -fexceptions -include ${CMAKE_CURRENT_LIST_DIR}/libcxx14.hpp")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fexceptions -sALLOW_MEMORY_GROWTH -sNODERAWFS")
