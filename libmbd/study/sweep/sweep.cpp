#include "libmbd/study/sweep/sweep.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <ctime>
#include <string_view>

#include "libmbd/results/history.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/tables.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

using Status = SweepRow::Status;

constexpr std::array<std::string_view, 6> words_of_what = {"end",     "minimum", "maximum",
                                                           "largest", "mean",    "rms"};
// CPU time of this thread [s]: a worker of a cluster may run several points side by side.
double used_cpu_here() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A column of a run, and what is kept of it.
struct Kept {
  std::string column;
  SweepOf of = SweepOf::end;
};

// What comes of a column, row by row.
struct Gathered {
  double last = 0.0, least = 0.0, most = 0.0, sum = 0.0, squares = 0.0;
  long rows = 0;

  void add(double x) {
    least = rows == 0 ? x : std::min(least, x);
    most = rows == 0 ? x : std::max(most, x);
    last = x;
    sum += x;
    squares += x * x;
    ++rows;
  }
  double value(SweepOf of) const {
    const auto count = static_cast<double>(rows);
    switch (of) {
      case SweepOf::end:
        return last;
      case SweepOf::minimum:
        return least;
      case SweepOf::maximum:
        return most;
      case SweepOf::largest:
        return std::max(std::abs(least), std::abs(most));
      case SweepOf::mean:
        return sum / count;
      case SweepOf::rms:
        return std::sqrt(squares / count);
    }
    return last;
  }
};

class Gatherer final : public Observer {
 public:
  explicit Gatherer(const std::vector<Kept>& kept) : kept_(kept), gathered_(kept.size()) {}

  void accepted(const Sample& sample) override {
    if (places_.empty()) {
      const std::vector<Column> all = columns(sample.model);
      for (const Kept& kept : kept_) {
        const auto found = std::find_if(all.begin(), all.end(),
                                        [&](const Column& c) { return c.name == kept.column; });
        if (found == all.end())
          throw Error(fmt::format("column {} is not recorded at this point", kept.column));
        places_.push_back(static_cast<std::size_t>(found - all.begin()));
      }
    }
    for (std::size_t k = 0; k < places_.size(); ++k) gathered_[k].add(sample.row[places_[k]]);
  }
  std::vector<double> values() const {
    std::vector<double> all;
    for (std::size_t k = 0; k < kept_.size(); ++k) all.push_back(gathered_[k].value(kept_[k].of));
    return all;
  }

 private:
  const std::vector<Kept>& kept_;
  std::vector<Gathered> gathered_;
  std::vector<std::size_t> places_;
};

// What one point gives.
SweepRow run_here(const ReadSweptModel& read, const Overrides& overrides,
                  const std::vector<Kept>& kept) {
  SweepRow row;
  const double begin = used_cpu_here();
  try {
    Scene scene = read(overrides);
    scene.plots.clear();
    scene.expects.clear();  // are of the model's own parameters
    Gatherer gatherer(kept);
    RunOptions options;
    options.observers = {&gatherer};
    options.estimate_error = false;
    const RunReport report = run(scene, options);
    row.t = report.t;
    row.message = report.failure;
    row.status = report.complete() ? Status::done : Status::failed;
    if (report.complete()) row.values = gatherer.values();
  } catch (const std::exception& error) {
    row.status = Status::refused;
    row.message = error.what();
  }
  row.cpu = used_cpu_here() - begin;
  return row;
}

// ---- processes --------------------------------------------------------------------------------------

struct Child {
  pid_t pid = -1;
  int end = -1;  // where its line comes out
  std::size_t point = 0;
  std::string text;
};

void tell(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // nobody listens any more
    done += static_cast<std::size_t>(n);
  }
}

Overrides values_of(const SweepPlan& plan, std::size_t point) {
  Overrides overrides;
  for (std::size_t i = 0; i < plan.parameters.size(); ++i)
    overrides.emplace_back(plan.parameters[i], plan.points[point][i]);
  return overrides;
}

