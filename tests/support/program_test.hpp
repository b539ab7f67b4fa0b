// A test that runs the program mbd in a directory of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test {

// A Python that has these modules; "" if there is none.
inline std::string python_with(const std::string& modules) {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (shell(std::string(python) + " -c " + quote("import " + modules)).status == 0) return python;
  return {};
}

class ProgramTest : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name) const { return directory_.path() / name; }

  // A command line of a shell, in that directory.
  Output here(const std::string& command) const {
    return shell("cd " + quote(directory_.path().string()) + " && " + command);
  }
  Output mbd(const std::string& words) const { return here(quote(mbd_program) + " " + words); }

  // A model of that directory, or else of models/, run with its results in a directory of its name.
  void run(const std::string& name, const std::string& options = "") const {
    const std::filesystem::path own = file(name + ".xml"),
                                model = std::filesystem::exists(own)
                                            ? own
                                            : std::filesystem::path(MBD_SOURCE_DIR) / "models" /
                                                  (name + ".xml");
    const Output ran = mbd("run " + quote(model.string()) + " --no-estimate --quiet --out " + name +
                           " " + options);
    ASSERT_EQ(ran.status, 0) << ran.text;
  }

  TemporaryDirectory directory_;
};

// 20 km from the origin, in mm: an arm of two beams that swings and bends.
inline constexpr const char* far_away = R"(<mbd name="far">
  <section name="s"><stiffness EA="100 kN" GA2="40 kN" GA3="40 kN" GJ="80 N.mm2" EI2="0.5" EI3="0.5"/>
    <mass per_length="1 g/mm" inertia="1e-4 5e-5 5e-5"/></section>
  <beam name="one" section="s" from="2e7-400 0 1e7 mm" to="2e7 0 1e7 mm" normal="0 0 1" elements="2"/>
  <beam name="two" section="s" from="2e7 0 1e7 mm" to="2e7 300 1e7 mm" normal="0 0 1"/>
  <revolute name="root" between="ground one.start" at="2e7-400 0 1e7 mm" axis="0 1 0"/>
  <fixed name="corner" between="one.end two.start"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="0.2" step="2 ms" rho_infinity="0.8"/>
  <record name="tip" at="two.end" quantities="displacement position"/>
</mbd>)";

// A joint that does not close, by 50 mm: on its line 6.
inline constexpr const char* open_hinge = R"(<mbd name="open"><section name="s">
      <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="a" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <beam name="b" section="s" from="1.03 0.04 0" to="2 0 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground a.start"/>
    <revolute name="hinge" between="a.end b.start" axis="0 0 1"/><static/></mbd>)";

}  // namespace mbd::test
