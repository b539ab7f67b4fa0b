#include "libmbd/study/trial/trial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sstream>

#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

constexpr double grace = 2.0;  // [s] that a process may go on after its limit before it is killed

double resident() {  // size of this process in memory [bytes]
  std::ifstream file("/proc/self/statm");
  double all = 0.0, pages = 0.0;
  file >> all >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Thrown through a run that takes too long.
struct TooLong {};

// CPU time and wall time from now on.
class Deadline {
 public:
  Deadline(double cpu, double wall) : cpu_(used_cpu() + cpu), wall_(wall) {}
  void check() const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
    if (used_cpu() > cpu_ || passed.count() > wall_) throw TooLong();
  }

 private:
  double cpu_, wall_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

// The places of Findings, as the run comes to them.
class Finder : public Observer {
 public:
  Finder(const Scene& scene, Findings& findings, const Deadline& deadline, ResolutionMeter* meter)
      : scene_(scene), findings_(findings), deadline_(deadline), meter_(meter) {}

  void accepted(const Sample& sample) override {
    deadline_.check();
    if (meter_) meter_->look(sample.model, sample.state);
    if (findings_.columns.empty()) {
      const std::vector<Column> all = columns(sample.model);
      for (std::size_t c = 0; c < all.size(); ++c) {
        if (scene_.path && all[c].name == "branch") branch_ = c;
        if (scene_.path ? says_where(all[c].name) : c == 0) continue;
        findings_.columns.push_back(all[c].name);
        findings_.units.push_back(all[c].unit);
        chosen_.push_back(c);
      }
    }
    const auto found = [&](double at) {
      findings_.at.push_back(at);
      findings_.rows.emplace_back();
      for (const std::size_t c : chosen_) findings_.rows.back().push_back(sample.row[c]);
      if (branch_) findings_.branch.push_back(static_cast<int>(sample.row[*branch_]));
      const Energies energies = sample.model.system->energies(sample.state);
      findings_.energy = std::max({findings_.energy, energies.kinetic, energies.strain});
    };
    if (scene_.transient) {
      found(sample.state.t);
    } else if (!scene_.path) {
      findings_.at.clear();
      findings_.rows.clear();  // the last load step alone
      found(sample.state.load_factor);
    } else if (sample.model.path->event != PathEvent::none) {
      found(static_cast<double>(findings_.at.size() + 1));
    }
  }

 private:
  // Columns of a path that say where on it a point is, and depend on the mesh or are not always there. Its load is what is
  // found.
  static bool says_where(std::string_view name) {
    return name == "arc_length" || name == "branch" || name == "event" ||
           name == "negative_eigenvalues";
  }

  const Scene& scene_;
  Findings& findings_;
  std::vector<std::size_t> chosen_;  // columns
  std::optional<std::size_t> branch_;
  const Deadline& deadline_;
  ResolutionMeter* meter_;
};

std::string too_long(const TrialOptions& options) {
  return fmt::format("stopped: more than {:.3g} s", std::min(options.limit, options.wall));
}

// What the child does: a run without files.
Trial run_here(Scene scene, const TrialOptions& options) {
  Trial trial;
  scene.plots.clear();
  scene.expects.clear();  // at times that need not be rows here
  if (scene.transient) {
    scene.transient->output_steps = false;
    scene.transient->output = scene.transient->duration / options.samples;
  }
  const double begin = used_cpu(), resident_before = resident();
  const Deadline deadline(options.limit, options.wall);
  ResolutionMeter meter(scene);
  Finder finder(scene, trial.findings, deadline, options.resolution ? &meter : nullptr);
  RunOptions run_options;
  run_options.observers = {&finder};
  run_options.estimate_error = false;
  run_options.audit = options.audit;
  run_options.progress = [&](const Progress&) { deadline.check(); };
  try {
    const RunReport report = run(scene, run_options);
    trial.beams = meter.beams();
    trial.complete = report.complete();
    trial.failure = report.failure;
    trial.cpu_stepping = scene.transient ? report.integration.cpu : report.equilibrium.cpu;
    trial.nodes = report.nodes;
    trial.unknowns = report.unknowns;
    trial.multipliers = report.multipliers;
    trial.counters = report.transient_counters;
    const Counters& statics = report.static_counters;
    trial.counters.steps += statics.steps;
    trial.counters.iterations += statics.iterations;
    trial.counters.residuals += statics.residuals;
    trial.counters.tangents += statics.tangents;
    trial.counters.factorizations += statics.factorizations;
    if (trial.complete && scene.path && trial.findings.at.empty()) {
      trial.complete = false;
      trial.failure = fmt::format(
          "the path met no limit point, bifurcation or mark to compare before its end "
          "({}); give it a <mark> on the way, or more points",
          report.path_end);
    }
  } catch (const TooLong&) {
    trial.stopped = true;
    trial.failure = too_long(options);
  } catch (const std::exception& error) {
    trial.failure = error.what();
  }
  trial.cpu = used_cpu() - begin;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  trial.memory = std::max(0.0, 1024.0 * static_cast<double>(usage.ru_maxrss) - resident_before);
  if (trial.stopped) trial.cpu_stepping = trial.cpu;
  return trial;
}

void write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // nobody listens any more
    done += static_cast<std::size_t>(n);
  }
}

