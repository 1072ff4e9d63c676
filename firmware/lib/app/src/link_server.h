// The link: takes requests, has the tick do what they ask for, and sends replies and samples. All of it in pieces of
// bounded length, between two ticks.
#pragma once
#include <link/frame.h>
#include <link/schema.h>
#include <stdint.h>

#include "tick.h"

namespace app {

class LinkServer {
 public:
  constexpr LinkServer() : sample_due_(false), hello_sent_(false) {}

  // Once after each tick.
  void schedule_sample();
  // The ring of bytes to send has room for whatever comes next.
  static bool can_reply() { return hal::tx_free() >= wire::max_wire; }

  // --- One piece of work each, the last three only when can_reply().
  void note_lost_bytes(Tick& tick);
  // Takes some bytes, and answers the request that they complete.
  void receive(Tick& tick);
  // Sends the sample that is due, or hello once after boot. False when neither is.
  bool send_due(const Tick& tick);
  // Does a step of applying a set, and answers the host at the last one.
  void apply(Tick& tick);

 private:
  void handle_frame(Tick& tick);
  template <class Request>
  void handle(Tick& tick);
  void serve(const wire::HelloRequest& request, const Tick& tick);
  void serve(const wire::StatusRequest& request, const Tick& tick);
  void serve(const wire::ParamGetRequest& request, const Tick& tick);
  void serve(const wire::ParamSetRequest& request, Tick& tick);
  void serve(const wire::ParamApplyRequest& request, Tick& tick);
  void serve(const wire::ParamSaveRequest& request, Tick& tick);
  void serve(const wire::ParamDefaultsRequest& request, Tick& tick);
  void serve(const wire::EnableRequest& request, Tick& tick);
  void serve(const wire::StopRequest& request, Tick& tick);
  void serve(const wire::RenewRequest& request, Tick& tick);
  void serve(const wire::ClearFaultRequest& request, Tick& tick);
  void serve(const wire::TelemetryRequest& request, const Tick&);
  void serve(const wire::LeadRequest& request, Tick& tick);
  void serve(const wire::LeadPointRequest& request, Tick& tick);
  void serve(const wire::ClutchRequest& request, Tick& tick);
  bool refuse_unless_granted(const supervisor::Reply& result, const Tick& tick);

  void send_hello(uint8_t seq, const Tick& tick);
  // Inlined, its variables would take stack in all of App::service().
  __attribute__((noinline)) void send_sample(const Tick& tick);
  void refuse_not_disabled(const Tick& tick);
  void refuse_lead(wire::LeadRefusal why, uint8_t joint);
  void refuse_set(const Tick& tick);
  void refuse(wire::NackCode code, uint16_t detail);
  template <class Message>
  void send(uint8_t seq, const Message& message);
  void finish(uint8_t seq, uint8_t type, uint8_t size);
  // To the frame that came last: while it waits for its answer, the decoder takes no other.
  template <class Message>
  void reply(const Message& message) {
    send(decoder_.seq(), message);
  }

  wire::Decoder decoder_;
  wire::Encoder encoder_;
  uint16_t rx_overruns_ = 0, telemetry_dropped_ = 0;  // they stop at 65535
  uint16_t every_ = 0, until_sample_ = 0;             // ticks
  uint8_t sample_seq_ = 0;
  bool sample_due_ : 1;
  bool hello_sent_ : 1;
};

}  // namespace app
