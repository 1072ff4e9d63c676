// greywhale._native: the firmware's own controller, the arm model, the simulated board and the bench, for Python.
#include "bindings.h"

NB_MODULE(_native, m) {
  m.doc() =
      "The firmware's fuzzy controller, the arm model, the simulated board and the bench, compiled for this machine.";
  bind_arm(m);
  bind_band_power(m);
  bind_board(m);
  bind_drivers(m);
  bind_bench(m);
  bind_calibrate(m);
  bind_closed_loop(m);
  bind_elementary(m);
  bind_fuzzy(m);
  bind_ideal(m);
  bind_identify(m);
  bind_observe(m);
  bind_rigid_body(m);
  bind_score(m);
}
