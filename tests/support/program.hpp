// Runs the program mbd, and watches how it ends.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/machine.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// What a program left behind.
struct Ended {
  int status = -1;  // exit status; negative: of a signal, which is -status
  bool hung = false;
  std::string out, err;
  double cpu = 0.0;  // [s]
  long memory = 0;   // largest resident set [kB]
};

// The program under way, in the present directory; its output is kept in two files beside `scratch`. Signals do with it
// what they usually do, also where the tests were started to ignore some (as a job in the background).
class Program {
 public:
  Program(const std::vector<std::string>& arguments, std::filesystem::path scratch)
      : scratch_(std::move(scratch)) {
    std::vector<std::string> all = {mbd_program};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& argument : all) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out().c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err().c_str(), flags, 0600);
    sigset_t usual;
    sigemptyset(&usual);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&usual, signal);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int failed = posix_spawn(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot start " + all[0]);
  }
  Program(Program&& other) noexcept
      : scratch_(std::move(other.scratch_)),
        pid_(other.pid_),
        begun_(other.begun_),
        ended_(std::move(other.ended_)) {
    other.pid_ = 0;
  }
  Program& operator=(Program&&) = delete;
  ~Program() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  // Whether it has ended. One that hangs is made to.
  bool ended() {
    if (pid_ <= 0) return true;
    int status = 0;
    rusage use{};
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
    if (passed.count() > guard(longest)) {
      ended_.hung = true;
      kill(pid_, SIGKILL);
    }
    if (wait4(pid_, &status, ended_.hung ? 0 : WNOHANG, &use) != pid_) return false;
    pid_ = 0;
    ended_.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    ended_.cpu = seconds(use.ru_utime) + seconds(use.ru_stime);
    ended_.memory = use.ru_maxrss;
    ended_.out = contents(out());
    ended_.err = contents(err());
    std::filesystem::remove(out());
    std::filesystem::remove(err());
    return true;
  }

  void signal(int number) {
    if (pid_ > 0) kill(pid_, number);
  }

  const Ended& wait() {
    while (!ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return ended_;
  }

 private:
  static constexpr double longest = 400.0;  // [s]; none takes a twentieth of it on a quick machine

  std::string out() const { return scratch_.string() + ".out"; }
  std::string err() const { return scratch_.string() + ".err"; }

  std::filesystem::path scratch_;
  pid_t pid_ = 0;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  Ended ended_;
};

}  // namespace mbd::test
