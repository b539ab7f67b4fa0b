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
    return here(python_ + " -B " + quote((scripts / name).string()) + " " + words);
  }
  void require_python(const std::string& modules, const std::string& packages) {
    python_ = python_with(modules);
    if (python_.empty())
      GTEST_SKIP() << "there is no Python with " << modules << "; install " << packages
                   << " (tools/install-dependencies --with-python does)";
  }

  std::string python_;
};

// ---- campbell.h5 -------------------------------------------------------------------------------

TEST_F(Exported, CampbellDiagramsAreReadByH5py) {
  require_python("h5py, numpy, pandas", "python3-h5py and python3-pandas");
  if (IsSkipped()) return;
  const fs::path model = fs::path(MBD_SOURCE_DIR) / "models" / "shaft.xml";
  const std::string words = " --rates 0:70 --points 6 --without gravity -s d=0 --count 4";
  const Output made =
      mbd("campbell " + quote(model.string()) + words + " --hdf5 -o d -u shaft@0.5=\"20 g.cm\"");
  if (made.text.find("libhdf5") != std::string::npos) GTEST_SKIP() << made.text;
  ASSERT_EQ(made.status, 0) << made.text;
  expect_says(made.text, {"campbell.svg, campbell.csv, campbell.h5, unbalance.csv"});
  const Output read = script("read_campbell.py", "d " + quote(model.string()));
  EXPECT_EQ(read.status, 0) << read.text;
  expect_says(read.text, {"rates, 4 modes 53.5976"});  // its critical speed (test_campbell.cpp)
  // Of an older diagram nothing stays.
  ASSERT_EQ(mbd("campbell " + quote(model.string()) + words + " -q -o d").status, 0);
  EXPECT_FALSE(fs::exists(file("d/campbell.h5")));
  fs::create_directories(file("d/campbell.h5/x"));
  expect_says(mbd("campbell " + quote(model.string()) + words + " --hdf5 -q -o d").text,
              {"campbell.h5: cannot be written"});
}

// ---- linear.h5 ---------------------------------------------------------------------------------

TEST_F(Exported, LinearisedModelsAreReadByH5py) {
  require_python("h5py, numpy", "python3-h5py");
  if (IsSkipped()) return;
  const struct {
    const char *model, *words, *says;
  } cases[] = {
      {"cart_pole", "--at 0.5", "0 states"},
      {"shaft", "--rate 40 --axis 1 0 0 --without gravity", "states, "},
      {"four_bar", "", "states, "},
  };
  for (const auto& [name, words, says] : cases) {
    const fs::path model = fs::path(MBD_SOURCE_DIR) / "models" / (std::string(name) + ".xml");
    const Output made =
        mbd(fmt::format("linearize {} {} --hdf5 -o {}", quote(model.string()), words, name));
    if (made.text.find("libhdf5") != std::string::npos) GTEST_SKIP() << made.text;
    ASSERT_EQ(made.status, 0) << made.text;
    expect_says(made.text, {"F.mtx, linear.h5"});
    const Output read = script("read_linear.py", std::string(name) + " " + quote(model.string()));
    EXPECT_EQ(read.status, 0) << read.text;
    expect_says(read.text, {says});
  }
  // Of an older one nothing stays.
  const std::string model = quote((fs::path(MBD_SOURCE_DIR) / "models/four_bar.xml").string());
  ASSERT_EQ(mbd("linearize " + model + " -q -o four_bar").status, 0);
  EXPECT_FALSE(fs::exists(file("four_bar/linear.h5")));
}

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

