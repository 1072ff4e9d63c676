// Wires the rooms together, nothing else: a tick when the timer says so, otherwise the link, otherwise sleep.
//
// main() is here and not the framework's: that one would start a clock of its own, in the timer that the tick takes
// over.
#include <app.h>
#include <hal.h>

// Nothing but zeros until begin(): a constructor that runs at the start would take flash for each of its members.
BEHIND_RINGS static app::App arm;

void firmware_tick() { arm.tick(); }

int main() {
  arm.begin();
  for (;;) {
    if (hal::tick_pending()) hal::run_tick();
    else if (!arm.service()) hal::idle();
  }
}
