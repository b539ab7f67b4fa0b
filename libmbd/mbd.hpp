// libmbd: the one include of a program that uses the library.
//
//   mbd::Scene scene = mbd::read_model("model.xml");     // or fill a Scene in C++
//   mbd::RunReport report = mbd::run(scene);             // or step a State oneself:
//
//   mbd::Model model = mbd::compile(scene);
//   mbd::State state = model.initial;
//   mbd::GeneralizedAlpha integrator(*model.system, mbd::make_klu_solver(), {.step = 1e-3});
//   integrator.start(state);
//   while (state.t < 1.0 && integrator.step(state).converged) { … }
#pragma once

#include "libmbd/core/error.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/core/types.hpp"
#include "libmbd/front/build_facts.hpp"
#include "libmbd/front/check_scene.hpp"
#include "libmbd/front/compare.hpp"
#include "libmbd/front/describe.hpp"
#include "libmbd/front/expect.hpp"
#include "libmbd/front/history.hpp"
#include "libmbd/front/model.hpp"
#include "libmbd/front/observers.hpp"
#include "libmbd/front/plot.hpp"
#include "libmbd/front/reader.hpp"
#include "libmbd/front/report.hpp"
#include "libmbd/front/run.hpp"
#include "libmbd/front/scene.hpp"
#include "libmbd/front/summary.hpp"
#include "libmbd/front/time_stepping.hpp"
#include "libmbd/study/accuracy.hpp"
#include "libmbd/study/accuracy_page.hpp"
#include "libmbd/study/accuracy_report.hpp"
#include "libmbd/study/certify.hpp"
#include "libmbd/study/choose.hpp"
#include "solvers/generalized_alpha.hpp"
#include "solvers/initial.hpp"
#include "solvers/klu_solver.hpp"
#include "solvers/mechanism.hpp"
#include "solvers/report.hpp"
#include "solvers/statics.hpp"