// It ends when it is told to, however slow what looks at it: frames of a beam and a joint, a row for twenty steps (one for each
// was 10 GB before a busy machine had read it).
constexpr const char* long_run = R"(<mbd name="long"><parameter name="T" value="1e5"/>
    <parameter name="every" value="0.02"/>
    <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="1" inertia="1e-2 5e-3 5e-3"/></section>
    <beam name="rod" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
    <revolute name="hinge" between="ground rod.start" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="T" step="1e-3" output="every"/>
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
           quote(mbd_program) +
           " run long.xml --hdf5 -q -o out --set T=20 --set every=1e-3 --no-estimate");
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
// Component modes have some of the nodes of their beams, and no elements: lines through them. (Once a division by zero.)
TEST_F(VtkFilesTest, ComponentModesAreDrawnThroughTheirNodes) {
  write_text(file("arm.xml"), R"(<mbd name="arm"><section name="s">
      <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="300" EI2="400" EI3="400"/><mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4"/>
      <beam name="c" section="s" from="1 0 0" to="1 1 0" normal="0 0 1"/>
      <fixed name="f" between="ground b.start"/><fixed name="g" between="b.end c.start"/>
      <reduction name="r" of="b" modes="2"/><gravity acceleration="0 0 -1"/>
      <transient duration="0.1" step="0.001"/><record name="e" at="c.end" quantities="displacement"/></mbd>)");
  const Output ran = mbd("run arm.xml -q -o arm --motion --hdf5");
  EXPECT_EQ(ran.status, 0) << ran.text;
  for (const char* command : {"export arm --vtk drawn", "export arm.xml --vtk of_model",
                              "view arm -o arm.html", "view arm --image arm.png --colour M"}) {
    const Output made = mbd(command);
    EXPECT_EQ(made.status, 0) << command << "\n" << made.text;
  }
  EXPECT_TRUE(fs::exists(file("drawn/arm.pvd")));
}

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

// ---- stresses over sections ---------------------------------------------------------------------

// Reads the stresses of the last frame; x: places in the reference configuration, X2, X3: in the plane of the section.
constexpr const char* stress_reader = R"py(
import glob, numpy, vtk
from vtk.util.numpy_support import vtk_to_numpy
def stresses(name, axis1, axis2, axis3, part=0):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(sorted(glob.glob("drawn/%s/stresses_*.vtu" % name))[-1]); reader.Update()
    grid = reader.GetOutput(); data = grid.GetPointData()
    of = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).astype(float) for i in range(data.GetNumberOfArrays())}
    on = of["part"] == part
    x = vtk_to_numpy(grid.GetPoints().GetData()).astype(float) - of["displacement"]
    S = data.GetArray("stress")
    assert [S.GetComponentName(i) for i in range(6)] == ["11", "22", "33", "12", "23", "13"]
    # Cells: none is turned inside out, and together they are the bar.
    volume, kinds = 0.0, set()
    parts = vtk_to_numpy(grid.GetCellData().GetArray("part"))
    for c in range(grid.GetNumberOfCells()):
        if parts[c] != part: continue
        cell = grid.GetCell(c); n = cell.GetNumberOfPoints() // 2; kinds.add(n)
        assert cell.GetCellType() == {4: vtk.VTK_HEXAHEDRON, 3: vtk.VTK_WEDGE}[n]
        p = numpy.array([cell.GetPoints().GetPoint(i) for i in range(2 * n)])
        out = numpy.cross(p[1] - p[0], p[n - 1] - p[0]) @ (p[n] - p[0])
        assert (out > 0) if n == 4 else (out < 0), (c, out)  # VTK: of wedges the normal of the first triangle points outward
        area = abs(sum(0.5 * numpy.cross(p[i] - p[0], p[i + 1] - p[0]) for i in range(1, n - 1)) @ axis1)
        volume += area * abs((p[n] - p[0]) @ axis1)
    X = x[on]
    return X @ axis1, X @ axis2, X @ axis3, {k: v[on] for k, v in of.items()}, volume, kinds
def near(what, a, b, scale, bound):
    error = abs(a - b).max() / scale
    assert error < bound, (what, error)
)py";

class StressFilesTest : public VtkFilesTest {
 protected:
  // Runs a model, exports it and looks at its stresses.
  void look(const std::string& name, const std::string& script_text) const {
    const Output ran = mbd("run " + name + ".xml --motion -q -o " + name);
    ASSERT_EQ(ran.status, 0) << ran.text;
    const Output made = mbd("export " + name + " --vtk drawn --stresses");
    ASSERT_EQ(made.status, 0) << made.text;
    EXPECT_EQ(made.text.find("note"), std::string::npos) << made.text;
    write_text(file("look.py"), stress_reader + script_text);
    const Output looked = here(python_ + " look.py");
    EXPECT_EQ(looked.status, 0) << looked.text;
  }
};

