# Precompiled headers: reading the same standard headers is most of what compiling one file costs. They hold headers of the
# system only, so that no edit here builds everything again; every file still includes what it uses and compiles without
# (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON). A set is no larger than pays: mapping its file costs time in each file too, which is
# why Eigen is in none. Not with clang, which only the fuzzers are built with.
set(ED3R_TEXT_HEADERS <algorithm> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional> <set> <span>
  <string> <string_view> <utility> <vector> <fmt/format.h>)
set(ED3R_JSON_HEADERS ${ED3R_TEXT_HEADERS} <nlohmann/json.hpp>)
set(ED3R_TEST_HEADERS ${ED3R_TEXT_HEADERS} <gtest/gtest.h>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  set(ED3R_PRECOMPILED ON)
endif()

# ed3r_header_set(NAME HEADERS <a> ... DEPS targets ... [OPTIONS ...] [PIE]): the headers compiled once without OpenMP (NAME) and
# once with it (NAME_openmp), where a target reads them. A target may read them only if its own options agree (-O, -fPIC or
# -fPIE, what OpenMP defines); where they do not, the compiler warns of it.
function(ed3r_header_set name)
  cmake_parse_arguments(ARG "PIE" "" "HEADERS;DEPS;OPTIONS" ${ARGN})
  if(NOT ED3R_PRECOMPILED)
    return()
  endif()
  foreach(variant ${name} ${name}_openmp)
    set(source "${CMAKE_BINARY_DIR}/${variant}.cc")
    file(CONFIGURE OUTPUT "${source}" CONTENT "")
    add_library(${variant} OBJECT EXCLUDE_FROM_ALL "${source}")
    target_link_libraries(${variant} PRIVATE ed3r_rules ${ARG_DEPS})
    target_compile_options(${variant} PRIVATE ${ARG_OPTIONS})
    if(ARG_PIE)
      set_target_properties(${variant} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
      target_compile_options(${variant} PRIVATE -fPIE)
    endif()
    target_precompile_headers(${variant} PRIVATE ${ARG_HEADERS})
  endforeach()
  target_link_libraries(${name}_openmp PRIVATE OpenMP::OpenMP_CXX)
endfunction()

# ed3r_links(TARGET LIBRARY OUT): whether TARGET links LIBRARY, through others too.
function(ed3r_links target library out)
  set(${out} OFF PARENT_SCOPE)
  set(ahead ${target})
  set(seen "")
  while(ahead)
    list(POP_FRONT ahead next)
    if(next STREQUAL library)
      set(${out} ON PARENT_SCOPE)
      return()
    elseif(TARGET ${next} AND NOT next IN_LIST seen)
      list(APPEND seen ${next})
      get_target_property(linked ${next} INTERFACE_LINK_LIBRARIES)
      if(next STREQUAL target)
        get_target_property(linked ${next} LINK_LIBRARIES)
      endif()
      if(linked)
        list(APPEND ahead ${linked})
      endif()
    endif()
  endwhile()
endfunction()

# ed3r_reads_precompiled(TARGET NAME): TARGET, which has its libraries already, reads the headers of that set compiled.
function(ed3r_reads_precompiled target name)
  if(NOT ED3R_PRECOMPILED)
    return()
  endif()
  ed3r_links(${target} OpenMP::OpenMP_CXX openmp)
  if(openmp)
    string(APPEND name _openmp)
  endif()
  target_compile_options(${target} PRIVATE -fpch-preprocess)  # without it ccache cannot keep what is compiled so
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 takes the space for short texts inside a std::string for the whole text where <string> is precompiled.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
  target_precompile_headers(${target} REUSE_FROM ${name})
endfunction()
