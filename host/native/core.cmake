# The library greywhale_core: all of greywhale._native that knows no Python. It holds the arm, the controller core, the closed loop,
# what a candidate costs, the windows, the ideal law, outside torques and the rules of a calibration. CMakeLists.txt makes the Python module of it; the
# tests build it for another processor.
get_filename_component(REPOSITORY ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
set(NATIVE ${CMAKE_CURRENT_LIST_DIR})

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden) # nobody replaces a function of the module, so the compiler may inline it

# The processor to build for; on macOS there may be two (a universal build).
set(PROCESSOR ${CMAKE_SYSTEM_PROCESSOR})
if(APPLE AND CMAKE_OSX_ARCHITECTURES)
  set(PROCESSOR ${CMAKE_OSX_ARCHITECTURES})
endif()

file(GLOB CORE_SOURCES CONFIGURE_DEPENDS ${REPOSITORY}/sim/arm/*.cpp ${REPOSITORY}/firmware/lib/fuzzy_pdi/src/*.cpp
  ${NATIVE}/calibrate/*.cpp ${NATIVE}/closed_loop/*.cpp ${NATIVE}/ideal/*.cpp
  ${NATIVE}/observe/*.cpp ${NATIVE}/score/*.cpp ${NATIVE}/windows/*.cpp)
list(FILTER CORE_SOURCES EXCLUDE REGEX "/kernel\\.cpp$")
add_library(greywhale_core STATIC ${CORE_SOURCES})

# What the library and all that is built with it need. No contraction to fused operations: all processors shall give the same bits,
# and some compilers contract unasked.
add_library(greywhale_common INTERFACE)
target_compile_options(greywhale_common INTERFACE -ffp-contract=off -Wall -Wextra -Wconversion)
target_include_directories(greywhale_common INTERFACE
  ${NATIVE} ${REPOSITORY}/sim ${REPOSITORY}/sim/arm ${REPOSITORY}/firmware/lib/codes/src
  ${REPOSITORY}/firmware/lib/fuzzy_pdi/src ${REPOSITORY}/firmware/lib/signal_chain/src)
target_link_libraries(greywhale_core PUBLIC greywhale_common)

# The kernels, compiled once for each instruction set. The set's name is the namespace of all that these files define. So the linker
# cannot take a function of one set for that of another.
function(add_kernels SET)
  cmake_parse_arguments(KERNELS "" "" "SOURCES;OPTIONS" ${ARGN})
  add_library(greywhale_${SET} OBJECT ${KERNELS_SOURCES})
  target_link_libraries(greywhale_${SET} PRIVATE greywhale_common)
  target_compile_definitions(greywhale_${SET} PRIVATE GREYWHALE_INSTRUCTIONS=${SET})
  target_compile_options(greywhale_${SET} PRIVATE -O3 -fno-trapping-math -fno-math-errno -fno-exceptions ${KERNELS_OPTIONS})
  target_sources(greywhale_core PRIVATE $<TARGET_OBJECTS:greywhale_${SET}>)
endfunction()

set(LOOP_KERNEL ${NATIVE}/closed_loop/kernel.cpp)
set(WINDOWS_KERNEL ${NATIVE}/windows/kernel.cpp)
add_kernels(baseline SOURCES ${LOOP_KERNEL} ${WINDOWS_KERNEL})
# At run time the processor says which of them it has.
if(PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  add_kernels(avx2 SOURCES ${LOOP_KERNEL} ${WINDOWS_KERNEL} OPTIONS -mavx2)
  # GCC warns about its own intrinsics' deliberately undefined values.
  add_kernels(avx512 SOURCES ${LOOP_KERNEL} ${WINDOWS_KERNEL} OPTIONS -mavx512f -mavx512bw -mavx512cd -mavx512dq -mavx512vl
    $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized> $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_compile_definitions(greywhale_core PRIVATE GREYWHALE_X86)
endif()
