#include "tools/mbd/export_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/vtk.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/stress_options.hpp"
#include "tools/mbd/view_command.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t usual_frames = 200;

struct ExportArguments {
  std::string what, vtk, frames;
  StressOptions stresses;
  std::vector<std::string> set;
};

// They are asked for, as they are most of a frame, forty times the rest of it in four_bar_boxes.
StressesOfBeams stresses_of(const Motion& motion, const ExportArguments& arguments) {
  if (arguments.stresses.asked) return stresses_of_beams(arguments.stresses, arguments.set, motion);
  if (has_section_stresses(motion))
    fmt::print("note: sections are stated by material: --stresses writes stresses over them\n");
  return {};
}

VtkFiles export_results(const ExportArguments& arguments) {
  if (!arguments.set.empty() && !arguments.stresses.asked)
    throw Error("--set " + arguments.set.front() +
                ": these are results; run the model with it, or name the model");
  check_model_has_use(arguments.stresses);
  const fs::path given(arguments.what);
  const fs::path directory = fs::is_directory(given) ? given : given.parent_path();
  const Motion motion = read_motion(directory / "motion.bin");
  for (const std::string& doubt : doubts_about_run(motion.file, motion.run))
    fmt::print("note: {}\n", doubt);
  const std::size_t most = arguments.frames.empty()
                               ? usual_frames
                               : static_cast<std::size_t>(frames_option(arguments.frames));
  return write_vtk(arguments.vtk, motion, most, stresses_of(motion, arguments));
}

VtkFiles export_model(const ExportArguments& arguments) {
  check_no_stresses_of_model(arguments.stresses);
  if (!arguments.frames.empty())
    throw Error("--frames " + arguments.frames +
                ": a model has no frames; run it with --motion and name the directory of its "
                "results");
  const Scene scene = read_model(arguments.what, to_overrides(arguments.set));
  const Model model = compile(scene);
  return write_vtk(arguments.vtk, drawing(scene, model));
}

int export_files(const ExportArguments& arguments) {
  if (arguments.vtk.empty())
    throw Error("nothing is asked for; give --vtk DIR, for files that ParaView reads");
  std::error_code code;
  if (fs::exists(arguments.vtk, code) && !fs::is_directory(arguments.vtk, code))
    throw Error("--vtk " + arguments.vtk + ": there is a file of this name; name a directory");
  const fs::path what(arguments.what);
  const bool results = fs::is_directory(what, code) || what.filename() == "motion.bin";
  const VtkFiles files = results ? export_results(arguments) : export_model(arguments);
  fmt::print("wrote {}, {}{} in {} files: open it in ParaView\n", files.collection.string(),
             !results                  ? "the reference configuration"
             : files.frames < files.of ? fmt::format("{} of {} frames", files.frames, files.of)
                                       : fmt::format("{} frames", files.frames),
             files.frames < files.of ? " (--frames N for more)" : "", files.files);
  return 0;
}

}  // namespace

void add_export_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* const command = app.add_subcommand(
      "export", "Writes a model, or the motion of a run, as files that ParaView reads.");
  command
      ->add_option(
          "MODEL_OR_DIR", arguments->what,
          "model file (XML), or directory of a run that kept its motion (mbd run --motion)")
      ->required();
  command
      ->add_option("--vtk", arguments->vtk,
                   "files of VTK: NAME.pvd in this directory, and a directory NAME with centre "
                   "lines, outlines, nodes, quadrature points, bodies, joints and springs")
      ->check(not_empty, "", "")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  add_stress_options(*command, arguments->stresses,
                     "of a run, also stresses over sections that are stated by material and shape");
  command
      ->add_option("--frames", arguments->frames, "at most N frames, evenly chosen; default: 200")
      ->check(not_empty, "", "")
      ->type_name("N");
  set_examples(
      *command,
      "mbd export models/four_bar.xml --vtk drawn\n"
      "mbd run models/four_bar.xml --frames 401 && mbd export results/four_bar --vtk drawn\n"
      "mbd export results/four_bar --vtk drawn --frames 401");
  command->callback([arguments, &status] { status = export_files(*arguments); });
}

}  // namespace mbd
