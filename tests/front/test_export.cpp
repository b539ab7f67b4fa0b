// Files for other programs: run.h5, read by h5py and pandas, and files of VTK, read by VTK's own readers, against history.csv,
// motion.bin and closed forms. The scripts beside this file do the reading.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/program_test.hpp"

namespace mbd::test::test_export {
namespace {

namespace fs = std::filesystem;

const fs::path source = MBD_SOURCE_DIR, models = source / "models",
               scripts = source / "tests/front";

void expect_says(const std::string& text, const std::vector<std::string>& all) {
  for (const std::string& one : all)
    EXPECT_NE(text.find(one), std::string::npos) << one << "\nin: " << text;
}

class Exported : public ProgramTest {
 protected:
  Output script(const std::string& name, const std::string& words) const {
    return here(python_ + " " + quote((scripts / name).string()) + " " + words);
  }
  void require_python(const std::string& modules, const std::string& packages) {
    python_ = python_with(modules);
    if (python_.empty())
      GTEST_SKIP() << "there is no Python with " << modules << "; install " << packages
                   << " (tools/install-dependencies --with-python does)";
  }

  std::string python_;
};

// ---- run.h5 ------------------------------------------------------------------------------------

class RunFileTest : public Exported {
 protected:
  void SetUp() override {
    write_text(file("one.xml"),
               R"(<mbd name="one"><body name="b" mass="1" inertia="1 1 1"/>
      <transient duration="1" step="1"/><record name="b" at="b" quantities="position"/></mbd>)");
    if (const Output output = mbd("run one.xml -q -o one --hdf5"); output.status != 0) {
      expect_says(output.text, {"run.h5", "libhdf5-dev"});
      GTEST_SKIP() << "this mbd writes no HDF5: " << output.text;
    }
  }
  void require_h5py() { require_python("h5py, numpy, pandas", "python3-h5py and python3-pandas"); }

