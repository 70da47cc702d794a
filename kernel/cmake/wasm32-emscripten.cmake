# WebAssembly with vectors of 128 bits, by Emscripten. Programs run in Node.js and read files where it runs.
set(PLUMB_EMSCRIPTEN /usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake CACHE FILEPATH
    "Emscripten's own toolchain file")
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)  # libraries of headers alone are those of the machine that compiles
include(${PLUMB_EMSCRIPTEN})
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -fwasm-exceptions -include ${CMAKE_CURRENT_LIST_DIR}/libcxx14.hpp")
# Programs are linked at -O1: what binaryen would do beyond that takes minutes, and needs acorn, which other builds of
# Node.js than Debian's do not find. They are compiled at once, since this Emscripten fetches, as of the web, what new
# versions of Node.js have in files.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-O1 -fwasm-exceptions -sALLOW_MEMORY_GROWTH -sNODERAWFS -sWASM_ASYNC_COMPILATION=0")
