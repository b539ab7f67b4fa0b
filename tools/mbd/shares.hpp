// Sweeps beyond one process: who this process is among ranks that a launcher has started, and jobs of Slurm. Nothing is linked for
// it: launchers say it in the environment, and Slurm has commands.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/study/sweep/sweep.hpp"

namespace mbd {

struct Rank {
  std::size_t index = 0, count = 1;  // from 0
  std::string_view launcher;         // "Open MPI"
};

// Of Open MPI, of what speaks PMI (MPICH, Intel MPI), or of srun; none: started alone. `variable` gives a variable of the
// environment, or nullptr. Throws Error for numbers that are none.
std::optional<Rank> rank_of(const std::function<const char*(const char*)>& variable);

// As a shell reads them, each word as it is.
std::string shell_line(const std::vector<std::string>& words);

struct SlurmJob {
  std::vector<std::string> command;  // of a task, without its share
  std::vector<std::size_t> numbers;  // of the tasks that have something to do
  std::size_t tasks = 1;             // in all
  int jobs = 1;                      // processes of a task
  std::filesystem::path logs;        // directory, gets slurm-N.log of task N
  std::vector<std::string> options;  // of sbatch
};

// Its id. Throws Error where there is no sbatch, or with what that says.
std::string submit(const SlurmJob& job);

// Waits until done(), or until no task of the job runs or may still run; then returns how they ended, in the words of Slurm ("1
// COMPLETED, 1 FAILED"), empty where it knows no more.
std::string wait_for(const std::string& id, const std::function<bool()>& done);

void cancel(const std::string& id);

}  // namespace mbd
