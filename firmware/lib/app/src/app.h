// The firmware's work: one tick a millisecond, and the link in between. Owns everything; main() has one of it.
#pragma once
#include <link/frame.h>
#include <link/schema.h>
#include <stdint.h>
#include <supervisor.h>

#include "controllers.h"
#include "drive.h"
#include "lead.h"
#include "parameter_sets.h"
#include "sampling.h"

namespace app {

class App {
 public:
  // Not inlined into main(), where their variables would stay on the stack for ever.
  __attribute__((noinline)) void begin();
  void tick();   // when hal::tick_pending()
  // One bounded piece of other work; false when there is nothing to do until the next interrupt.
  __attribute__((noinline)) bool service();

 private:
  // app.cpp: the tick
  void count_ticks(hal::TickStart start);
  void supervise(bool late);
  // The drivers go on from rest and off at once; called wherever the supervisor may have changed its mind.
  void follow_supervisor() {
    if (supervisor_.motors_on() != drivers_on_) switch_drivers();
  }
  void switch_drivers();
  void control();
  template <uint8_t joint>
  void control_joint(uint16_t limit_mv);
  void schedule_sample();
  void show_state();
  void take_running_set();

  // requests.cpp: the link
  void receive();
  void handle_frame();
  template <class Request>
  void handle();
  void serve(const wire::HelloRequest& request);
  void serve(const wire::StatusRequest& request);
  void serve(const wire::ParamGetRequest& request);
  void serve(const wire::ParamSetRequest& request);
  void serve(const wire::ParamApplyRequest& request);
  void serve(const wire::ParamSaveRequest& request);
  void serve(const wire::ParamDefaultsRequest& request);
  void serve(const wire::EnableRequest& request);
  void serve(const wire::StopRequest& request);
  void serve(const wire::RenewRequest& request);
  void serve(const wire::ClearFaultRequest& request);
  void serve(const wire::TelemetryRequest& request);
  void serve(const wire::LeadRequest& request);
  void serve(const wire::LeadPointRequest& request);
  bool granted(const supervisor::Reply& result);
  bool work_on_lead();
  void see_distances();
  void work_on_apply();
  void send_hello(uint8_t seq);
  void send_status();
  __attribute__((noinline)) void send_sample();   // its variables would lie under those of everything that service() calls
  wire::State state_on_link() const;
  void refuse_unless_disabled();
  void refuse_lead(wire::LeadRefusal why, uint8_t joint);
  void refuse_set();
  void refuse(wire::NackCode code, uint16_t detail);
  template <class Message>
  void send(uint8_t seq, const Message& message);
  template <class Message>
  void reply(const Message& message) { send(seq_, message); }

  Sampling sampling_;
  Controllers controllers_;
  Drive drive_;
  supervisor::Supervisor supervisor_;
  supervisor::Observation seen_ = {};   // by the last tick
  ParameterSets sets_;
  wire::Decoder decoder_;
  wire::Encoder encoder_;

  uint32_t tick_ = 0;
  uint16_t late_ticks_ = 0, rx_overruns_ = 0, telemetry_dropped_ = 0, tick_us_max_ = 0;   // stop at 65535
  uint16_t every_ = 0, until_sample_ = 0;
  uint8_t until_control_ = 1;      // ticks
  uint8_t sample_seq_ = 0;
  bool sample_due_ = false;
  bool heard_this_tick_ = false;
  bool excused_ = false;   // applying a set (motors off) holds up the next tick: its lateness does not count. No request until then
  bool hello_due_ = false;
  bool drivers_on_ = false;
  uint8_t request_ = 0, seq_ = 0;              // of the frame being answered
  Lead lead_;                      // last: the tick has no use for it, and finds near at hand what it needs
};

}  // namespace app
