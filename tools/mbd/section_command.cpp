#include "tools/mbd/section_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/run/describe_section.hpp"
#include "libmbd/run/describe_stress.hpp"
#include "libmbd/run/section_accuracy.hpp"
#include "libmbd/run/section_picture.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct SectionArguments {
  std::string model, name, csv, stress, run, record, point, image, colour;
  std::optional<double> station;
  std::vector<std::string> set;
  bool json = false, accuracy = false;
  std::optional<double> budget;
};

// So many numbers, separated by blanks.
std::vector<double> numbers_of(const std::string& text, std::size_t count, std::string_view option,
                               std::string_view what) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (double x = 0.0; stream >> x;) numbers.push_back(x);
  if (!stream.eof() || numbers.size() != count ||
      !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    throw Error(fmt::format("{} \"{}\": give {} numbers, {}", option, excerpt(text), count, what));
  return numbers;
}

// Resultants of a record, by rows of a run.
std::vector<SectionLoad> loads_of(const History& history, const std::string& record) {
  std::array<std::size_t, 6> columns{};
  for (std::size_t i = 0; i < 6; ++i)
    columns[i] = choose_column(
        history, fmt::format("{}.{}.{}", record, i < 3 ? "force" : "moment", i % 3 + 1));
  std::vector<SectionLoad> loads(history.rows());
  for (std::size_t row = 0; row < loads.size(); ++row) {
    loads[row].at = history.values[0][row];
    for (std::size_t i = 0; i < 6; ++i)
      loads[row].resultants(static_cast<Index>(i)) = history.values[columns[i]][row];
  }
  return loads;
}

// Of the load under which the stress of von Mises is the largest.
SectionLoad worst(const StressReport& report) {
  for (const StressReport::Largest& x : report.largest)
    if (x.quantity == "von_mises") return x.load;
  throw Error("the record has no rows");
}

// A record of the model is at a beam of that section, and at that station of it; of one that the model does not have nothing is
// known.
void check_record(const Scene& scene, const std::string& name, const std::string& section,
                  std::optional<double> station) {
  const auto record = std::ranges::find(scene.records, name, &RecordScene::name);
  if (record == scene.records.end() || !record->at) return;
  const auto beam = std::ranges::find(scene.beams, record->at->name, &BeamScene::name);
  if (beam == scene.beams.end()) return;
  if (beam->section == section) {
    if (!station || std::abs(record->at->parameter - *station) <= 1e-9) return;
    throw Error(
        record->source,
        fmt::format("record \"{}\" is at {:g} of beam \"{}\", and its section varies: its "
                    "resultants are not those at station {:g}; record there, \"{}@{:g}\"",
                    name, record->at->parameter, beam->name, *station, beam->name, *station));
  }
  throw Error(record->source,
              fmt::format("record \"{}\" is at beam \"{}\", whose section is \"{}\", not \"{}\": "
                          "its resultants act on no section of that name; give the beam's section, "
                          "or a record of another beam",
                          name, beam->name, beam->section, section));
}

void recover(const SectionArguments& arguments) {
  if (arguments.stress.empty() == arguments.run.empty())
    throw Error(
        "stresses are of resultants, --stress \"N Q2 Q3 M1 M2 M3\", or of a run, --run DIR "
        "--record "
        "NAME; give one of both");
  if (arguments.run.empty() != arguments.record.empty())
    throw Error(
        "--run and --record belong together: a directory of results, and a record in it with the "
        "quantities force and moment");
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.image.empty()) plot::check_picture(arguments.image);
  if (!arguments.colour.empty() && arguments.image.empty())
    throw Error("--colour is of a picture; give --image FILE.svg, or leave it out");
  std::vector<SectionLoad> loads;
  std::string at_name;
  if (arguments.run.empty()) {
    const std::vector<double> x =
        numbers_of(arguments.stress, 6, "--stress", "N Q2 Q3 M1 M2 M3 in N and N.m");
    loads.push_back({{}, Vec6(x.data())});
  } else {
    const History history = read_history(arguments.run);
    loads = loads_of(history, arguments.record);
    at_name = history.columns.front().name;
  }
  StressReport report = describe_stress(scene, arguments.name, arguments.station, loads);
  if (!arguments.record.empty())
    check_record(scene, arguments.record, report.section, arguments.station);
  report.at_name = at_name;
  if (arguments.point.empty()) {
    fmt::print("{}", arguments.json ? to_json(report) : to_text(report));
  } else {
    const std::vector<double> x = numbers_of(arguments.point, 2, "--point", "x2 x3 in m");
    const SectionLoad shown = worst(report);
    const PointStress point =
        describe_point(scene, report.section, arguments.station, shown, {x[0], x[1]});
    if (!arguments.json && shown.at) fmt::print("{} {}: ", at_name, *shown.at);
    fmt::print("{}", arguments.json ? to_json(point) : to_text(point));
  }
  if (!arguments.csv.empty()) write_file(arguments.csv, to_csv(report));
  if (arguments.image.empty()) return;
  const std::string quantity = arguments.colour.empty() ? "von_mises" : arguments.colour;
  write_file(arguments.image,
             section_picture(scene, report.section, arguments.station, worst(report), quantity));
}

