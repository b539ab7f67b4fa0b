#include "tools/mbd/linearize_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/run_file.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct LinearizeArguments {
  std::string model, output;
  AboutArguments about;
  std::vector<std::string> set, without;
  bool hdf5 = false, quiet = false;
};

int linearize_model(const LinearizeArguments& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  const ModesOptions options = about(arguments.about, scene);
  if (arguments.hdf5) require_hdf5("linear.h5");
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "linear");
  const Linearization linear = linearize(scene, options, true);
  make_directory(output);
  write_linearization(linear, output);
  std::error_code code;
  std::filesystem::remove(output / "linear.h5", code);  // of an earlier one
  if (arguments.hdf5) write_linearization(output / "linear.h5", linear, scene);
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: linear.json{}, M.mtx, C.mtx, K.mtx, G.mtx, F.mtx{}\n",
               to_text(linear), output.string(), linear.reduced ? " (E, A, B, C, D)" : "",
               arguments.hdf5 ? ", linear.h5" : "");
  return 0;
}

}  // namespace

void add_linearize_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<LinearizeArguments>();
  CLI::App* const command = app.add_subcommand("linearize",
                                               "The equations of motion about equilibrium, a "
                                               "steady rotation, or a state of a run as matrices, "
                                               "with the inputs and outputs of the model.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  add_about_options(*command, arguments->about);
  command->add_flag("--hdf5", arguments->hdf5,
                    "all of it as arrays in one HDF5 file too, linear.h5");
  add_set_option(*command, arguments->set);
  add_without_option(*command, arguments->without);
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the matrices; default: results/MODEL/linear")
      ->type_name("DIR");
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd linearize models/damped_oscillator.xml\n"
               "mbd linearize models/shaft.xml --rate 50 --axis 1 0 0 --without gravity\n"
               "mbd linearize models/four_bar.xml --at 6.5");
  command->callback([arguments, &status] { status = linearize_model(*arguments); });
}

}  // namespace mbd
