// The firmware's work: a tick each millisecond, and the link in between. main.cpp has one App.
#pragma once
#include "link_server.h"
#include "tick.h"
#include "tick_budget.h"

namespace app {

class App {
 public:
  // begin() and service() are not inlined into main(): their variables would stay on the stack for ever.
  __attribute__((noinline)) void begin();
  void tick();  // when hal::tick_pending()
  // Does one bounded piece of other work; false when there is nothing to do until the next interrupt.
  __attribute__((noinline)) bool service();

 private:
  bool apply_set(uint16_t age_us);
  bool serve_link();
  bool receive();

  Tick tick_;
  LinkServer server_;
  TickBudget budget_;
};

}  // namespace app
