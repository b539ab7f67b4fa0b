# Adds a load on nodes to a copy of the sources, from its element in model files to its kernel, and builds and runs a
# program that knows it. Fails when that takes more than four files, or when what follows from the list of its fields
# does not: schema, manual, grammar, ranges, labels, places, names, and scenes moved, rescaled, perturbed and reordered.
# Usage: cmake -DSOURCE=… -DBUILD=… -DSCRATCH=… -P add_a_term.cmake
cmake_minimum_required(VERSION 3.25)

set(rooms libmbd elements joints solvers)
file(REMOVE_RECURSE "${SCRATCH}")
foreach(room IN LISTS rooms)
  file(COPY "${SOURCE}/${room}" DESTINATION "${SCRATCH}")
endforeach()

# Puts `new` before (or behind) the only place where `text` stands in a file.
function(insert path where text new)
  file(READ "${SCRATCH}/${path}" all)
  string(FIND "${all}" "${text}" first)
  string(FIND "${all}" "${text}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "${path} must have, once: ${text}")
  endif()
  if(where STREQUAL "before")
    string(REPLACE "${text}" "${new}${text}" all "${all}")
  else()
    string(REPLACE "${text}" "${text}${new}" all "${all}")
  endif()
  file(WRITE "${SCRATCH}/${path}" "${all}")
endfunction()

# ---- the change: a steady wind pushes what is at a place, in an inertial direction ----
insert(libmbd/scene/loads.hpp before "struct Gravity {" [=[
// Pushes what is at a place.
struct WindScene {
  Source source;
  std::string name;
  Place at;
  Vec3 direction = Vec3::UnitX();  // of any length
  double force = 0.0;

  static constexpr field::ItemKind item{
      "wind",    "A steady wind pushes what is at a place.", "winds", field::of_loads, true,
      "winds", "Loads"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = WindScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::at, "at", "", required, "what it pushes"));
    f(Field(&S::direction, "direction", "", required, "it blows there, inertial axes", inertial));
    f(Field(&S::force, "force", "N", required, "how much it pushes", not_negative));
  }
};

]=])
insert(libmbd/scene/scene.hpp before "  std::optional<Gravity> gravity;" "  std::vector<WindScene> winds;\n")
insert(libmbd/scene/scene.hpp before "  f(scene.gravity);" "  f(scene.winds);\n")
file(WRITE "${SCRATCH}/elements/node/wind.hpp" [=[
// Dead force f on a node:  r = -[ R^T f ; 0 ],   d(R^T f) = (R^T f)~ psi
#pragma once

#include "elements/element.hpp"

namespace mbd {

struct Wind {
  static constexpr const char* name = "wind";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    Vec3 force;  // inertial axes [N]
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights, Output<S>& out) {
    const Vector3<S> f =
        x[0].H.p.conjugate() * Vector3<S>((env.load_factor * data.force).cast<S>());
    out.r = six<S>(-f, Vector3<S>::Zero());
    if constexpr (want == Want::tangent)
      out.K << Matrix3<S>::Zero(), -hat(f), Matrix3<S>::Zero(), Matrix3<S>::Zero();
    return S(1);
  }

  static double load_power(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    return env.load_factor * data.force.dot(x[0].H.p * linear(x[0].V));
  }
};

}  // namespace mbd
]=])
insert(libmbd/compile/nodal_terms.hpp behind "#include \"libmbd/compile/drags.hpp\"\n"
       "#include \"elements/element_batch.hpp\"\n#include \"elements/node/wind.hpp\"\n#include \"libmbd/scene/label.hpp\"\n")
insert(libmbd/compile/nodal_terms.hpp before "// In the order of their batches." [=[
class Winds {
 public:
  explicit Winds(const Nodes& nodes) : nodes_(nodes) {}
  void add(const WindScene& wind) {
    const Attachment at = nodes_.find_moving(wind, wind.at, label(wind));
    if (!winds_) winds_ = std::make_unique<ElementBatch<Wind>>(Wind::name, Wind::Shared{});
    winds_->add({wind.force * wind.direction.normalized()}, std::array{at.node}, label(wind));
  }
  void finish() {
    if (winds_) nodes_.system.add_batch(std::move(winds_));
  }

 private:
  const Nodes& nodes_;
  std::unique_ptr<ElementBatch<Wind>> winds_;
};

]=])
insert(libmbd/compile/nodal_terms.hpp behind "NodalTermList<Loads, Drags" ", Winds")

# ---- what it touched ----
set(touched "")
foreach(room IN LISTS rooms)
  file(GLOB_RECURSE files RELATIVE "${SCRATCH}" "${SCRATCH}/${room}/*")
  foreach(name IN LISTS files)
    set(before "new")
    if(EXISTS "${SOURCE}/${name}")
      file(SHA256 "${SOURCE}/${name}" before)
    endif()
    file(SHA256 "${SCRATCH}/${name}" after)
    if(NOT before STREQUAL after)
      list(APPEND touched "${name}")
    endif()
  endforeach()
