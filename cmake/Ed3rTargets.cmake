# One target per folder, all with the same rules.

add_library(ed3r_rules INTERFACE)
# -ffp-contract=off: a compiler that fuses where it likes would make results depend on the build.
target_compile_options(ed3r_rules INTERFACE -Wall -Wextra -Wpedantic -ffp-contract=off -fno-math-errno
  $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
target_include_directories(ed3r_rules INTERFACE "${CMAKE_SOURCE_DIR}")
if(ED3R_WERROR)
  target_compile_options(ed3r_rules INTERFACE -Werror)
endif()
if(ED3R_SANITIZE)
  target_compile_options(ed3r_rules INTERFACE "-fsanitize=${ED3R_SANITIZE}" -fno-omit-frame-pointer)
  target_link_options(ed3r_rules INTERFACE "-fsanitize=${ED3R_SANITIZE}")
endif()
if(ED3R_COVERAGE)
  target_compile_options(ed3r_rules INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(ed3r_rules INTERFACE --coverage)
endif()

# What a test is compiled with, for building in release: a third of the whole build otherwise; what the tests call is built as
# everybody flies it.
set(ED3R_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)

if(NOT ED3R_FUZZ)
  ed3r_header_set(ed3r_text_headers HEADERS ${ED3R_TEXT_HEADERS} DEPS fmt::fmt)
  ed3r_header_set(ed3r_json_headers HEADERS ${ED3R_JSON_HEADERS} DEPS fmt::fmt nlohmann_json::nlohmann_json)
  ed3r_header_set(ed3r_program_headers HEADERS ${ED3R_JSON_HEADERS} DEPS fmt::fmt nlohmann_json::nlohmann_json PIE)
endif()
if(ED3R_TESTS)
  ed3r_header_set(ed3r_test_headers HEADERS ${ED3R_TEST_HEADERS} DEPS fmt::fmt GTest::gtest_main
    OPTIONS ${ED3R_TEST_OPTIONS} PIE)
endif()

# ed3r_library(NAME SOURCES a.cc ... DEPS targets ... [HEADERS set|none]): a static library of one folder.
function(ed3r_library name)
  cmake_parse_arguments(ARG "" "HEADERS" "SOURCES;DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC ed3r_rules ${ARG_DEPS})
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS ed3r_text_headers)
  endif()
  if(NOT ARG_HEADERS STREQUAL none)
    ed3r_reads_precompiled(${name} ${ARG_HEADERS})
  endif()
endfunction()

# ed3r_test(NAME SOURCES a_test.cc ... DEPS targets ... [APART suites ...]): a GoogleTest program, one CTest entry per folder of
# tests; each suite that stands APART is an entry of its own, NAME_SUITE, so that long ones run side by side. PLAIN: without
# precompiled headers.
function(ed3r_test name)
  cmake_parse_arguments(ARG "PLAIN" "TIMEOUT" "SOURCES;DEPS;APART" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ed3r_rules ${ARG_DEPS} GTest::gtest_main)
  target_compile_options(${name} PRIVATE ${ED3R_TEST_OPTIONS})
  if(NOT ARG_PLAIN)
    ed3r_reads_precompiled(${name} ed3r_test_headers)
  endif()
  target_compile_definitions(${name} PRIVATE
    ED3R_SOURCE_DIR="${CMAKE_SOURCE_DIR}" ED3R_BINARY="${CMAKE_BINARY_DIR}/ed3r")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  if(ED3R_COVERAGE)
    set(ARG_TIMEOUT 3600)
    target_compile_definitions(${name} PRIVATE ED3R_COVERAGE)
  endif()
  set(others "")
  foreach(suite ${ARG_APART})
    add_test(NAME ${name}_${suite} COMMAND ${name} "--gtest_filter=${suite}.*" WORKING_DIRECTORY "${CMAKE_BINARY_DIR}")
    set_tests_properties(${name}_${suite} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
    string(APPEND others ":${suite}.*")
  endforeach()
  if(others)
    string(SUBSTRING "${others}" 1 -1 others)
    set(others "--gtest_filter=-${others}")
  endif()
  add_test(NAME ${name} COMMAND ${name} ${others} WORKING_DIRECTORY "${CMAKE_BINARY_DIR}")
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()
