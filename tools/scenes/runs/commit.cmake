# cmake -DSOURCE=<tree> -DHEADER=<file> -P commit.cmake
# Writes the commit of the tree, with -dirty if it has changes, or "unknown" without git.
find_program(git git)
set(commit "")
if(git)
  execute_process(COMMAND ${git} --no-optional-locks -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(commit STREQUAL "")
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define PLUMB_COMMIT \"${commit}\"\n")