// A round bar along y, bent by couples and pulled, twisted; and one with a force across: N/A + M2 x3/I - M3 x2/I, T r/J.
TEST_F(StressFilesTest, OfARoundBar) {
  require_vtk();
  if (IsSkipped()) return;
  write_text(file("round.xml"), R"(<mbd name="round"><parameter name="P" value="0.02 N"/>
    <material name="steel" E="200 GPa" nu="0.3"/>
    <section name="rod"><bar radius="10 mm" material="steel" tolerance="1e-6"/></section>
    <beam name="twisted" section="rod" from="0 0 0" to="0 0.5 0" normal="0 0 1" elements="2" order="3"/>
    <beam name="bent" section="rod" from="1 0 0" to="1 0.5 0" normal="0 0 1" elements="2" order="2"/>
    <fixed name="a" between="ground twisted.start"/><fixed name="b" between="ground bent.start"/>
    <load at="twisted.end" force="0 0.3 0" moment="0.003 0.002 -0.004"/>
    <load at="bent.end" force="0 0 P"/><static/>
    <record name="tip" at="bent.end" quantities="displacement"/></mbd>)");
  look("round", R"py(
# section axes: b1 along y, b3 along z, so b2 = b3 x b1 = -x
y, z, x = numpy.array([0, 1, 0]), numpy.array([0, 0, 1]), numpy.array([-1, 0, 0])
r, L = 0.01, 0.5
A, I = numpy.pi * r**2, numpy.pi * r**4 / 4
s, x2, x3, of, volume, kinds = stresses("round", y, x, z)
near("s", of["s"], s / L, 1, 1e-6)
near("volume", volume, A * L, A * L, 0.02)
assert abs(numpy.hypot(x2, x3).max() - r) < 1e-7
N, T, M2, M3 = 0.3, 0.002, -0.003, -0.004  # the moment (0.003, 0.002, -0.004) along b1 b2 b3
largest = N / A + 0.005 * r / I
S = of["stress"]
s11 = N / A + M2 * x3 / I - M3 * x2 / I
s12, s13 = -T * x3 / (2 * I), T * x2 / (2 * I)
near("11", S[:, 0], s11, largest, 2e-4)
near("12", S[:, 3], s12, largest, 2e-4)
near("13", S[:, 5], s13, largest, 2e-4)
near("none", S[:, [1, 2, 4]], 0, largest, 2e-4)
near("von Mises", of["von_mises"], numpy.sqrt(s11**2 + 3 * (s12**2 + s13**2)), largest, 2e-4)
assert "ply_stress" not in of  # steel has no plies
# A force P across at the end: the moment about b2 is -P (L - s); on the line x2 = 0 Love's shear (3 + 2 nu)/(8 (1 + nu)) P/I (r^2 - x3^2 ...)
P, nu = 0.02, 0.3
s, x2, x3, of, volume, kinds = stresses("round", y, x, z, 1)
S = of["stress"]
near("bending", S[:, 0], -P * (L - (s - 0)) * x3 / I, P * L * r / I, 2e-4)
s13 = P * (3 + 2 * nu) / (8 * (1 + nu) * I) * (r**2 - x3**2 - (1 - 2 * nu) / (3 + 2 * nu) * x2**2)
s12 = -P * (1 + 2 * nu) / (4 * (1 + nu) * I) * x2 * x3
near("shear across", S[:, 5], s13, s13.max(), 2e-3)
near("shear beside", S[:, 3], s12, s13.max(), 2e-3)
)py");
}