Child start_child(const ReadSweptModel& read, const SweepPlan& plan, std::size_t point,
                  const std::vector<Kept>& kept, KeptRows* rows) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw Error(fmt::format("no pipe to a process of its own: {}", std::strerror(errno)));
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw Error(fmt::format("no process of its own for a run: {}", std::strerror(errno)));
  }
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);  // it ended before that was said
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
      std::signal(signal, SIG_IGN);  // the parent ends it
    ::close(ends[0]);
    if (rows != nullptr) rows->leave();
    try {
      tell(ends[1], line_of(run_here(read, values_of(plan, point), kept)));
    } catch (...) {  // no memory: nothing may go on here as if it were the parent
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  return {child, ends[0], point, {}};
}

// After the end of its pipe, or of the child itself.
SweepRow end_of(Child& child, std::size_t columns) {
  ::close(child.end);
  int status = 0;
  rusage usage{};
  while (::wait4(child.pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  if (child.text.ends_with('\n'))
    if (auto row = row_of(std::string_view(child.text).substr(0, child.text.size() - 1), columns))
      return *row;
  SweepRow row;
  row.status = Status::lost;
  row.cpu = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
            1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  row.message = WIFSIGNALED(status) ? fmt::format("the process ended by signal {} ({})",
                                                  WTERMSIG(status), strsignal(WTERMSIG(status)))
                                    : "the process ended without a result";
  return row;
}

// Kills what still runs when it goes.
class Children {
 public:
  ~Children() {
    for (Child& child : all) {
      ::kill(child.pid, SIGKILL);
      ::close(child.end);
      while (::waitpid(child.pid, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  }
  std::vector<Child> all;
};

// What stands behind the @ of a quantity; without one, the end.
SweepOf what_of(const std::string& text) {
  const std::size_t at = text.find('@');
  if (at == std::string::npos) return SweepOf::end;
  const std::string_view word = std::string_view(text).substr(at + 1);
  const auto found = std::find(words_of_what.begin(), words_of_what.end(), word);
  if (found == words_of_what.end())
    throw Error(fmt::format("{}: \"{}\" is none of {}", excerpt(text), excerpt(word),
                            fmt::join(words_of_what, ", ")));
  return static_cast<SweepOf>(found - words_of_what.begin());
}

std::vector<Kept> choose_kept(const std::vector<std::string>& quantities, const History& history) {
  std::vector<Kept> all;
  const auto add = [&](const std::string& name, SweepOf of) {
    const std::vector<std::string> names =
        name.empty() ? std::vector<std::string>{} : std::vector<std::string>{name};
    for (const std::size_t c : choose_columns(history, names)) {
      const std::string& column = history.columns[c].name;
      if (std::none_of(all.begin(), all.end(),
                       [&](const Kept& k) { return k.column == column && k.of == of; }))
        all.push_back({column, of});
    }
  };
  if (quantities.empty()) add("", SweepOf::end);
  for (const std::string& text : quantities) {
    const std::size_t at = text.find('@');
    const SweepOf of = what_of(text);
    if (at == 0) throw Error(fmt::format("{}: names no quantity before the @", excerpt(text)));
    add(text.substr(0, at), of);
  }
  return all;
}

// Of names of columns as a study has them.
std::vector<Kept> kept_of(const std::vector<Column>& columns) {
  std::vector<Kept> kept;
  for (const Column& column : columns)
    kept.push_back({column.name.substr(0, column.name.find('@')), what_of(column.name)});
  return kept;
}

}  // namespace

SweepShare share_of(std::string_view text) {
  SweepShare share;
  const std::size_t slash = text.find('/');
  const auto number = [](std::string_view word, std::size_t& value) {
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    return code == std::errc() && end == word.data() + word.size();
  };
  if (slash == std::string_view::npos || !number(text.substr(0, slash), share.number) ||
      !number(text.substr(slash + 1), share.of) || share.number < 1 || share.number > share.of ||
      share.of > most_points)
    throw Error(
        fmt::format("--share {}: is no share of a sweep; give I/N with I from 1 to N, as "
                    "2/8 for the second of eight",
                    excerpt(text)));
  return share;
}

std::size_t SweepStudy::count(SweepRow::Status status) const {
  return static_cast<std::size_t>(std::count_if(
      rows.begin(), rows.end(), [status](const SweepRow& row) { return row.status == status; }));
}

struct SweepTable::Inside {
  SweepStudy study;
  std::optional<KeptRows> rows;
};

SweepTable::SweepTable(const ReadSweptModel& read, const SweepPlan& plan,
                       const SweepOptions& options)
    : inside_(std::make_unique<Inside>()) {
  SweepStudy& study = inside_->study;
  study.plan = plan;
  study.share = options.share;
  study.command = options.command;
  study.rows.resize(plan.points.size());

  // Which columns there are: as the model is, or at the first point if it needs its values.
  History history;
  std::vector<std::string> known;  // parameters
  const auto look = [&](const Overrides& overrides) {
    const Scene scene = read(overrides);
    study.model = scene.name;
    study.file = scene.file;
    known.clear();
    for (const auto& parameter : scene.parameters) known.push_back(parameter.first);
    history.file = scene.file;
    history.columns = columns(compile(scene));
  };
  try {
    look({});
  } catch (const Error&) {
    look(values_of(plan, 0));
  }
  const std::vector<std::string_view> words(known.begin(), known.end());
  for (const std::string& name : plan.parameters)
    if (std::find(words.begin(), words.end(), name) == words.end())
      throw Error(fmt::format("--vary {}: {} has no such parameter{}", name, study.file,
                              suggest(name, words, "parameters")));
  for (const Kept& k : choose_kept(options.quantities, history)) {
    const std::string& unit = history.columns[choose_column(history, k.column)].unit;
    study.columns.push_back(
        {k.of == SweepOf::end
             ? k.column
             : fmt::format("{}@{}", k.column, words_of_what[static_cast<std::size_t>(k.of)]),
         unit});
  }

  if (!options.keep) return;
  std::string fingerprint = options.fingerprint;
  for (const Column& column : study.columns) fingerprint += ";" + column.name;
  const std::string name =
      study.share.of > 1 ? fmt::format("sweep.{}-of-{}.rows", study.share.number, study.share.of)
                         : "sweep.rows";
  inside_->rows.emplace(*options.keep, name, fingerprint, study.columns.size());
  fill();
  study.found = study.rows.size() - study.count(Status::open) - study.count(Status::lost);
}

SweepTable::~SweepTable() = default;

const SweepStudy& SweepTable::study() const { return inside_->study; }

void SweepTable::fill() {
  for (std::size_t point = 0; point < inside_->study.rows.size(); ++point)
    if (const SweepRow* found = inside_->rows->find(key_of(inside_->study.plan, point)))
      inside_->study.rows[point] = *found;
}

std::vector<std::size_t> SweepTable::open() const {
  const SweepStudy& study = inside_->study;
  std::vector<std::size_t> points;
  for (std::size_t point = study.share.number - 1; point < study.rows.size();
       point += study.share.of)
    if (const Status status = study.rows[point].status;
        status == Status::open || status == Status::lost)
      points.push_back(point);
  return points;
}

void SweepTable::add(std::size_t point, SweepRow row) {
  if (inside_->rows) inside_->rows->add(key_of(inside_->study.plan, point), row);
  inside_->study.rows[point] = std::move(row);
}

void SweepTable::look_again() {
  if (!inside_->rows) return;
  inside_->rows->look_again();
  fill();
}

void SweepTable::leave() {
  if (inside_->rows) inside_->rows->leave();
}

void SweepTable::run(const ReadSweptModel& read, const SweepOptions& options) {
  if (options.jobs < 1 || options.jobs > 4096)
    throw Error(fmt::format("--jobs {}: give a number of processes from 1 to 4096", options.jobs));
  const auto begun = std::chrono::steady_clock::now();
  const SweepStudy& study = inside_->study;
  const std::vector<Kept> kept = kept_of(study.columns);
  std::vector<std::size_t> open = this->open();
  std::reverse(open.begin(), open.end());  // the last is begun first
  std::size_t done = study.rows.size() - study.count(Status::open) - study.count(Status::lost);
  const auto stopped = [&] { return options.interrupted != nullptr && *options.interrupted; };
  Children children;
  while (!stopped() && (!open.empty() || !children.all.empty())) {
    while (!open.empty() && children.all.size() < static_cast<std::size_t>(options.jobs)) {
      children.all.push_back(start_child(read, study.plan, open.back(), kept,
                                         inside_->rows ? &*inside_->rows : nullptr));
      open.pop_back();
    }
    std::vector<pollfd> ready;
    for (const Child& child : children.all) ready.push_back({child.end, POLLIN, 0});
    if (::poll(ready.data(), ready.size(), 200) <= 0) continue;  // or a signal
    for (std::size_t k = ready.size(); k-- > 0;) {
      if (ready[k].revents == 0) continue;
      Child& child = children.all[k];
      char piece[4096];
      const ssize_t got = ::read(child.end, piece, sizeof piece);
      if (got > 0) child.text.append(piece, static_cast<std::size_t>(got));
      if (got > 0 || (got < 0 && errno == EINTR)) continue;
      Child ended = std::move(child);
      children.all.erase(children.all.begin() + static_cast<std::ptrdiff_t>(k));
      add(ended.point, end_of(ended, kept.size()));
      if (options.progress) options.progress(++done, study.rows.size());
    }
  }
  if (study.share.of > 1) look_again();
  inside_->study.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

SweepStudy study_sweep(const ReadSweptModel& read, const SweepPlan& plan,
                       const SweepOptions& options) {
  SweepTable table(read, plan, options);
  table.run(read, options);
  return table.study();
}

SweepRow run_point(const ReadSweptModel& read, const Overrides& values,
                   const std::vector<Column>& columns) {
  return run_here(read, values, kept_of(columns));
}

std::string to_text(const SweepStudy& study) {
  const auto count = [&study](Status status) { return study.count(status); };
  std::string text = fmt::format(
      "{}: {}{} points, {} done{}{}{}{}{}; {:.3g} s\n", study.model,
      study.share.of > 1 ? fmt::format("share {}/{}; of ", study.share.number, study.share.of) : "",
      study.rows.size(), count(Status::done),
      study.found > 0 ? fmt::format(" ({} rows found of an earlier sweep)", study.found) : "",
      count(Status::failed) > 0 ? fmt::format(", {} failed", count(Status::failed)) : "",
      count(Status::refused) > 0 ? fmt::format(", {} refused", count(Status::refused)) : "",
      count(Status::lost) > 0 ? fmt::format(", {} lost", count(Status::lost)) : "",
      count(Status::open) > 0 ? fmt::format(", {} not begun or not ended", count(Status::open))
                              : "",
      study.seconds);
  constexpr std::size_t most = 5;
  std::size_t shown = 0;
  for (std::size_t point = 0; point < study.rows.size(); ++point) {
    const SweepRow& row = study.rows[point];
    if (row.status == Status::open || row.status == Status::done) continue;
    if (++shown > most) {
      text += "  …\n";
      break;
    }
    text += wrapped(fmt::format("  {} at {}: ", word_of(row.status), key_of(study.plan, point)),
                    row.message, 4) +
            "\n";
  }
  return text;
}

std::string to_csv(const SweepStudy& study) {
  std::string text = fmt::format("# mbd sweep of {} ({})\n", study.model, study.file);
  if (!study.command.empty()) text += "# " + study::one_line(study.command) + "\n";
  const auto unit_cell = [](const std::string& unit) {
    return unit.empty() ? std::string("1") : unit;
  };
  std::string names = "point", units = "# units: 1";
  std::vector<std::string> parameter_units;
  for (std::size_t i = 0; i < study.plan.parameters.size(); ++i) {
    parameter_units.push_back(study.plan.unit(i));
    names += "," + study.plan.parameters[i];
    units += ", " + unit_cell(parameter_units.back());
  }
  names += ",status";
  units += ", -";
  for (const Column& column : study.columns) {
    names += "," + column.name;
    units += ", " + unit_cell(column.unit);
  }
  text += units + ", s, s, -\n" + names + ",t,cpu,message\n";
  for (std::size_t point = 0; point < study.rows.size(); ++point) {
    const SweepRow& row = study.rows[point];
    text += std::to_string(point + 1);
    for (std::size_t i = 0; i < study.plan.parameters.size(); ++i) {
      std::string_view value = study.plan.points[point][i];
      if (const std::string& unit = parameter_units[i]; !unit.empty())
        value = trimmed(value.substr(0, value.size() - unit.size()));
      text += "," + study::csv_cell(value);
    }
    text += "," + std::string(word_of(row.status));
    for (std::size_t c = 0; c < study.columns.size(); ++c)
      text += row.status == Status::done ? fmt::format(",{}", row.values[c]) : ",";
    text += row.status == Status::open ? ",,,\n"
                                       : fmt::format(",{},{:.3f},{}\n", row.t, row.cpu,
                                                     study::csv_cell(study::one_line(row.message)));
  }
  return text;
}

}  // namespace mbd
