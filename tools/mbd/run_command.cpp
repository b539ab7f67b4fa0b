#include "tools/mbd/run_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/front/expect.hpp"
#include "libmbd/front/reader.hpp"
#include "libmbd/front/run.hpp"
#include "libmbd/front/summary.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct RunArguments {
  std::string model;
  std::string output;
  std::vector<std::string> set;
  TransientOptions transient;
  bool quiet = false;
};

std::string clock_time(double seconds) {
  const long s = std::lround(seconds);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

// One line on a terminal, rewritten a few times a second and wiped at the end.
class ProgressLine {
 public:
  void show(const Progress& p) {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (now - shown_ < milliseconds(200)) return;
    shown_ = now;
    const double elapsed = duration<double>(now - begun_).count();
    const std::string of = p.steps > 0 ? fmt::format(" of {}", p.steps) : "";
    const double left = elapsed * (p.duration - p.t) / p.t;
    fmt::print(stderr, "\r\033[Kt = {:.6g} of {:.6g} s, step {}{}, {} iteration{}, {} left", p.t,
               p.duration, p.step, of, p.iterations, p.iterations == 1 ? "" : "s",
               clock_time(left));
    std::fflush(stderr);
    dirty_ = true;
  }
  ~ProgressLine() {
    if (dirty_) fmt::print(stderr, "\r\033[K");
  }

 private:
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now(), shown_ = begun_;
  bool dirty_ = false;
};

int run_model(const RunArguments& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  RunOptions options;
  options.notes = apply(arguments.transient, scene);
  options.output = arguments.output.empty() ? std::filesystem::path("results") /
                                                  std::filesystem::path(arguments.model).stem()
                                            : std::filesystem::path(arguments.output);
  RunReport report;
  {
    ProgressLine line;
    if (!arguments.quiet && isatty(STDERR_FILENO))
      options.progress = [&line](const Progress& progress) { line.show(progress); };
    report = run(scene, options);
  }
  if (!arguments.quiet) fmt::print("{}", summary(report));
  if (!report.complete()) {
    fmt::print(stderr, "mbd: {}: {}\n", scene.name, report.failure);
    return 1;
  }
  for (const ExpectResult& result : report.expects)
    if (!result.pass() && arguments.quiet)
      fmt::print(stderr, "mbd: {}:{}: expected {} = {} +- {}, got {}\n", result.source.file,
                 result.source.line, result.what, result.expected, result.tolerance,
                 result.got ? fmt::format("{}", *result.got) : "nothing");
  return report.as_expected() ? 0 : 2;
}

}  // namespace

void add_run_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* const command = app.add_subcommand("run", "Simulates a model and writes its results.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option(
          "-o,--out", arguments->output,
          "directory for history.csv, history.svg and report.json; default: results/ and the "
          "model file's name without .xml")
      ->check(
          [](const std::string& d) {
            return d.empty() ? std::string("is empty; name a directory") : std::string();
          },
          "", "")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  add_transient_options(*command, arguments->transient);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd run models/four_bar.xml\n"
               "mbd run models/four_bar.xml --out four_bar_fine --set step=4.5e-3\n"
               "mbd run models/chain.xml --set N=100 --quiet\n"
               "mbd run models/shaft.xml --method radau --tolerance 1e-8\n"
               "mbd run models/shaft.xml --step \"0.5 ms\" --output 0.01\n"
               "mbd run models/pendulum.xml --method radau --tolerance 1e-10 --output steps");
  command->callback([arguments, &status] { status = run_model(*arguments); });
}

}  // namespace mbd