// Of three layers of two materials, in a mesh of triangles and quadrilaterals in mm, pulled at the middle: E e in each, on both
// sides of a seam. Cells of triangles are wedges.
TEST_F(StressFilesTest, JumpBetweenMaterials) {
  require_vtk();
  if (IsSkipped()) return;
  write_text(file("layers.msh"),
             "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"skin\"\n2 2 \"core\"\n"
             "$EndPhysicalNames\n$Nodes\n8\n1 -10 -6 0\n2 10 -6 0\n3 -10 -4 0\n4 10 -4 0\n"
             "5 -10 4 0\n6 10 4 0\n7 -10 6 0\n8 10 6 0\n$EndNodes\n$Elements\n4\n"
             "1 3 2 1 1 1 2 4 3\n2 2 2 2 1 3 4 6\n3 2 2 2 1 3 6 5\n4 3 2 1 1 5 6 8 7\n"
             "$EndElements\n");
  write_text(file("layers.xml"), R"(<mbd name="layers">
    <material name="hard" E="70 GPa" nu="0.3"/><material name="soft" E="7 GPa" nu="0.3"/>
    <section name="s"><mesh file="layers.msh" unit="1 mm" tolerance="1e-3">
      <region name="skin" material="hard"/><region name="core" material="soft"/></mesh></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2" order="1"/>
    <fixed name="f" between="ground b.start"/><load at="b.end" force="5 0 0"/><static/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  look("layers", R"py(
e = numpy.eye(3)
s, x2, x3, of, volume, kinds = stresses("layers", *e)
assert kinds == {3, 4}, kinds
near("volume", volume, 240e-6 * 2, 240e-6 * 2, 1e-6)
EA = 70e9 * 80e-6 + 7e9 * 160e-6
hard, soft = 70e9 * 5 / EA, 7e9 * 5 / EA
s11 = of["stress"][:, 0]
inside, outside = abs(x3) < 3.999e-3, abs(x3) > 4.001e-3
near("core", s11[inside], soft, hard, 1e-6)
near("skin", s11[outside], hard, hard, 1e-6)
seam = ~inside & ~outside
assert seam.any()
near("seam", numpy.minimum(abs(s11[seam] - soft), abs(s11[seam] - hard)), 0, hard, 1e-6)
assert (abs(s11[seam] - soft) < 1e-3 * hard).any() and (abs(s11[seam] - hard) < 1e-3 * hard).any()
)py");
}

// A strip whose fibres lie at an angle, pulled: N/A along it, and the same stress along the axes of the fibres.
TEST_F(StressFilesTest, AlongFibres) {
  require_vtk();
  if (IsSkipped()) return;
  write_text(file("fibres.xml"), R"(<mbd name="fibres">
    <material name="ud" EL="140 GPa" ET="10 GPa" GLT="5 GPa" nuLT="0.3" nuTN="0.4"/>
    <layup name="off"><ply material="ud" thickness="4 mm" angle="30 deg"/></layup>
    <section name="s"><rectangle width="20 mm" layup="off" tolerance="1e-4"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <fixed name="f" between="ground b.start"/><load at="b.end" force="1e-2 0 0"/><static/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  look("fibres", R"py(
s, x2, x3, of, volume, kinds = stresses("fibres", *numpy.eye(3))
sigma, c, d = 1e-2 / (20e-3 * 4e-3), numpy.cos(numpy.pi / 6), numpy.sin(numpy.pi / 6)
near("stress", of["stress"], numpy.array([sigma, 0, 0, 0, 0, 0]), sigma, 1e-4)
near("von Mises", of["von_mises"], sigma, sigma, 1e-4)
# L = cos b1 + sin n x b1, T = n x L: T has -sin along b1
near("ply", of["ply_stress"], sigma * numpy.array([c * c, d * d, 0, 0, 0, -c * d]), sigma, 1e-4)
)py");
}

// A rigid beam and one that varies have none. They are there when asked for, from the model that was run: parameters with
// units included. Another one, or none, is an error before anything is written; where there is nothing to tell, too.
TEST_F(StressFilesTest, AreOnlyWhereTheyAreKnown) {
  const char* const model = R"(<mbd name="some"><parameter name="E" value="{}"/>
    <parameter name="w" value="1 mm"/><material name="m" E="E" nu="0.3"/>
    <section name="rod"><bar radius="10 mm" material="m"/></section>
    <section name="cone"><station at="0"><bar radius="10 mm" material="m"/></station>
      <station at="1"><bar radius="5 mm" material="m"/></station></section>
    <beam name="plain" section="rod" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <beam name="stiff" section="rod" from="1 0 0" to="2 0 0" normal="0 0 1"/>
    <beam name="thin" section="cone" from="2 0 0" to="3 0 0" normal="0 0 1"/>
    <rigid name="r" of="stiff"/>
    <fixed name="f" between="ground plain.start"/><fixed name="g" between="plain.end stiff.start"/>
    <fixed name="h" between="stiff.end thin.start"/>
    <load at="thin.end" force="0 0 -1e-3"/><static/>
    <record name="tip" at="thin.end" quantities="displacement"/></mbd>)";
  const auto write = [&](const std::string& name, const std::string& E) {
    std::string text = model;
    text.replace(text.find("{}"), 2, E);
    write_text(file(name), text);
  };
  write("some.xml", "200e9");
  const Output ran = mbd("run some.xml --motion -q -o some --set E=100e9");
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Output without = mbd("export some --vtk drawn");
  EXPECT_EQ(without.status, 0) << without.text;
  expect_says(without.text, {"note: ", "--stresses"});
  EXPECT_FALSE(fs::exists(file("drawn/some/stresses_000000.vtu")));
  EXPECT_TRUE(fs::exists(file("drawn/some/outlines_000000.vtp")));
  const Output made = mbd("export some --vtk drawn --stresses --set E=100e9");
  EXPECT_EQ(made.status, 0) << made.text;
  const std::string stresses = read_text(file("drawn/some/stresses_000001.vtu"));
  expect_says(stresses, {"Name=\"von_mises\""});
  if (!python_with("vtk, numpy").empty()) {
    require_vtk();
    write_text(file("look.py"), std::string(stress_reader) +
                                    "of = stresses('some', *numpy.eye(3))[3]\n"
                                    "assert len(of['s']) and of['s'].max() == 1\n"
                                    "assert len(stresses('some', *numpy.eye(3), 1)[0]) == 0\n"
                                    "assert len(stresses('some', *numpy.eye(3), 2)[0]) == 0\n");
    const Output looked = here(python_ + " look.py");
    EXPECT_EQ(looked.status, 0) << looked.text;
  }
  // Another model in its place, none, and one that is named.
  fs::rename(file("some.xml"), file("kept.xml"));
  const auto expect_none = [&](const std::string& more, const std::string& why) {
    fs::remove_all(file("drawn"));
    const Output wrong = mbd("export some --vtk drawn --stresses " + more);
    EXPECT_EQ(wrong.status, 1) << wrong.text;
    expect_says(wrong.text, {"--stresses: ", why, "--model FILE"});
    EXPECT_FALSE(fs::exists(file("drawn")));
  };
  expect_none("", "some.xml");
  write_text(file("some.xml"), "<mbd name=\"some\">\n<beem/></mbd>");
  expect_none("", "some.xml:2");
  std::string other = read_text(file("kept.xml"));
  other.replace(other.find("10 mm"), 5, "11 mm");
  write_text(file("some.xml"), other);
  expect_none("--set E=100e9", "beam \"plain\": its section is not the one that was run");
  expect_none("--model kept.xml", "beam \"plain\": its section is not the one that was run");
  const Output named = mbd("export some --vtk again --stresses --model kept.xml --set E=100e9");
  EXPECT_EQ(named.status, 0) << named.text;
  EXPECT_EQ(read_text(file("again/some/stresses_000001.vtu")), stresses);
  // By matrices.
  ASSERT_EQ(mbd("run " + quote((models / "pendulum.xml").string()) +
                " -q -o plain --frames 5 --no-estimate")
                .status,
            0);
  const Output plain = mbd("export plain --vtk drawn --stresses");
  EXPECT_EQ(plain.status, 1);
  expect_says(plain.text, {"--stresses: no beam of this run"});
  EXPECT_EQ(mbd("export plain --vtk drawn --model kept.xml").status, 1);
}

}  // namespace
}  // namespace mbd::test::test_export
