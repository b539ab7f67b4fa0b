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
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct RunArguments {
  std::string model;
  std::string output;
  std::vector<std::string> set;
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
    const double left =
        elapsed * static_cast<double>(p.steps - p.step) / static_cast<double>(p.step);
    fmt::print(stderr, "\r\033[Kt = {:.6g} of {:.6g} s, step {} of {}, {} iteration{}, {} left",
               p.t, p.duration, p.step, p.steps, p.iterations, p.iterations == 1 ? "" : "s",
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

void print_summary(const RunReport& report) {
  const Counters& c = report.transient ? report.transient_counters : report.static_counters;
  const Seconds seconds[] = {report.compile, report.equilibrium, report.integration, report.output};
  double wall = 0.0, cpu = 0.0;
  for (const Seconds& part : seconds) {
    wall += part.wall;
    cpu += part.cpu;
  }
  fmt::print("{}: ", report.model);
  if (report.transient)
    fmt::print("{:.9g} s in {} steps, ", report.t, c.steps);
  else
    fmt::print("static equilibrium in {} load steps, ", c.steps);
  fmt::print("{} iterations, {} factorizations; {:.3g} s ({:.3g} s CPU)\n", c.iterations,
             c.factorizations, wall, cpu);
  if (c.retries > 0) fmt::print("failing steps were halved {} times\n", c.retries);
  if (report.transient && report.sampled_states > 0)
    fmt::print(
        "energy: {:.6g} J at the start + {:.6g} J work of loads + {:.6g} J work of drives = "
        "{:.6g} J at the end + {:.3g} J taken out by the integrator\n",
        report.energy_start.total(), report.work.loads, report.work.drives,
        report.energy_end.total(), report.dissipated());
  for (const std::string& note : report.notes) fmt::print("note: {}\n", note);
  for (const std::filesystem::path& file : report.results) fmt::print("wrote {}\n", file.string());
  if (report.expects.empty()) return;
  std::size_t met = 0;
  for (const ExpectResult& result : report.expects) met += result.pass() ? 1 : 0;
  fmt::print("{}{} of {} expectations met\n", to_text(report.expects), met, report.expects.size());
}

int run_model(const RunArguments& arguments) {
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  RunOptions options;
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
  if (!arguments.quiet) print_summary(report);
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
  command->add_option(
      "-o,--out", arguments->output,
      "directory for history.csv, history.svg and report.json; default: results/MODEL's name");
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  command->callback([arguments, &status] { status = run_model(*arguments); });
}

}  // namespace mbd