// What the child wrote until it ended, or until the deadline, when it is killed.
std::string read_until_end(int file, pid_t child, std::chrono::steady_clock::time_point deadline,
                           const std::atomic<bool>* interrupted, bool& killed) {
  std::string text;
  char piece[65536];
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                          deadline - std::chrono::steady_clock::now())
                          .count();
    if (!killed && (left <= 0 || (interrupted != nullptr && *interrupted))) {
      ::kill(child, SIGKILL);
      killed = true;
    }
    pollfd ready{file, POLLIN, 0};
    const int wait = killed ? 200 : static_cast<int>(std::min<long long>(left + 1, 200));
    const int n = ::poll(&ready, 1, wait);
    if (n < 0 && errno != EINTR) break;
    if (n <= 0) continue;
    const ssize_t got = ::read(file, piece, sizeof piece);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    text.append(piece, static_cast<std::size_t>(got));
  }
  return text;
}

Trial run_in_child(const Scene& scene, const TrialOptions& options) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw Error(fmt::format("no pipe to a process of its own: {}", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw Error(fmt::format("no process of its own for a run: {}", std::strerror(errno)));
  }
  if (child == 0) {
    ::close(ends[0]);
    // Not what the parent does then; but what the program was started to ignore, it goes on to ignore.
    if (std::signal(SIGINT, SIG_DFL) == SIG_IGN) std::signal(SIGINT, SIG_IGN);
    if (options.limit < 1e6) {  // inside a step, nobody looks at the time
      const auto most = static_cast<rlim_t>(std::ceil(options.limit + grace));
      const rlimit cpu{most, most + 1};
      ::setrlimit(RLIMIT_CPU, &cpu);
    }
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
      write_all(ends[1], serialize(run_here(scene, options)));
    } catch (...) {  // no memory: nothing may go on here as if it were the parent
    }
    ::_exit(0);  // nothing of the parent's is flushed or destroyed twice
  }
  ::close(ends[1]);
  bool killed = false;
  const auto wall = std::chrono::duration<double>(std::min(options.wall + grace, 1e7));
  const auto deadline = std::chrono::steady_clock::now() +
                        std::chrono::duration_cast<std::chrono::steady_clock::duration>(wall);
  const std::string text = read_until_end(ends[0], child, deadline, options.interrupted, killed);
  ::close(ends[0]);
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  Trial trial;
  if (std::optional<Trial> told = deserialize(text)) {
    trial = std::move(*told);
  } else {
    const bool interrupted = options.interrupted != nullptr && *options.interrupted;
    trial.stopped = killed || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
    trial.lost = !trial.stopped;
    trial.failure = interrupted     ? "interrupted"
                    : trial.stopped ? too_long(options)
                    : WIFSIGNALED(status)
                        ? fmt::format("the process ended by signal {} ({})", WTERMSIG(status),
                                      strsignal(WTERMSIG(status)))
                        : "the process ended without a result";
    trial.cpu = trial.cpu_stepping =
        static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
        1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  }
  trial.repeats = 1;
  return trial;
}

// ---- text -----------------------------------------------------------------------------------------

constexpr std::string_view heading = "mbd trial 2";

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

struct Reader {
  std::istringstream in;
  bool good = true;

  std::string line(std::string_view key) {
    std::string text;
    if (!std::getline(in, text) || !text.starts_with(key) || text.size() <= key.size()) {
      good = false;
      return {};
    }
    return text.substr(key.size() + 1);
  }
  std::vector<double> numbers(std::string_view key) {
    const std::string text = line(key);
    std::vector<double> values;
    for (const char *at = text.data(), *const end = at + text.size(); at < end;) {
      double value = 0.0;
      const auto [next, code] = std::from_chars(at, end, value);
      if (code != std::errc()) {
        good = false;
        break;
      }
      values.push_back(value);
      at = next + (next < end ? 1 : 0);
    }
    return values;
  }
  std::vector<std::string> words(std::string_view key) {
    std::istringstream text(line(key));
    std::vector<std::string> all;
    for (std::string word; std::getline(text, word, ',');) all.push_back(word);
    return all;
  }
};

}  // namespace