void study(const SectionArguments& arguments) {
  if (!arguments.stress.empty() || !arguments.run.empty() || !arguments.record.empty() ||
      !arguments.point.empty() || arguments.station || !arguments.image.empty() ||
      !arguments.colour.empty())
    throw Error(
        "--accuracy is of D; --stress, --run, --record, --point, --station, --image and --colour "
        "are "
        "of stresses; leave one or the other out");
  const double budget = arguments.budget.value_or(60.0);
  if (!(budget >= 0.1) || !(budget <= 1e6))
    throw Error(fmt::format("--budget {:g}: give seconds, 0.1 to 1e6", budget));
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  const std::vector<SectionAccuracy> all = section_accuracy(scene, arguments.name, budget);
  if (!arguments.csv.empty()) write_file(arguments.csv, to_csv(all));
  if (arguments.json) {
    fmt::print("{}", to_json(all));
    return;
  }
  for (std::size_t i = 0; i < all.size(); ++i)
    fmt::print("{}{}", i == 0 ? "" : "\n", to_text(all[i]));
}

void describe(const SectionArguments& arguments) {
  if (arguments.accuracy) {
    study(arguments);
    return;
  }
  if (arguments.budget) throw Error("--budget is of --accuracy; give that, or leave it out");
  if (!arguments.stress.empty() || !arguments.run.empty() || !arguments.record.empty()) {
    recover(arguments);
    return;
  }
  if (!arguments.point.empty() || arguments.station || !arguments.image.empty() ||
      !arguments.colour.empty())
    throw Error(
        "--point, --station, --image and --colour are of stresses; give --stress \"N Q2 Q3 M1 M2 "
        "M3\", or "
        "--run "
        "and --record");
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  const std::vector<SectionReport> reports = describe_sections(scene, arguments.name);
  if (!arguments.csv.empty()) write_file(arguments.csv, to_csv(reports));
  if (arguments.json) {
    fmt::print("{}", to_json(reports));
    return;
  }
  for (std::size_t i = 0; i < reports.size(); ++i)
    fmt::print("{}{}", i == 0 ? "" : "\n", to_text(reports[i]));
}

void add_stress_options(CLI::App& command, SectionArguments& arguments) {
  command
      .add_option(
          "--stress", arguments.stress,
          "stresses under these resultants N Q2 Q3 M1 M2 M3 about the reference line [N, N.m]")
      ->type_name("NUMBERS");
  command.add_option("--run", arguments.run, "stresses under the resultants of a run: its results")
      ->type_name("DIR");
  command
      .add_option(
          "--record", arguments.record,
          "of that run: a record at a place of a beam, with the quantities force and moment")
      ->type_name("NAME");
  command
      .add_option("--station", arguments.station, "of a section that varies: one of its stations")
      ->type_name("S");
  command
      .add_option(
          "--point", arguments.point,
          "stresses and strains at this point x2 x3 [m]; of a run, when the stress of von Mises "
          "over the section is the largest")
      ->type_name("POINT");
  command
      .add_option("--image", arguments.image,
                  "draw the section with these stresses as an SVG; of a run, when the stress of "
                  "von Mises over the section is the largest")
      ->type_name("FILE");
  command
      .add_option("--colour", arguments.colour,
                  "of that picture: a failure index, von_mises (default), LL TT NN TN LN LT, or "
                  "warping, the displacement along b1")
      ->type_name("QUANTITY");
}

}  // namespace

void add_section_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<SectionArguments>();
  CLI::App* const command = app.add_subcommand(
      "section",
      "Stiffness D and mass M of sections, their centres and principal axes, and, of sections by "
      "shape and material, an error estimate of every entry. With --stress or --run: stresses and "
      "failure indices over "
      "such a section.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command->add_option("NAME", arguments->name, "of one section; default: all of them");
  add_set_option(*command, arguments->set);
  command->add_flag("--json", arguments->json, "the same as JSON");
  command
      ->add_option("-o,--out", arguments->csv,
                   "write the matrices, or the largest indices and stresses by rows of the run, to "
                   "this file, as CSV")
      ->type_name("FILE");
  add_stress_options(*command, *arguments);
  command->add_flag(
      "--accuracy", arguments->accuracy,
      "what the accuracy of D costs: errors and CPU seconds of many meshes and orders, "
      "and the cheapest for 1e-2 to 1e-6");
  command
      ->add_option("--budget", arguments->budget,
                   "of --accuracy: seconds for each section; default: 60")
      ->type_name("SECONDS");
  set_examples(*command,
               "mbd section models/shaft_tube.xml\n"
               "mbd section models/four_bar_boxes.xml box16 --json\n"
               "mbd section models/shaft_tube.xml tube --out tube.csv\n"
               "mbd section models/four_bar_boxes.xml box16 --accuracy\n"
               "mbd section models/shaft_tube.xml tube --stress \"0 0 1000 0 500 0\"\n"
               "mbd section models/shaft_tube.xml tube --stress \"0 0 0 1 0 0\" --image s.svg "
               "--colour LT");
  command->callback([arguments, &status] {
    describe(*arguments);
    status = 0;
  });
}

}  // namespace mbd
