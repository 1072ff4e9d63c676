// What a person is asked for in a calibration, in the words that the terminal and the page share.
#include "calibrate/rules.h"

namespace greywhale::calibrate {
namespace {

// The right-hand rule about the arm's axes (docs/arm.md): yaw about up, pitch about its right, roll along the hand.
constexpr const char* kPositiveWays[kJoints] = {
    "counter-clockwise, seen from above",
    "up: the hand rises",
    "up: the hand rises, while the upper arm is level",
    "clockwise, seen from the elbow along the hand",
};

}  // namespace

Answer positive_way(Given given) {
  const auto joint = static_cast<std::size_t>(given.next());
  if (joint >= kJoints) throw std::out_of_range("a joint is one of four.");
  return {{}, kPositiveWays[joint]};
}

Answer turn_asked(Given given) {
  return {{},
          "turn it, and no other, slowly to its positive end (" + positive_way(given).words +
              "), then to its negative end, and let it rest."};
}

Answer ready_asked(Given) {
  return {{},
          "Let the follower hang or lie so that every joint can move by 20 degrees to both sides, switch the motors' "
          "supply on, and keep a hand on its switch."};
}

}  // namespace greywhale::calibrate
