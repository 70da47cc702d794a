# A shared plumb exports its interface and nothing of how it works.
#   cmake -DNM=... -DLIBRARY=... -DSANITIZE=... -P exports_test.cmake
execute_process(COMMAND ${NM} --dynamic --defined-only --demangle ${LIBRARY} OUTPUT_VARIABLE output
                COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE ";" "," output "${output}")  # or a name would be two
string(REGEX MATCHALL "[^\n]+" symbols "${output}")
set(own 0)
foreach(symbol IN LISTS symbols)
  if(symbol MATCHES " plumb::detail::register_method\\(")
    continue()  # what plumb::reference is plugged in by
  elseif(symbol MATCHES " W std::operator==\\(std::_Rb_tree_(const_)?iterator<")
    continue()  # which clang shows of hidden types, too
  elseif(symbol MATCHES "plumb::(detail|simd|layouts)::|::Impl::|Eigen::|tbb::|xsimd::")
    message(FATAL_ERROR "exported, but internal: ${symbol}")
  elseif(symbol MATCHES "plumb::")
    math(EXPR own "${own} + 1")
  elseif(SANITIZE AND symbol MATCHES " V typeinfo (name )?for ")
    continue()  # of the language's own types
  elseif(NOT symbol MATCHES "std::|__gnu_cxx::|operator new\\(unsigned long, void\\*\\)")  # the standard library's, weak everywhere
    message(FATAL_ERROR "exported, but not plumb's: ${symbol}")
  endif()
endforeach()
list(LENGTH symbols count)
message("${count} symbols exported, ${own} of them plumb's, the others of the standard library")
if(NOT output MATCHES "typeinfo for plumb::InputError" OR own LESS 50)
  message(FATAL_ERROR "the interface is missing")
endif()
