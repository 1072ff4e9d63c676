// The batch kernel compiled for processors with AVX-512 (F, BW, CD, DQ, VL). CMakeLists.txt sets the instruction set of this file alone.
#define lanes lanes_avx512
#include "closed_loop/lanes_avx512.h"

#include "closed_loop/lanes_block.h"

namespace greywhale::loop {

void run_block_avx512(const Experiment& x, const Pots& pots, const Block& block, int steps_per_tick, Measures* measures) {
  lanes::run_block(x, pots, block, steps_per_tick, measures);
}

void check_law_avx512(const LawCheck& check) { lanes::check_law(check); }

}  // namespace greywhale::loop
