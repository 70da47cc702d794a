# Files compiled for one instruction set define their tables and nothing else that other files could see. A weak symbol (an
# inline function or a template that was not inlined) is the dangerous kind: the linker keeps one copy for everybody,
# and a machine without that instruction set dies in code that has nothing to do with it.
#   cmake -DNM=... -DOBJECTS=a.o;b.o -P symbols_test.cmake
set(seen)
foreach(object IN LISTS OBJECTS)
  if(NOT object MATCHES "/simd/[^/]+/([^/]+)\\.cpp\\.o$")
    continue()
  endif()
  string(REGEX REPLACE "^.*/simd/[^/]+/([^/]+)\\.cpp\\.o$" "\\1" isa ${object})
  list(APPEND seen ${isa})
  execute_process(COMMAND ${NM} --defined-only --extern-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]+" lines "${symbols}")
  set(tables 0)
  foreach(line IN LISTS lines)
    if(line MATCHES " V DW\\.ref\\.__gxx_personality_v0$")
      continue()  # a pointer, not code: the same in every file
    endif()
    if(line MATCHES "^[0-9a-f]+ [A-Z] _ZN5plumb4simd[0-9]+${isa}(_float|_double)?E$")
      math(EXPR tables "${tables} + 1")
    else()
      message(FATAL_ERROR "${object} defines a symbol that others can see: ${line}")
    endif()
  endforeach()
  set(wanted 2)  # one for float, one for double
  if(isa MATCHES "^(front|kkt)_")
    set(wanted 1)  # these are of double alone
  endif()
  if(NOT tables EQUAL wanted)
    message(FATAL_ERROR "${object}: ${tables} tables instead of ${wanted}")
  endif()
endforeach()
list(FIND seen relax_scalar at)
if(at EQUAL -1)
  message(FATAL_ERROR "no file of the scalar instruction set among the objects, but of: ${seen}")
endif()
