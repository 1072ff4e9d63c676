// The firmware's work: a tick each millisecond, and the link in between. App owns everything; main.cpp has one App.
#pragma once
#include <link/frame.h>
#include <link/schema.h>
#include <stdint.h>
#include <supervisor.h>

#include "controllers.h"
#include "drive.h"
#include "lead.h"
#include "memory_watch.h"
#include "parameter_sets.h"
#include "sampling.h"

namespace app {

class App {
 public:
  App() : sample_due_(false), heard_this_tick_(false), looked_(true), excused_(false), hello_due_(false) {}
  // begin() and service() are not inlined into main(): their variables would stay on the stack for ever.
  __attribute__((noinline)) void begin();
  void tick();  // when hal::tick_pending()
  // Does one bounded piece of other work; false when there is nothing to do until the next interrupt.
  __attribute__((noinline)) bool service();

 private:
  // app.cpp: the tick
  void count_ticks(hal::TickStart start);
  void supervise(bool late);
  bool estop_pressed() const;
  // Switches the drivers as the supervisor has decided. Call it wherever the supervisor may have changed its mind.
  void follow_supervisor() {
    if (supervisor_.motors_on() != drivers_on_) switch_drivers();
  }
  void switch_drivers();
  void control();
  void after_tick();
  void set_limit();
  template <uint8_t joint>
  void control_joint(uint16_t limit_mv);
  void schedule_sample();
  void show_state();
  void take_running_set();
  Part watched(uint8_t part) const;
  bool look_on();
  void learn_memory();
  void watch_memory();

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
  void note_lost_bytes(uint8_t lost);
  bool work_on_lead();
  void look_at_rails();
  void look_at_joint();
  void restart_safe();
  supervisor::Distances distances() const;
  void work_on_apply();
  void send_hello(uint8_t seq);
  void send_status();
  __attribute__((noinline)) void send_sample();  // inlined, its variables would take stack in all of service()
  void refuse_not_disabled();
  void refuse_lead(wire::LeadRefusal why, uint8_t joint);
  void refuse_set();
  void refuse(wire::NackCode code, uint16_t detail);
  template <class Message>
  void send(uint8_t seq, const Message& message);
  template <class Message>
  void reply(const Message& message) {
    send(seq_, message);
  }

  Sampling sampling_;
  Controllers controllers_;
  Drive drive_;
  supervisor::Supervisor supervisor_;
  supervisor::Observation seen_ = {};  // what the last tick has seen
  ParameterSets sets_;
  wire::Decoder decoder_;
  wire::Encoder encoder_;

  uint32_t tick_ = 0;
  uint16_t late_ticks_ = 0, rx_overruns_ = 0, telemetry_dropped_ = 0, tick_us_max_ = 0;  // they stop at 65535
  uint16_t every_ = 0, until_sample_ = 0;
  uint8_t until_control_ = 1;  // ticks
  uint8_t sample_seq_ = 0;
  uint8_t ticks_unheard_ = 0;  // since the last that took a request; stops where one may begin late again
  MemoryWatch memory_;
  bool sample_due_ : 1;
  bool heard_this_tick_ : 1;
  bool looked_ : 1;   // all that is done once after each tick has been done
  bool excused_ : 1;  // the next tick may be late without being counted, because a set is being applied
  bool hello_due_ : 1;
  bool drivers_on_ = false;
  uint8_t request_ = 0, seq_ = 0;  // of the frame that is being answered
  Lead lead_;
};

}  // namespace app