endforeach()
list(LENGTH touched count)
if(count GREATER 4)
  message(FATAL_ERROR "it touches ${count} files: ${touched}")
endif()

# ---- it works ----
file(WRITE "${SCRATCH}/main.cpp" [=[
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/manual.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/generalized_alpha.hpp"

using namespace mbd;

namespace {

int faults = 0;

void expect(bool right, const char* what) {
  if (right) return;
  std::printf("not so: %s\n", what);
  ++faults;
}

bool holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

std::string model(std::string_view winds) {
  return "<mbd name=\"windy\"><body name=\"b\" at=\"1 0 0\" mass=\"2\" inertia=\"1 1 1\"/>" +
         std::string(winds) + "<transient duration=\"1\" step=\"0.01\"/></mbd>";
}

std::string said_of(const Scene& scene) {
  try {
    compile(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string said_of(std::string_view winds) {
  try {
    return said_of(read_model_text(model(winds), "windy.xml"));
  } catch (const Error& error) {
    return error.what();
  }
}

// Where the body is at the end.
Vec3 end_of(const Scene& scene) {
  const Model made = compile(scene);
  GeneralizedAlpha stepper(*made.system, make_klu_solver(),
                           {.step = *scene.transient->step, .rho_infinity = 0.0, .newton = {}});
  State state = made.initial;
  expect(stepper.start(state).converged, "it starts");
  for (int i = 0; i < 100; ++i) expect(stepper.step(state).converged, "steps converge");
  return state.pose[1].r;
}

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-9 * (1.0 + b.norm()); }

}  // namespace

int main() {
  const schema::Element* const page = schema::find_element("wind");
  expect(page != nullptr && holds(to_text(*page), "number >= 0 [N], required"), "mbd schema wind");
  expect(holds(to_markdown(), "### wind\n"), "it stands in the manual");
  expect(holds(to_xsd(), "<xs:complexType name=\"wind\">"), "it stands in the grammar");

  const std::string wind = "<wind name=\"gust\" at=\"b\" direction=\"0 2 0\" force=\"6 N\"/>";
  const Scene scene = read_model_text(model(wind), "windy.xml");
  expect(label(scene.winds[0]) == "wind \"gust\"", "its label");
  int places = 0;
  each_place(scene, [&](const Place& place) { places += place.name == "b"; });
  expect(places == 1, "its place is one of the scene's");

  const std::string negative = "wind \"gust\": force is -6, must not be negative";
  expect(holds(said_of("<wind name=\"gust\" at=\"b\" direction=\"0 2 0\" force=\"-6 N\"/>"), negative),
         "the reader knows its range");
  Scene wrong = scene;
  wrong.winds[0].force = -6.0;
  expect(holds(said_of(wrong), negative), "so does the check of scenes");
  expect(holds(said_of(wind + wind), "names of loads"), "names must differ");
  expect(holds(said_of("<wind at=\"b\" force=\"6 N\"/>"), "attribute \"direction\" is missing"),
         "what is missing is said");

  const Vec3 end = end_of(scene);
  expect(near(end, {1.0, 1.5, 0.0}), "F t^2 / 2 m");
  const RigidMotion motion = random_motion(7, 10.0);
  expect(near(end_of(moved(scene, motion).scene), motion.R * end + motion.shift), "moved");
  const Scene other = rescaled(scene, {1e3, 1e-3, 10.0}).scene;
  expect(std::abs(other.winds[0].force - 6.0 * 1e3 * 1e-3 / 1e2) < 1e-12, "force in other units");
  expect(near(end_of(other), 1e3 * end), "rescaled");
  const double force = perturbed(scene, 1e-3, 1).winds[0].force;
  expect(force != 6.0 && std::abs(force - 6.0) < 6.1e-3, "perturbed");
  const Scene two =
      read_model_text(model(wind + "<wind at=\"b\" direction=\"1 0 0\" force=\"1\"/>"), "windy.xml");
  bool swapped = false;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    swapped = swapped || reordered(two, seed).winds[0].name.empty();
  expect(swapped, "reordered");
  return faults == 0 ? 0 : 1;
}
]=])
execute_process(COMMAND "${CMAKE_COMMAND}" --build "${BUILD}" --target mbd_new_term
                OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the program with the new term does not build:\n${output}")
endif()
execute_process(COMMAND "${SCRATCH}/mbd_new_term"
                OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the program with the new term fails:\n${output}")
endif()
message(STATUS "${count} files: ${touched}\n${output}")
