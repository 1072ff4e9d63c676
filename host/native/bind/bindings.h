// What each file of the binding adds to greywhale._native.
#pragma once

#include <nanobind/nanobind.h>

void bind_arm(nanobind::module_& m);
void bind_band_power(nanobind::module_& m);
void bind_bench(nanobind::module_& m);
void bind_board(nanobind::module_& m);
void bind_calibrate(nanobind::module_& m);
void bind_closed_loop(nanobind::module_& m);
void bind_drivers(nanobind::module_& m);
void bind_elementary(nanobind::module_& m);
void bind_fuzzy(nanobind::module_& m);
void bind_ideal(nanobind::module_& m);
void bind_identify(nanobind::module_& m);
void bind_observe(nanobind::module_& m);
void bind_rigid_body(nanobind::module_& m);
void bind_score(nanobind::module_& m);
