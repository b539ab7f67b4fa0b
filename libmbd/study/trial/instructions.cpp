#include "libmbd/study/trial/instructions.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "libmbd/core/error.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {

double count_instructions(const std::vector<std::string>& command) {
  std::vector<std::string> words = {"valgrind", "--tool=callgrind",
                                    "--callgrind-out-file=/dev/null"};
  words.insert(words.end(), command.begin(), command.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error(fmt::format("no pipe to valgrind: {}", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child == 0) {
    const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  std::string text;
  if (child > 0) {
    std::array<char, 4096> piece{};
    for (;;) {
      const ssize_t got = ::read(ends[0], piece.data(), piece.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      text.append(piece.data(), static_cast<std::size_t>(got));
    }
  }
  ::close(ends[0]);
  if (child < 0) throw Error(fmt::format("no process for valgrind: {}", std::strerror(errno)));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw Error("instructions are counted by valgrind, which is not there; install it");
  if (text.find("unrecognised instruction") != std::string::npos ||
      text.find("SIGILL") != std::string::npos)
    throw Error(
        "valgrind does not know the instructions of this build; count them in one with "
        "-DCMAKE_CXX_FLAGS=-march=x86-64-v2");
  constexpr std::string_view label = "Collected : ";
  const std::size_t at = text.rfind(label);
  double count = 0.0;
  if (at != std::string::npos) {
    const char* const begin = text.data() + at + label.size();
    std::from_chars(begin, text.data() + text.size(), count);
  }
  // Status 2 is that of a run which does not meet what it expects.
  if (!(count > 0.0) || !WIFEXITED(status) ||
      (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != 2))
    throw Error(
        fmt::format("{} failed under valgrind: {}", command.empty() ? "" : command.front(),
                    excerpt(text.substr(text.size() - std::min<std::size_t>(text.size(), 300)))));
  return count;
}

}  // namespace mbd
