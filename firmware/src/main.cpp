// Wires the rooms together, nothing else: a tick when the timer says so, otherwise the link, otherwise sleep.
#include <Arduino.h>
#include <app.h>
#include <hal.h>

static app::App arm;

void setup() { arm.begin(); }

// Called from loop() only. It saves no registers (OS_task) because the controllers need nearly all of them and loop() none.
extern "C" __attribute__((OS_task, noinline, used, externally_visible)) void firmware_tick() { arm.tick(); }

static inline __attribute__((always_inline)) void run_tick() {
  __asm__ volatile("push r28\n\t"
      "push r29\n\t"
      "%~call firmware_tick\n\t"
      "pop r29\n\t"
      "pop r28"
      :
      :
      : "r2", "r3", "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16", "r17", "r18", "r19", "r20",
        "r21", "r22", "r23", "r24", "r25", "r26", "r27", "r30", "r31", "memory");
}

void loop() {
  if (hal::tick_pending()) run_tick();
  else if (!arm.service()) hal::idle();
}
