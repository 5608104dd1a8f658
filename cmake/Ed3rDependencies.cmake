# Debian 12 packages; scripts/setup installs them.

if(NOT ED3R_FUZZ)  # clang's OpenMP is a package of its own, and no reader uses it
  find_package(OpenMP REQUIRED)
endif()
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(Bullet REQUIRED)
find_package(Ceres REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(fmt REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(GDAL 3.6 REQUIRED)  # the first that can be told to pass over its environment
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(embree 3 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
if(ED3R_TESTS)
  find_package(GTest)
  if(NOT GTest_FOUND)
    message(STATUS "GoogleTest is not installed (scripts/setup --tests): the tests are left out")
    set(ED3R_TESTS OFF)
  endif()
endif()

# Bullet ships variables, not targets: wrap them once, as system headers.
add_library(ed3r_bullet INTERFACE)
target_include_directories(ed3r_bullet SYSTEM INTERFACE ${BULLET_INCLUDE_DIRS})
target_link_libraries(ed3r_bullet INTERFACE BulletDynamics BulletCollision LinearMath)

add_library(ed3r_opencv INTERFACE)
# Debian ships OpenCV's CMake package only with all of its modules; the few that are used are found by name.
find_path(ED3R_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
target_include_directories(ed3r_opencv SYSTEM INTERFACE ${ED3R_OPENCV_INCLUDE})
foreach(module core imgproc imgcodecs)
  find_library(ED3R_OPENCV_${module} opencv_${module} REQUIRED)
  target_link_libraries(ed3r_opencv INTERFACE ${ED3R_OPENCV_${module}})
endforeach()

# Debian's CMake package of oneDNN asks for OpenCL; the CPU library does not need it.
find_library(ED3R_ONEDNN_LIBRARY dnnl REQUIRED)
find_path(ED3R_ONEDNN_INCLUDE dnnl.hpp REQUIRED)
add_library(ed3r_onednn INTERFACE)
target_include_directories(ed3r_onednn SYSTEM INTERFACE "${ED3R_ONEDNN_INCLUDE}")
target_link_libraries(ed3r_onednn INTERFACE "${ED3R_ONEDNN_LIBRARY}" OpenMP::OpenMP_CXX)

# The network runner of OpenCV apart from the rest: only users' own detectors need it.
find_library(ED3R_OPENCV_dnn opencv_dnn REQUIRED)
add_library(ed3r_opencv_dnn INTERFACE)
target_link_libraries(ed3r_opencv_dnn INTERFACE ed3r_opencv "${ED3R_OPENCV_dnn}")

# Films of missions (ed3r replay --video): the program alone needs it.
find_library(ED3R_OPENCV_videoio opencv_videoio REQUIRED)
add_library(ed3r_opencv_video INTERFACE)
target_link_libraries(ed3r_opencv_video INTERFACE ed3r_opencv "${ED3R_OPENCV_videoio}")
