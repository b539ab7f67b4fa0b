#include "tools/mbd/shares.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <string_view>
#include <thread>

#include "libmbd/core/error.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

struct Launcher {
  const char *index, *count;
  std::string_view name;
};
// srun says the size of its own step; SLURM_NTASKS is that of the job, which a batch script has too, without ranks.
constexpr std::array launchers = {
    Launcher{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "Open MPI"},
    Launcher{"PMI_RANK", "PMI_SIZE", "MPI"},
    Launcher{"SLURM_PROCID", "SLURM_STEP_NUM_TASKS", "srun"}};

std::size_t rank_number(const char* name, const char* text) {
  std::size_t value = 0;
  const char* const end = text + std::strlen(text);
  const auto [at, code] = std::from_chars(text, end, value);
  if (code != std::errc() || at != end)
    throw Error(fmt::format("{}={} in the environment is no number; unset it, or give --share 1/1",
                            name, excerpt(text)));
  return value;
}

struct Said {
  std::string text;  // both streams
  int status = 0;    // as a shell has it
};
Said ask(const std::vector<std::string>& words) {
  Said said;
  std::FILE* const pipe = ::popen((shell_line(words) + " 2>&1").c_str(), "re");
  if (pipe == nullptr) throw Error(fmt::format("{}: cannot be started", words.front()));
  char piece[4096];
  for (std::size_t n = 0; (n = std::fread(piece, 1, sizeof piece, pipe)) > 0;)
    said.text.append(piece, n);
  const int status = ::pclose(pipe);
  said.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  said.text = std::string(trimmed(said.text));
  return said;
}

constexpr int not_found = 127;  // of a shell

}  // namespace

std::optional<Rank> rank_of(const std::function<const char*(const char*)>& variable) {
  for (const Launcher& launcher : launchers) {
    const char* const index = variable(launcher.index);
    const char* const count = variable(launcher.count);
    if (index == nullptr || count == nullptr) continue;
    const Rank rank{rank_number(launcher.index, index), rank_number(launcher.count, count),
                    launcher.name};
    if (rank.index >= rank.count)
      throw Error(
          fmt::format("{}={} and {}={} in the environment: ranks count from 0; unset them, "
                      "or give --share 1/1",
                      launcher.index, index, launcher.count, count));
    if (rank.count > 1) return rank;
  }
  return std::nullopt;
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    line += line.empty() ? "'" : " '";
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

std::string submit(const SlurmJob& job) {
  std::string numbers;
  if (job.numbers.size() == job.tasks) {
    numbers = fmt::format("1-{}", job.tasks);
  } else {
    numbers = fmt::format("{}", fmt::join(job.numbers, ","));
  }
  std::string logs = std::filesystem::absolute(job.logs).string();
  for (std::size_t at = 0; (at = logs.find('%', at)) != std::string::npos; at += 2)
    logs.insert(at, "%");
  std::vector<std::string> words = {"sbatch",
                                    "--parsable",
                                    "--job-name=mbd-sweep",
                                    "--array=" + numbers,
                                    fmt::format("--cpus-per-task={}", job.jobs),
                                    "--requeue",  // a share goes on where it stopped
                                    "--output=" + logs + "/slurm-%a.log"};
  words.insert(words.end(), job.options.begin(), job.options.end());
  words.push_back(fmt::format("--wrap=exec {} --share \"$SLURM_ARRAY_TASK_ID\"/{}",
                              shell_line(job.command), job.tasks));
  const Said said = ask(words);
  if (said.status == not_found)
    throw Error(
        "Slurm: there is no sbatch on PATH; go to a machine that submits to Slurm, or run here, "
        "without it");
  if (said.status != 0) throw Error("Slurm: sbatch refused: " + said.text);
  // "12" or "12;cluster", after warnings.
  const std::size_t line = said.text.rfind('\n') + 1;
  return said.text.substr(line, said.text.find(';', line) - line);
}

namespace {

// How many tasks are in which state; those that wait are one line.
std::map<std::string, int> states_in(const std::string& text) {
  std::map<std::string, int> states;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) ++states[line];
  return states;
}

// A task in another state runs, or may still run.
bool has_ended(const std::string& state) {
  constexpr std::array<std::string_view, 10> ended = {
      "COMPLETED", "CANCELLED", "FAILED",   "TIMEOUT",       "NODE_FAIL",
      "PREEMPTED", "BOOT_FAIL", "DEADLINE", "OUT_OF_MEMORY", "REVOKED"};
  return std::ranges::find(ended, state) != ended.end();
}

}  // namespace

std::string wait_for(const std::string& id, const std::function<bool()>& done) {
  constexpr int seconds_between_questions = 5;  // the controller is everybody's
  // A task that is begun again has ended for a moment. Slurm knows for minutes (MinJobAge) how tasks ended: that it knows nothing
  // of them is believed later.
  constexpr int answers_to_believe = 2, silences_to_believe = 6;
  int over = 0, silent = 0;
  std::string ends;
  for (int turn = 1; !done(); ++turn) {
    if (over == answers_to_believe || silent == silences_to_believe) return ends;
    std::this_thread::sleep_for(std::chrono::seconds(1));
    if (turn % seconds_between_questions != 0) continue;
    const Said said = ask({"squeue", "--noheader", "--states=all", "--jobs=" + id, "--format=%T"});
    if (said.status != 0 || said.text.empty()) {
      // A controller that does not answer for a while is waited for.
      const bool knows_none =
          said.status == 0 || said.text.find("Invalid job id") != std::string::npos;
      silent = knows_none ? silent + 1 : 0;
      continue;
    }
    silent = 0;
    const auto states = states_in(said.text);
    const bool is_over =
        std::ranges::all_of(states, [](const auto& state) { return has_ended(state.first); });
    over = is_over ? over + 1 : 0;
    ends.clear();
    for (const auto& [state, count] : states)
      ends += fmt::format("{}{} {}", ends.empty() ? "" : ", ", count, state);
  }
  return {};
}

void cancel(const std::string& id) { ask({"scancel", id}); }

}  // namespace mbd
