// mbd: the command. Each of its commands is a file of its own and a line here. Exit status 0: all went well;
// 1: an error, a run that failed, or one with --certify whose certificate does; 2: a run that ended but does
// not give the numbers its model expects; 100 and more: wrong use of the command.

#include <CLI/CLI.hpp>

#include <new>

#include "tools/mbd/accuracy_command.hpp"
#include "tools/mbd/campbell_command.hpp"
#include "tools/mbd/check_command.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/compare_command.hpp"
#include "tools/mbd/completion_command.hpp"
#include "tools/mbd/effects_command.hpp"
#include "tools/mbd/explain_command.hpp"
#include "tools/mbd/export_command.hpp"
#include "tools/mbd/floquet_command.hpp"
#include "tools/mbd/import_command.hpp"
#include "tools/mbd/linearize_command.hpp"
#include "tools/mbd/modes_command.hpp"
#include "tools/mbd/plot_command.hpp"
#include "tools/mbd/rotations_command.hpp"
#include "tools/mbd/run_command.hpp"
#include "tools/mbd/schema_command.hpp"
#include "tools/mbd/section_command.hpp"
#include "tools/mbd/sweep_command.hpp"
#include "tools/mbd/torture_command.hpp"
#include "tools/mbd/view_command.hpp"

namespace {

int run_commands(int argc, char** argv) {
  CLI::App app("Flexible multibody dynamics: an XML model becomes a trajectory.", "mbd");
  mbd::set_up(app);
  int status = 0;
  mbd::add_run_command(app, status);
  mbd::add_check_command(app, status);
  mbd::add_explain_command(app, status);
  mbd::add_section_command(app, status);
  mbd::add_accuracy_command(app, status);
  mbd::add_effects_command(app, status);
  mbd::add_modes_command(app, status);
  mbd::add_linearize_command(app, status);
  mbd::add_campbell_command(app, status);
  mbd::add_rotations_command(app, status);
  mbd::add_floquet_command(app, status);
  mbd::add_sweep_command(app, status);
  mbd::add_torture_command(app, status);
  mbd::add_view_command(app, status);
  mbd::add_export_command(app, status);
  mbd::add_import_command(app, status);
  mbd::add_plot_command(app, status);
  mbd::add_compare_command(app, status);
  mbd::add_schema_command(app, status);
  mbd::add_completion_command(app, status);
  mbd::set_examples(app,
                    "mbd check models/four_bar.xml\n"
                    "mbd run models/four_bar.xml\n"
                    "mbd view models/four_bar.xml\n"
                    "mbd plot results/four_bar C\n"
                    "mbd accuracy models/shaft.xml\n"
                    "mbd torture models/shaft.xml\n"
                    "mbd run models/chain.xml --set N=100 --out chain_of_100\n"
                    "mbd schema beam\n"
                    "mbd run --help");
  return mbd::run_command_line(app, argc, argv, status);
}

}  // namespace

int main(int argc, char** argv) {
  mbd::secure_streams();
  mbd::keep_memory_for_the_end();
  try {
    return run_commands(argc, argv);
  } catch (const std::bad_alloc&) {  // before there is a command that could say so
    return mbd::say_no_memory();
  }
}
