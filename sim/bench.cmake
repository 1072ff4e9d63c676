# The library greywhale_bench: the simulated Arduino and the bench around it, without Python; part of greywhale._native. To be included
# after core.cmake.
file(GLOB BENCH_SOURCES CONFIGURE_DEPENDS ${REPOSITORY}/sim/board/*.cpp ${REPOSITORY}/sim/bench/*.cpp)
add_library(greywhale_bench STATIC ${BENCH_SOURCES})
target_link_libraries(greywhale_bench PUBLIC greywhale_core)
# Else GCC puts some of the jumps behind instructions together again, and simulated time costs a tenth more.
set_source_files_properties(${REPOSITORY}/sim/board/cpu.cpp PROPERTIES
  COMPILE_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-fno-gcse;-fno-crossjumping>")
