// libmbd: the one include of a program that uses the library.
//
//   mbd::Scene scene = mbd::read_model("model.xml");     // or fill a Scene in C++
//   mbd::RunReport report = mbd::run(scene);             // or step a State oneself:
//
//   mbd::Model model = mbd::compile(scene);
//   mbd::State state = model.initial;
//   mbd::GeneralizedAlpha integrator(*model.system, mbd::make_block_solver(mbd::PivotOrder::nodes_first),
//                                {.step = 1e-3});
//   integrator.start(state);
//   while (state.t < 1.0 && integrator.step(state).converged) { … }
#pragma once

#include "elements/node/force.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/compile/plugin.hpp"
#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/core/types.hpp"
#include "libmbd/language/check_scene.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/pictures/compare.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/describe.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/section/gmsh.hpp"
#include "libmbd/section/shapes.hpp"
#include "libmbd/section/stress.hpp"
#include "libmbd/study/accuracy/accuracy.hpp"
#include "libmbd/study/accuracy/accuracy_page.hpp"
#include "libmbd/study/accuracy/accuracy_report.hpp"
#include "libmbd/study/accuracy/choose.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/trust/certify.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/motion.hpp"
#include "libmbd/view/page.hpp"
#include "libmbd/view/run_file.hpp"
#include "libmbd/view/vtk.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/constraints/mechanism.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/modes/steady_rotation.hpp"
#include "solvers/newton/report.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/generalized_alpha.hpp"