std::string serialize(const Trial& trial) {
  std::string counters;
  for (const NamedCounter& n : named_counters)
    counters += fmt::format(" {}", trial.counters.*n.counter);
  std::string text = fmt::format(
      "{}\nstate {} {} {} {} {} {} {} {} {}\ncounters{}\nfailure {}\ncolumns {}\n"
      "units {}\nenergy {}\nbranch {}\nrows {}\n",
      heading, trial.complete ? 1 : 0, trial.stopped ? 1 : 0, trial.cpu_stepping, trial.cpu,
      trial.repeats, trial.memory, trial.nodes, trial.unknowns, trial.multipliers, counters,
      one_line(trial.failure), fmt::join(trial.findings.columns, ","),
      fmt::join(trial.findings.units, ","), trial.findings.energy,
      fmt::join(trial.findings.branch, " "), trial.findings.at.size());
  for (std::size_t k = 0; k < trial.findings.at.size(); ++k)
    text += fmt::format("{} {}\n", trial.findings.at[k], fmt::join(trial.findings.rows[k], " "));
  for (const BeamResolution& beam : trial.beams)
    text += fmt::format("beam {} {} {} {} {}\nname {}\n", beam.order, beam.elements, beam.strain,
                        beam.jump, fmt::join(beam.coefficients, " "), one_line(beam.name));
  return text + "end\n";
}

std::optional<Trial> deserialize(const std::string& text) {
  Reader reader{std::istringstream(text)};
  std::string first;
  if (!std::getline(reader.in, first) || first != heading || !text.ends_with("\nend\n"))
    return std::nullopt;
  Trial trial;
  const std::vector<double> state = reader.numbers("state"), counted = reader.numbers("counters");
  trial.failure = reader.line("failure");
  trial.findings.columns = reader.words("columns");
  trial.findings.units = reader.words("units");
  const std::vector<double> energy = reader.numbers("energy"), branch = reader.numbers("branch"),
                            rows = reader.numbers("rows");
  trial.findings.units.resize(
      trial.findings.columns.size());  // an empty one at the end is not written
  if (state.size() != 9 || counted.size() != named_counters.size() || energy.size() != 1 ||
      rows.size() != 1)
    return std::nullopt;
  trial.findings.energy = energy[0];
  for (const double number : branch) trial.findings.branch.push_back(static_cast<int>(number));
  trial.complete = state[0] != 0.0;
  trial.stopped = state[1] != 0.0;
  trial.cpu_stepping = state[2];
  trial.cpu = state[3];
  trial.repeats = static_cast<int>(state[4]);
  trial.memory = state[5];
  trial.nodes = static_cast<Index>(state[6]);
  trial.unknowns = static_cast<Index>(state[7]);
  trial.multipliers = static_cast<Index>(state[8]);
  Counters& c = trial.counters;
  std::size_t k = 0;
  for (const NamedCounter& n : named_counters) c.*n.counter = static_cast<long>(counted[k++]);
  for (double row = 0; row < rows[0]; row += 1.0) {
    std::string line;
    std::getline(reader.in, line);
    Reader one{std::istringstream("row " + line)};
    std::vector<double> values = one.numbers("row");
    if (!one.good || values.size() != trial.findings.columns.size() + 1) return std::nullopt;
    trial.findings.at.push_back(values.front());
    values.erase(values.begin());
    trial.findings.rows.push_back(std::move(values));
  }
  while (reader.in.peek() == 'b') {
    std::vector<double> values = reader.numbers("beam");
    BeamResolution beam;
    beam.name = reader.line("name");
    if (!reader.good || values.size() < 4) return std::nullopt;
    beam.order = static_cast<int>(values[0]);
    beam.elements = static_cast<int>(values[1]);
    beam.strain = values[2];
    beam.jump = values[3];
    beam.coefficients.assign(values.begin() + 4, values.end());
    trial.beams.push_back(std::move(beam));
  }
  return trial;
}

Trial run_trial(const Scene& scene, const TrialOptions& options) {
  Trial trial = run_in_child(scene, options);
  double spent = trial.cpu;
  while (trial.complete && trial.repeats < options.repeats &&
         spent + trial.cpu < options.repeat_within) {
    const Trial again = run_in_child(scene, options);
    if (!again.complete) break;
    spent += again.cpu;
    trial.cpu = std::min(trial.cpu, again.cpu);
    trial.cpu_stepping = std::min(trial.cpu_stepping, again.cpu_stepping);
    ++trial.repeats;
  }
  return trial;
}

}  // namespace mbd
