// The batch kernel compiled for any x86-64 processor. CMakeLists.txt sets the instruction set of this file alone.
#define lanes lanes_baseline
#include "closed_loop/lanes_portable.h"

#include "closed_loop/lanes_block.h"

namespace greywhale::loop {

void run_block_baseline(const Experiment& x, const Pots& pots, const Block& block, int steps_per_tick, Measures* measures) {
  lanes::run_block(x, pots, block, steps_per_tick, measures);
}

void check_law_baseline(const LawCheck& check) { lanes::check_law(check); }

}  // namespace greywhale::loop
