// Forces that tests/front/test_plugins.cpp loads: springs to the origin, and some that go wrong. Compiled once more as a plug-in of
// a later version (MBD_TEST_VERSION).
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "libmbd/plugin.h"

#ifndef MBD_TEST_VERSION
#define MBD_TEST_VERSION MBD_PLUGIN_VERSION
#endif

namespace {

struct Pull {
  double stiffness = 0.0, damping = 0.0, reach = std::numeric_limits<double>::infinity(),
         after = std::numeric_limits<double>::infinity();
};

void* make(const mbd_value* values, std::size_t count, char* message, std::size_t size) {
  Pull made;
  for (std::size_t i = 0; i < count; ++i) {
    const auto is = [&](const char* name) { return std::strcmp(values[i].name, name) == 0; };
    double* const member = is("stiffness") ? &made.stiffness
                           : is("damping") ? &made.damping
                           : is("reach")   ? &made.reach
                           : is("after")   ? &made.after
                                           : nullptr;
    if (member == nullptr) {
      std::snprintf(message, size, "there is no value \"%s\"", values[i].name);
      return nullptr;
    }
    *member = values[i].value;
  }
  if (made.stiffness > 0.0) return new Pull(made);
  std::snprintf(message, size, "stiffness must be positive");
  return nullptr;
}

void destroy(void* self) { delete static_cast<Pull*>(self); }

// R^T r, the place's position along its own axes.
std::array<double, 3> own_position(const mbd_place& place) {
  std::array<double, 3> x{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) x[i] += place.rotation[3 * k + i] * place.position[k];
  return x;
}

int evaluate(void* self, const mbd_motion* at, double* wrenches) {
  const Pull& pull = *static_cast<const Pull*>(self);
  for (std::size_t p = 0; p < at->count; ++p) {
    const std::array<double, 3> x = own_position(at->places[p]);
    if (std::hypot(x[0], x[1], x[2]) > pull.reach) return 0;
    for (std::size_t i = 0; i < 3; ++i)
      wrenches[6 * p + i] = -pull.stiffness * x[i] - pull.damping * at->places[p].velocity[i];
  }
  return 1;
}

// x = R^T r, dx = du + x~ dpsi
int derivatives(void* self, const mbd_motion* at, double* by_motion, double* by_velocity) {
  const Pull& pull = *static_cast<const Pull*>(self);
  const std::size_t n = 6 * at->count;
  for (std::size_t p = 0; p < at->count; ++p) {
    const std::array<double, 3> x = own_position(at->places[p]);
    const double tilde[3][3] = {{0, -x[2], x[1]}, {x[2], 0, -x[0]}, {-x[1], x[0], 0}};
    for (std::size_t i = 0; i < 3; ++i) {
      double* const row = by_motion + (6 * p + i) * n + 6 * p;
      row[i] = -pull.stiffness;
      for (std::size_t k = 0; k < 3; ++k) row[3 + k] = -pull.stiffness * tilde[i][k];
      by_velocity[(6 * p + i) * n + 6 * p + i] = -pull.damping;
    }
  }
  return 1;
}

int energy(void* self, const mbd_motion* at, double* sum) {
  const Pull& pull = *static_cast<const Pull*>(self);
  if (pull.damping != 0.0) return 0;
  *sum = 0.0;
  for (std::size_t p = 0; p < at->count; ++p)
    for (const double r : at->places[p].position) *sum += 0.5 * pull.stiffness * r * r;
  return 1;
}

int throws(void* self, const mbd_motion* at, double* wrenches) {
  if (at->t >= static_cast<const Pull*>(self)->after) throw std::runtime_error("boom");
  return evaluate(self, at, wrenches);
}

int no_number(void* self, const mbd_motion* at, double* wrenches) {
  const int done = evaluate(self, at, wrenches);
  if (at->t >= static_cast<const Pull*>(self)->after) wrenches[6 * at->count - 1] = std::nan("");
  return done;
}

int push(void*, const mbd_motion* at, double* wrenches) {  // 3 N along its own first axis
  for (std::size_t p = 0; p < at->count; ++p) wrenches[6 * p] = 3.0;
  return 1;
}

const mbd_force forces[] = {
    {"pull", make, evaluate, derivatives, energy, destroy},
    {"plain_pull", make, evaluate, nullptr, nullptr, destroy},
    {"throws", make, throws, nullptr, nullptr, destroy},
    {"no_number", make, no_number, nullptr, nullptr, destroy},
    {"push", nullptr, push, nullptr, nullptr, nullptr},
};
const mbd_plugin plugin = {MBD_TEST_VERSION, std::size(forces), forces};

}  // namespace

const mbd_plugin* mbd_get_plugin() { return &plugin; }
