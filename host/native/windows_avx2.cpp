// The windows kernel for processors with AVX2. CMakeLists.txt sets the instruction set of this file alone.
#define GREYWHALE_LANES 4
#include "windows/kernel.h"

namespace greywhale::windows {

void simulate_4_avx2(const Windows& windows, const Lane* lanes, std::size_t count) { simulate(windows, lanes, count); }

}  // namespace greywhale::windows
