# Libraries that only the benchmarks use, all optional. Sets ED3R_BENCH_<PEER> to what to link, or leaves it empty.

find_library(ED3R_OPENBLAS_LIBRARY openblas)
find_path(ED3R_OPENBLAS_INCLUDE openblas_config.h PATH_SUFFIXES openblas-pthread openblas-openmp openblas-serial openblas)
if(ED3R_OPENBLAS_LIBRARY AND ED3R_OPENBLAS_INCLUDE)
  add_library(ed3r_bench_openblas INTERFACE)
  target_include_directories(ed3r_bench_openblas SYSTEM INTERFACE "${ED3R_OPENBLAS_INCLUDE}")
  target_link_libraries(ed3r_bench_openblas INTERFACE "${ED3R_OPENBLAS_LIBRARY}")
  set(ED3R_BENCH_OPENBLAS ed3r_bench_openblas)
endif()

set(ED3R_BENCH_ONEDNN ed3r_onednn)

find_package(Torch QUIET)
if(Torch_FOUND)
  add_library(ed3r_bench_torch INTERFACE)
  target_include_directories(ed3r_bench_torch SYSTEM INTERFACE ${TORCH_INCLUDE_DIRS})
  target_link_libraries(ed3r_bench_torch INTERFACE ${TORCH_LIBRARIES})
  set(ED3R_BENCH_TORCH ed3r_bench_torch)
endif()

foreach(peer OPENBLAS ONEDNN TORCH)
  if(NOT ED3R_BENCH_${peer})
    message(STATUS "Benchmark peer ${peer}: not found, will be skipped (optional)")
  endif()
endforeach()
