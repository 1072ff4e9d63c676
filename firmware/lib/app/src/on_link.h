// What the other rooms' enums are on the link. Those rooms know nothing of the link, but use its names and numbers.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <link/enum_copies.h>
#include <supervisor.h>

namespace app {

static_assert(wire::is_copy<supervisor::State>(wire::State()), "states");
static_assert(wire::is_copy<supervisor::StopReason>(wire::StopReason()), "reasons of a stop");
static_assert(wire::is_copy<supervisor::Fault>(wire::Fault()), "faults");
static_assert(wire::is_copy<hal::ResetCause>(wire::ResetCause()), "causes of a reset");
static_assert(wire::is_copy<hal::Board>(wire::Board()), "boards");
static_assert(wire::is_copy<fuzzy_pdi::Refusal>(wire::Refusal()), "refusals");

inline wire::State on_link(supervisor::State state) { return static_cast<wire::State>(state); }
inline wire::StopReason on_link(supervisor::StopReason reason) { return static_cast<wire::StopReason>(reason); }
inline wire::Fault on_link(supervisor::Fault fault) { return static_cast<wire::Fault>(fault); }
inline wire::ResetCause on_link(hal::ResetCause cause) { return static_cast<wire::ResetCause>(cause); }
inline wire::Board on_link(hal::Board board) { return static_cast<wire::Board>(board); }
inline wire::Refusal on_link(fuzzy_pdi::Refusal refusal) { return static_cast<wire::Refusal>(refusal); }

}  // namespace app
