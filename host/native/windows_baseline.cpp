// The windows kernel for any x86-64 processor. CMakeLists.txt sets the options of this file alone.
#define GREYWHALE_LANES 2
#include "windows/kernel.h"

namespace greywhale::windows {

void simulate_2(const Windows& windows, const Lane* lanes, std::size_t count) { simulate(windows, lanes, count); }

}  // namespace greywhale::windows
