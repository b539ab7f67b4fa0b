#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/view/hdf5.hpp"
#include "libmbd/view/run_file.hpp"

namespace mbd {
namespace {

constexpr std::string_view format_of_campbell = "mbd campbell 1";

// Tables over the rates, which are written once all of the file is laid out.
class TablesOverRates {
 public:
  TablesOverRates(Hdf5File& file, std::vector<double> rates)
      : file_(file), rates_(std::move(rates)) {
    for (std::size_t i = 0; i < rates_.size(); ++i) row_of_.emplace(rates_[i], i);
  }

  // A column each of `columns`, whose entries know their rates.
  template <class Entry, class Value>
  void add(const std::string& path, const char* unit, const char* label,
           const std::vector<const std::vector<Entry>*>& columns, const Value& value) {
    Hdf5Attributes attributes = {{"unit", std::string(unit)}};
    if (*label != '\0') attributes.emplace_back("label", std::string(label));
    std::vector<double> table(rates_.size() * columns.size(), std::nan(""));
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (const Entry& entry : *columns[c])
        if (const auto row = row_of_.find(entry.rate); row != row_of_.end())
          table[row->second * columns.size() + c] = value(entry);
    tables_.emplace_back(file_.add_series(path, {columns.size()}, attributes), std::move(table));
  }

  void write() {
    for (const auto& [series, table] : tables_) file_.append(series, table);
  }

 private:
  Hdf5File& file_;
  std::vector<double> rates_;
  std::unordered_map<double, std::size_t> row_of_;
  std::vector<std::pair<Hdf5File::Series, std::vector<double>>> tables_;
};

void add_branches(const CampbellStudy& study, Hdf5File& file, TablesOverRates& tables) {
  if (study.branches.empty()) return;
  std::vector<std::string> names;
  std::vector<const std::vector<CampbellPoint>*> columns;
  for (const CampbellBranch& branch : study.branches) {
    names.push_back(branch.name);
    columns.push_back(&branch.points);
  }
  file.add_group("modes");
  file.add_texts("modes/names", names);
  using Point = const CampbellPoint&;
  tables.add("modes/re_eigenvalue", "1/s", "growth", columns,
             [](Point p) { return p.eigenvalue.real(); });
  tables.add("modes/im_eigenvalue", "1/s", "frequency in the axes of the file", columns,
             [](Point p) { return p.eigenvalue.imag(); });
  tables.add("modes/inertial_frequency", "rad/s",
             "in inertial axes: positive forward, negative backward", columns,
             [](Point p) { return p.inertial.value_or(std::nan("")); });
  tables.add("modes/orbit", "1", "1: circles forward, -1: backward, 0: lines", columns,
             [](Point p) { return p.has_orbit ? p.orbit : std::nan(""); });
  tables.add("modes/overlap", "1", "with the rate before", columns,
             [](Point p) { return p.overlap; });
  tables.add("modes/round_off", "1", "of the eigenvalue, relative, an estimate", columns,
             [](Point p) { return p.round_off; });
}

void add_special(const CampbellStudy& study, Hdf5File& file) {
  if (study.special.empty()) return;
  std::vector<std::string> kinds;
  std::vector<double> rates, branches;
  for (const SpecialSpeed& speed : study.special) {
    kinds.emplace_back(word_of(speed.kind));
    rates.push_back(speed.rate);
    branches.push_back(static_cast<double>(speed.branch));
  }
  file.add_group("special");
  file.add_texts("special/kind", kinds);
  file.add_numbers("special/rate", rates, {{"unit", std::string("rad/s")}});
  file.add_numbers(
      "special/branch", branches,
      {{"unit", std::string("1")}, {"label", std::string("column of /modes, from 0")}});
}

void add_driven(const std::string& group, const std::vector<CampbellStudy::Response>& responses,
                const Hdf5Attributes& attributes, Hdf5File& file,
                std::vector<TablesOverRates>& all) {
  if (responses.empty()) return;
  std::vector<double> rates;
  for (const CampbellStudy::Response& response : responses)
    for (const Orbit& orbit : response.orbits) rates.push_back(orbit.rate);
  std::ranges::sort(rates);
  rates.erase(std::unique(rates.begin(), rates.end()), rates.end());
  std::vector<std::string> places;
  std::vector<const std::vector<Orbit>*> columns;
  for (const CampbellStudy::Response& response : responses) {
    places.push_back(response.place);
    columns.push_back(&response.orbits);
  }
  file.add_group(group, attributes);
  file.add_texts(group + "/places", places);
  file.add_numbers(group + "/rates", rates,
                   {{"unit", std::string("rad/s")},
                    {"label", std::string("those of the file, and more about resonances")}});
  TablesOverRates& tables = all.emplace_back(file, std::move(rates));
  using Value = std::function<double(const Orbit&)>;
  const auto add = [&](const char* name, const char* unit, const char* label, const Value& value) {
    tables.add(group + "/" + name, unit, label, columns, value);
  };
  add("major", "m", "half the long axis of the orbit", [](const Orbit& o) { return o.major(); });
  add("minor", "m", "half the short axis", [](const Orbit& o) { return o.minor(); });
  add("lag", "deg", "of the forward part behind what drives it",
      [](const Orbit& o) { return o.lag() / (std::numbers::pi / 180.0); });
  add("re_forward", "m", "", [](const Orbit& o) { return o.forward.real(); });
  add("im_forward", "m", "", [](const Orbit& o) { return o.forward.imag(); });
  add("re_backward", "m", "", [](const Orbit& o) { return o.backward.real(); });
  add("im_backward", "m", "", [](const Orbit& o) { return o.backward.imag(); });
  add("besides", "m", "at other frequencies", [](const Orbit& o) { return o.besides; });
}

}  // namespace

void write_campbell(const std::filesystem::path& path, const CampbellStudy& study,
                    const Scene& scene) {
  Hdf5File file(path);
  add_origin(file, format_of_campbell, scene);
  file.add_attributes(
      {{"axes", std::string(study.axes == ModeAxes::turning ? "turning" : "resting")}});
  const auto vector = [](const Vec3& x) { return std::vector<double>{x(0), x(1), x(2)}; };
  const Hdf5Attributes metres = {{"unit", std::string("m")}};
  file.add_numbers("axis", vector(study.rotation.axis), {{"unit", std::string("1")}});
  file.add_numbers("through", vector(study.rotation.through), metres);
  file.add_numbers("rates", study.rates, {{"unit", std::string("rad/s")}});
  file.add_numbers("displacement", study.displacements, metres);
  std::vector<TablesOverRates> tables;
  add_branches(study, file, tables.emplace_back(file, study.rates));
  add_special(study, file);
  add_driven("unbalance", study.responses, {}, file, tables);
  add_driven("force", study.force_responses, {{"order", study.order}}, file, tables);
  if (!study.notes.empty()) file.add_texts("notes", study.notes);
  file.start();
  for (TablesOverRates& table : tables) table.write();
  file.flush(true);
  file.close();
}

}  // namespace mbd
