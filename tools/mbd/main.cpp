// mbd: the command. Exit status 0: all went well; 1: an error, or a run that failed; 2: a run that
// ended but does not give the numbers its model expects; 100 and more: wrong use of the command.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "libmbd/front/report.hpp"
#include "tools/mbd/check_command.hpp"
#include "tools/mbd/explain_command.hpp"
#include "tools/mbd/run_command.hpp"

int main(int argc, char** argv) {
  CLI::App app("Flexible multibody dynamics: an XML model becomes a trajectory.", "mbd");
  app.set_version_flag("--version", "mbd " + std::string(mbd::version()));
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  mbd run models/four_bar.xml\n"
      "  mbd run models/four_bar.xml --out four_bar_fine --set step=4.5e-3\n"
      "  mbd run models/chain.xml --set N=100 --quiet\n"
      "Exit status: 0 all went well; 1 an error, or the run failed; 2 not the numbers expected.");

  int status = 0;
  mbd::add_run_command(app, status);
  mbd::add_check_command(app, status);
  mbd::add_explain_command(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mbd: %s\n", error.what());
    return 1;
  }
  return status;
}
