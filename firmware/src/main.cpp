// Wires the rooms together, nothing else: a tick when the timer says so, otherwise the link, otherwise sleep.
#include <Arduino.h>
#include <app.h>
#include <hal.h>

static app::App arm;

void setup() { arm.begin(); }

void firmware_tick() { arm.tick(); }

void loop() {
  if (hal::tick_pending()) hal::run_tick();
  else if (!arm.service()) hal::idle();
}