  void expect_same(const std::string& model, const std::string& words = "") const {
    SCOPED_TRACE(model);
    run(model, "--hdf5 " + words);
    const Output read =
        script("read_run.py", model + " " + quote((models / model).string() + ".xml"));
    EXPECT_EQ(read.status, 0) << read.text;
  }
};

// With a transient in steps fixed and adaptive, frames of their own, load steps, a path; with beams, bodies, joints, none.
TEST_F(RunFileTest, HoldsTheRun) {
  require_h5py();
  if (IsSkipped()) return;
  expect_same("pendulum");
  expect_same("elastica");
  expect_same("shallow_arch");
  expect_same("every_joint", "--frames 21");
  expect_same("swept_cantilever");
  expect_same("rigid_frame", "--frames 11");
  expect_same("four_bar", "--frames 401");
  // What is compared is seen: a digit of the history, a row of the motion.
  std::string text = read_text(file("pendulum/history.csv"));
  text[text.rfind(',') + 3] ^= 1;
  write_text(file("pendulum/history.csv"), text);
  EXPECT_NE(script("read_run.py", "pendulum").status, 0);
  fs::resize_file(file("elastica/motion.bin"), fs::file_size(file("elastica/motion.bin")) - 8);
  EXPECT_NE(script("read_run.py", "elastica").status, 0);
}

// Long enough to be looked at: frames of a beam and a joint, rows of 1 ms.
constexpr const char* long_run = R"(<mbd name="long"><parameter name="T" value="1000"/>
    <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="1" inertia="1e-2 5e-3 5e-3"/></section>
    <beam name="rod" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
    <revolute name="hinge" between="ground rod.start" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="T" step="1e-3"/>
    <record name="tip" at="rod.end" quantities="position"/></mbd>)";

// It is read while the run goes on, again and again, and after SIGKILL.
TEST_F(RunFileTest, IsReadWhileTheRunGoesOnAndAfterAKill) {
  require_h5py();
  if (IsSkipped()) return;
  write_text(file("long.xml"), long_run);
  for (const int rounds : {0, 3}) {
    Program program({"run", file("long.xml").string(), "--hdf5", "-q", "-o", file("out").string()},
                    file("program"));
    std::error_code code;
    const auto wait_for = [&](std::uintmax_t size) {
      while (!program.ended() && !(fs::file_size(file("out/run.h5"), code) > size && !code))
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    };
    wait_for(3'000'000);
    while (!program.ended() && std::atoi(script("read_run.py", "--killed out").text.c_str()) < 200)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    int before = 0;
    for (int round = 0; round < rounds; ++round) {
      const Output read = script("read_run.py", "--killed out");
      EXPECT_EQ(read.status, 0) << read.text;
      const int rows = std::atoi(read.text.c_str());
      EXPECT_GE(rows, before);
      before = rows;
      // flushed twice a second
      std::this_thread::sleep_for(std::chrono::milliseconds(700));
    }
    EXPECT_FALSE(program.ended());
    program.signal(SIGKILL);
    ASSERT_EQ(program.wait().status, -SIGKILL);
    const Output read = script("read_run.py", "--killed out");
    EXPECT_EQ(read.status, 0) << read.text;
    EXPECT_GT(std::atoi(read.text.c_str()), 100) << read.text;
  }
}

// An interrupted run closes it: with its report, and for any reader.
TEST_F(RunFileTest, IsClosedByAnInterrupt) {
  require_h5py();
  if (IsSkipped()) return;
  write_text(file("long.xml"), long_run);
  Program program({"run", file("long.xml").string(), "--hdf5", "-q", "-o", file("out").string()},
                  file("program"));
  std::error_code code;
  while (!program.ended() && !(fs::file_size(file("out/run.h5"), code) > 300'000 && !code))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().status, 1);
  const Output read = script("read_run.py", "out");
  EXPECT_EQ(read.status, 0) << read.text;
  const Output plain = shell(python_ + " -c " +
                             quote("import h5py; h5py.File(" + ("'" + file("out/run.h5").string()) +
                                   "', 'r')['report'][0]"));
  EXPECT_EQ(plain.status, 0) << plain.text;
}

// A file that may not grow ends the run with its name, and holds what was written before.
TEST_F(RunFileTest, SaysThatTheDiskIsFull) {
  write_text(file("long.xml"), long_run);
  const Output output =
      bash("cd " + quote(directory_.path().string()) + "; trap '' XFSZ; ulimit -f 1500; exec " +
           quote(mbd_program) + " run long.xml --hdf5 -q -o out --set T=20 --no-estimate");
  EXPECT_EQ(output.status, 1) << output.text;
  expect_says(output.text, {"cannot be written (File too large)"});
  EXPECT_LE(fs::file_size(file("out/run.h5")), 1'536'000U);
  expect_says(read_text(file("out/report.json")), {"cannot be written (File too large)"});
  require_h5py();
  if (IsSkipped()) return;
  const Output read = script("read_run.py", "--killed out");
  EXPECT_EQ(read.status, 0) << read.text;
  EXPECT_GT(std::atoi(read.text.c_str()), 100) << read.text;
}

TEST_F(RunFileTest, SaysThatItCannotBeWritten) {
  fs::create_directories(file("out/run.h5/x"));
  const Output output = mbd("run one.xml -q -o out --hdf5");
  EXPECT_EQ(output.status, 1);
  expect_says(output.text, {"out/run.h5: cannot be written"});
}

// libhdf5 is loaded where such a file is written, and nowhere else; an older file does not stay beside newer results.
TEST_F(RunFileTest, OffCostsNothing) {
  const auto loads = [&](const std::string& words) {
    return here("LD_DEBUG=files " + quote(mbd_program) + " run one.xml -q -o one " + words)
               .text.find("hdf5") != std::string::npos;
  };
  EXPECT_TRUE(loads("--hdf5"));
  EXPECT_TRUE(fs::exists(file("one/run.h5")));
  EXPECT_FALSE(loads("--motion"));
  EXPECT_FALSE(fs::exists(file("one/run.h5")));
}

// Letters beyond ASCII in the text, a parameter that is no decimal, files that are included.
TEST_F(RunFileTest, TextAndParametersAreKept) {
  require_h5py();
  if (IsSkipped()) return;
  write_text(file("names.xml"), R"(<mbd name="a-b"><!-- Größe -->
    <parameter name="k" value="1/3"/><include file="part.xml"/><transient duration="1" step="0.5"/>
    <record name="b_1-x" at="b-1" quantities="position rotation"/></mbd>)");
  write_text(file("part.xml"),
             R"(<mbd name="part"><body name="b-1" mass="1" inertia="1 1 1"/></mbd>)");
  const Output output = mbd("run names.xml -q -o out --hdf5");
  ASSERT_EQ(output.status, 0) << output.text;
  const Output read = script("read_run.py", "out names.xml");
  EXPECT_EQ(read.status, 0) << read.text;
  const Output look = here(
      python_ + " -c " +
      quote("import h5py; run = h5py.File('out/run.h5'); assert run['parameters'].attrs['k'] == "
            "1/3; assert run['model/include_1'][()] == open('part.xml', 'rb').read()"));
  EXPECT_EQ(look.status, 0) << look.text;
}

// Each model of the repository that runs in a few seconds.
class RunFileTestSlow : public RunFileTest {};
TEST_F(RunFileTestSlow, HoldsTheRunOfEveryModel) {
  require_h5py();
  if (IsSkipped()) return;
  for (const char* name : {"bend45",
                           "bushing",
                           "chain",
                           "composite",
                           "damped_beam",
                           "damped_oscillator",
                           "double_pendulum",
                           "dzhanibekov",
                           "four_bar_static",
                           "heavy_top",
                           "lee_frame",
                           "portal_frame",
                           "princeton",
                           "right_angle_frame",
                           "roll_up",
                           "shaft",
                           "slider_crank",
                           "submerged_beam",
                           "terminal_velocity",
                           "torsion_pendulum"})
    expect_same(name);
}

// ---- files of VTK ------------------------------------------------------------------------------

class VtkFilesTest : public Exported {
 protected:
  void require_vtk() { require_python("vtk, numpy", "python3-vtk9"); }

  void expect_same(const std::string& model, const std::string& words = "--motion",
                   int least_compared = 1) const {
    SCOPED_TRACE(model);
    const Output ran = mbd("run " + quote((models / model).string() + ".xml") + " -q -o " + model +
                           " --no-estimate " + words);
    ASSERT_EQ(ran.status, 0) << ran.text;
    const Output made = mbd("export " + model + " --vtk drawn --frames 30");
    ASSERT_EQ(made.status, 0) << made.text;
    const Output read = script("read_vtk.py", "drawn/" + model + ".pvd " + model);
    EXPECT_EQ(read.status, 0) << read.text;
    EXPECT_GE(std::atoi(read.text.substr(read.text.find(',') + 1).c_str()), least_compared)
        << read.text;
  }
};

TEST_F(VtkFilesTest, AreTheMotion) {
  require_vtk();
  if (IsSkipped()) return;
  expect_same("four_bar");
  expect_same("swept_cantilever");
  expect_same("shallow_arch");
  expect_same("pendulum");
  expect_same("rigid_frame");
  expect_same("every_joint", "--frames 21", 0);
  // What is compared is seen: another run is not this one.
  mbd("run " + quote((models / "pendulum.xml").string()) +
      " -q -o pendulum --no-estimate --motion --set step=2e-3");
  EXPECT_NE(script("read_vtk.py", "drawn/pendulum.pvd pendulum").status, 0);
}

class VtkFilesTestSlow : public VtkFilesTest {};
TEST_F(VtkFilesTestSlow, AreTheMotionOfEveryModel) {
  require_vtk();
  if (IsSkipped()) return;
  const std::set<std::string> in_the_quick_test{"four_bar", "swept_cantilever", "shallow_arch",
                                                "pendulum", "rigid_frame",      "every_joint"};
  for (const fs::directory_entry& entry : fs::directory_iterator(models))
    if (const std::string name = entry.path().stem().string();
        entry.path().extension() == ".xml" && !in_the_quick_test.contains(name))
      expect_same(name, "--motion", 0);
}

// A thin cantilever under N along and a small Q across: strains N/EA and Q/GA3, curvature -Q (L - s)/EI2, lengths of 2 m;
// tube or box by its radii of gyration: of EI2 = EI3 = EA d^2/16, and of sides b2, b3 with EI3 = EA b2^2/12.
TEST_F(VtkFilesTest, StrainsAndOutlinesAreThoseOfACantilever) {
  require_vtk();
  if (IsSkipped()) return;
  write_text(file("strip.xml"), R"(<mbd name="strip"><section name="s">
    <stiffness EA="1e6" GA2="4e5" GA3="2e5" GJ="80" EI2="100" EI3="900"/></section>
    <section name="t"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="b" section="s" from="1 2 3" to="3 2 3" normal="0 0 1" elements="3" order="4"/>
    <beam name="tube" section="t" from="0 0 0" to="0 1 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/><fixed name="foot" between="ground tube.start"/>
    <load at="b.end" force="1e-2 0 2e-2"/><static/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  ASSERT_EQ(mbd("run strip.xml --motion -q -o strip").status, 0);
  ASSERT_EQ(mbd("export strip --vtk drawn").status, 0);
  write_text(file("look.py"), R"py(
import glob, sys, vtk, numpy
from vtk.util.numpy_support import vtk_to_numpy
def read(kind):
    reader = vtk.vtkXMLPolyDataReader(); reader.SetFileName(sorted(glob.glob("drawn/strip/" + kind + "_*"))[-1]); reader.Update()
    grid = reader.GetOutput()
    return lambda name: vtk_to_numpy(grid.GetPointData().GetArray(name)) if name else vtk_to_numpy(grid.GetPoints().GetData())
of = read("stations")
on = of("part") == 0; s = of("s")[on]; strain, curvature = of("strain")[on], of("curvature")[on]
assert len(s) == 12 and len(of("s")) == 15
assert abs(strain[:, 0] / (1e-2 / 1e6) - 1).max() < 1e-3, strain
assert abs(strain[:, 2] / (2e-2 / 2e5) - 1).max() < 1e-3, strain
assert abs(curvature[:, 1] - -2e-2 * 2.0 * (1 - s) / 100).max() < 1e-3 * 4e-4, curvature
assert abs(of("strain")[~on]).max() < 1e-15
of = read("outlines")
where = of("") - of("displacement")
box, tube = where[of("part") == 0], where[of("part") == 1]
size = box.max(axis=0) - box.min(axis=0)
b2, b3 = (12 * 900 / 1e6) ** 0.5, (12 * 100 / 1e6) ** 0.5
# normal: axis 3 is along z, axis 2 along y
assert abs(size - [2, b2, b3]).max() < 1e-3 * b3, (size, b2, b3)
d = 4 * (100 / 1e6) ** 0.5
radii = numpy.hypot(tube[:, 0], tube[:, 2])
assert abs(radii - d / 2).max() < 1e-6, radii
)py");
  const Output looked = here(python_ + " look.py");
  EXPECT_EQ(looked.status, 0) << looked.text;
}

// Of viscous sections resultants are not elastic alone, so strains are not said.
TEST_F(VtkFilesTest, StrainsOfDampedSectionsAreLeftOut) {
  for (const char* damping : {"", R"(<damping stiffness_proportional="0.1"/>)"}) {
    write_text(file("bar.xml"), fmt::format(R"(<mbd name="bar"><section name="s">
    <stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="1e-2 5e-3 5e-3"/>{}</section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/><load at="b.end" force="100*sin(20*t) 0 0"/>
    <transient duration="0.02" step="1e-3"/>
    <record name="in" at="b.end" quantities="force"/></mbd>)",
                                            damping));
    ASSERT_EQ(mbd("run bar.xml --motion --no-estimate -q -o bar").status, 0);
    ASSERT_EQ(mbd("export bar --vtk drawn").status, 0);
    const std::string text = read_text(file("drawn/bar/stations_000000.vtp"));
    expect_says(text, {"Name=\"force\"", "compressor=\"vtkZLibDataCompressor\""});
    EXPECT_EQ(text.find("Name=\"strain\"") != std::string::npos, *damping == '\0');
  }
}

// A model before a run: one frame, without what a run gives.
TEST_F(VtkFilesTest, AModelIsItsReferenceConfiguration) {
  const Output made =
      mbd("export " + quote((models / "four_bar.xml").string()) + " --vtk drawn --set tilt=0");
  EXPECT_EQ(made.status, 0) << made.text;
  expect_says(made.text, {"drawn/four_bar.pvd", "the reference configuration", "ParaView"});
  const std::string list = read_text(file("drawn/four_bar.pvd"));
  for (const char* kind : {"nodes", "lines", "outlines", "joints", "places"}) {
    expect_says(list, {fmt::format("file=\"four_bar/{}_000000.vt", kind)});
    EXPECT_TRUE(fs::exists(file(fmt::format("drawn/four_bar/{}_000000.{}", kind,
                                            std::string(kind) == "lines" ? "vtu" : "vtp"))));
  }
  EXPECT_EQ(list.find("stations"), std::string::npos);
  expect_says(read_text(file("drawn/four_bar/parts.csv")), {"part,kind,name\n0,beam,bar1\n"});
}

TEST_F(VtkFilesTest, SayWhatIsWrong) {
  const std::string pendulum = quote((models / "pendulum.xml").string());
  ASSERT_EQ(mbd("run " + pendulum + " -q -o kept --frames 50 --no-estimate").status, 0);
  ASSERT_EQ(mbd("run " + pendulum + " -q -o bare --no-estimate").status, 0);
  write_text(file("taken"), "");
  write_text(file("open.xml"), R"(<mbd name="open"><body name="b" mass="1" inertia="1 1 1"/>
    <revolute name="r" between="ground b" at_a="0 0 0" at_b="1 0 0" axis="0 0 1"/>
    <transient duration="1" step="1"/></mbd>)");
  struct Case {
    std::string words;
    std::vector<std::string> says;
    int status = 1;
  };
  for (const Case& c : std::vector<Case>{
           {"export bare --vtk d", {"bare/motion.bin", "--motion"}},
           {"export kept", {"--vtk DIR"}},
           {"export kept --vtk taken", {"--vtk taken", "there is a file of this name"}},
           {"export kept --vtk d --set g=1", {"--set g=1", "these are results"}},
           {"export kept --vtk d --frames 1", {"--frames 1", "whole number from 2"}},
           {"export kept --vtk d --frames x", {"--frames x"}},
           {"export " + pendulum + " --vtk d --frames 5", {"a model has no frames"}},
           {"export nowhere.xml --vtk d", {"nowhere.xml"}},
           {"export open.xml --vtk d", {"open.xml:2", "revolute \"r\""}},
           {"export kept --vtk ''", {"--vtk", "is empty"}, 105},
           {"export --vtk d", {"MODEL_OR_DIR"}, 106}}) {
    SCOPED_TRACE(c.words);
    const Output output = mbd(c.words);
    if (c.status == 1) {
      EXPECT_EQ(output.status, 1);
    } else {
      EXPECT_GE(output.status, 100);
    }
    expect_says(output.text, c.says);
  }
  EXPECT_FALSE(fs::exists(file("d")));
  const Output few = mbd("export kept --vtk some --frames 11");
  EXPECT_EQ(few.status, 0) << few.text;
  expect_says(few.text, {"11 of 50 frames", "--frames N for more"});
  const Output full =
      bash("cd " + quote(directory_.path().string()) + "; trap '' XFSZ; ulimit -f 1; exec " +
           quote(mbd_program) + " export kept --vtk full");
  EXPECT_EQ(full.status, 1);
  expect_says(full.text, {"full/pendulum", "cannot be written (File too large)"});
  for (const auto& entry : fs::recursive_directory_iterator(file("full")))
    EXPECT_NE(entry.path().extension(), ".part");
}

}  // namespace
}  // namespace mbd::test::test_export
