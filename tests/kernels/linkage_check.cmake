# cmake -DNM=nm "-DOBJECTS=a.o|b.o" -P linkage_check.cmake
#
# An inline function or template that an instruction-set source emits as a weak symbol can be the copy that the
# linker keeps for the whole program, which then dies on an older CPU. The level_* objects must define one
# strong symbol each, their table of kernels, and no weak ones.
string(REPLACE "|" ";" objects "${OBJECTS}")
set(checked 0)
foreach(object IN LISTS objects)
  if(NOT object MATCHES "/level_[a-z0-9_]+\\.cc\\.o")
    continue()
  endif()
  execute_process(COMMAND ${NM} -C --defined-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[^\n]* [WVu] [^\n]*" weak "${symbols}")
  if(weak)
    message(FATAL_ERROR "${object} defines weak symbols:\n${weak}")
  endif()
  string(REGEX MATCHALL "[^\n]* [TBDR] [^\n]*" strong "${symbols}")
  list(LENGTH strong count)
  if(NOT count EQUAL 1 OR NOT strong MATCHES "Kernels\\(\\)")
    message(FATAL_ERROR "${object} should define its table of kernels only:\n${strong}")
  endif()
  math(EXPR checked "${checked} + 1")
endforeach()
if(checked EQUAL 0)
  message(FATAL_ERROR "no level_* object among: ${objects}")
endif()
message(STATUS "${checked} objects are clean")
