// mbd_study: studies of accuracy, each a subcommand that writes tables (CSV) and pictures (SVG) into a directory.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "libmbd/text/files.hpp"
#include "tools/studies/study.hpp"

int main(int argc, char** argv) {
  CLI::App app("Studies of accuracy: tables and pictures in a directory.", "mbd_study");
  app.require_subcommand(1);
  std::string out = "study_results";
  const auto add = [&](const char* name, const char* text,
                       void (*study)(const std::filesystem::path&)) {
    CLI::App* command = app.add_subcommand(name, text);
    command->add_option("--out", out, "Directory of the results")->capture_default_str();
    command->callback([&out, study] {
      mbd::make_directory(out);  // before anything is computed
      study(out);
    });
  };
  add("bend45",
      "The paper's first example: errors over elements and CPU time, strains (figures 4-7)",
      mbd::studies::bend45);
  add("dynamic", "The same bend let go: errors of its motion over elements and CPU time",
      mbd::studies::dynamic);
  add("locking", "Errors over slenderness of straight and curved cantilevers",
      mbd::studies::locking);
  add("time", "The dynamic models: errors and CPU time over tolerances and steps, three methods",
      mbd::studies::time);
  mbd::studies::ChosenOptions choosing;
  CLI::App* const chosen = app.add_subcommand(
      "chosen", "All models run with --accuracy: requested, believed and true errors, and costs");
  chosen->add_option("--out", out, "Directory of the results")->capture_default_str();
  chosen->add_option("--limit", choosing.limit, "CPU seconds for choosing, each")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  chosen->add_option("--model", choosing.models, "these models alone, without .xml");
  chosen->add_option("--accuracy", choosing.accuracies, "these accuracies alone, falling")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  chosen->callback([&out, &choosing] {
    mbd::make_directory(out);
    mbd::studies::chosen(out, choosing);
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "mbd_study: %s\n", e.what());
    return 1;
  }
  return 0;
}
