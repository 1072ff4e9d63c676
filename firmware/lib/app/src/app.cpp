// What is done between two ticks, and in which order.
#include "app.h"

#include <hal.h>

namespace app {

// begin() and tick() are not inlined into main.cpp: the compiler makes a constant of tick_'s address in all functions
// of Tick only when all calls come from one place.
void App::begin() { tick_.begin(); }

void App::tick() { tick_.run(); }

bool App::service() {
  if (tick_.move_reference()) return true;
  if (tick_.look_and_prepare()) {
    budget_.renew();
    server_.schedule_sample();
  }
  const uint16_t age_us = hal::tick_age_us();
  if (budget_.is_spent(age_us)) return false;
  server_.note_lost_bytes(tick_);
  const bool serves = LinkServer::can_reply() && !tick_.set_changes();
  if (serves && hal::rx_available() && budget_.may_serve_link_first(age_us)) return receive();
  if (!TickBudget::may_work(age_us)) return false;
  if (serves && server_.send_due(tick_)) return true;
  if (tick_.check_memory()) return true;
  if (serves) return serve_link();
  return LinkServer::can_reply() && apply_set(age_us);
}

// Requests wait meanwhile. The next one is judged by what a tick has seen with the new set.
bool App::apply_set(uint16_t age_us) {
  if (!tick_.sets().applying()) return tick_.start_with_safe_set();
  if (!TickBudget::may_apply(age_us)) return false;
  server_.apply(tick_);
  return true;
}

bool App::serve_link() {
  if (hal::rx_available()) return receive();
  return tick_.sets().work_on_save();
}

bool App::receive() {
  budget_.serve_link();
  server_.receive(tick_);
  return true;
}

}  // namespace app
