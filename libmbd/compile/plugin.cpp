#include "libmbd/compile/plugin.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/plugin.h"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

std::string label_of(const ExtensionScene& extension) {
  return extension.name.empty() ? fmt::format("extension \"{}\"", extension.force)
                                : label(extension);
}

// Calls a function of a plug-in, whatever it throws. `fault` becomes what it has thrown.
template <class F>
auto guarded(const F& call, std::string& fault) -> decltype(call()) {
  try {
    return call();
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& error) {
    fault = fmt::format("throws an exception: {}", error.what());
  } catch (...) {
    fault = "throws an exception";
  }
  return {};
}

std::span<const mbd_force> forces_of(const mbd_plugin& plugin) {
  return {plugin.forces, plugin.count};
}

const mbd_force* find_force(const mbd_plugin& plugin, std::string_view name) {
  for (const mbd_force& force : forces_of(plugin))
    if (force.name == name) return &force;
  return nullptr;
}

// What is wrong with a plug-in; empty: nothing.
std::string fault_of(const mbd_plugin* plugin) {
  if (plugin == nullptr) return "its mbd_get_plugin() gives nothing";
  if (plugin->version != MBD_PLUGIN_VERSION)
    return fmt::format(
        "is for version {} of plug-ins, and this libmbd has version {}; compile it with the "
        "mbd/plugin.h of "
        "this one",
        plugin->version, MBD_PLUGIN_VERSION);
  if (plugin->count == 0 || plugin->forces == nullptr) return "it has no forces";
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < plugin->count; ++i) {
    const mbd_force& force = plugin->forces[i];
    if (force.name == nullptr || *force.name == '\0')
      return fmt::format("its force {} has no name", i + 1);
    if (force.evaluate == nullptr)
      return fmt::format("its force \"{}\" has no function evaluate", force.name);
    if (!names.insert(force.name).second)
      return fmt::format("it has two forces \"{}\"", force.name);
  }
  return {};
}

std::shared_ptr<const mbd_plugin> opened(const std::filesystem::path& file) {
  const std::string who = fmt::format("plug-in {}: ", file.string());
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code))
    throw Error(who + "there is no such file", Failure::plug_in);
  // With a directory in its name, so that it is not looked for elsewhere.
  void* const library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = dlerror();
    throw Error(who + "cannot be loaded: " + (why ? why : "not known why"), Failure::plug_in);
  }
  std::string fault;
  const mbd_plugin* plugin = nullptr;
  if (void* const entry = dlsym(library, "mbd_get_plugin")) {
    plugin = guarded([&] { return reinterpret_cast<decltype(&::mbd_get_plugin)>(entry)(); }, fault);
    if (!fault.empty()) fault = "its mbd_get_plugin() " + fault;
    if (fault.empty()) fault = fault_of(plugin);
  } else {
    fault = "it has no function mbd_get_plugin, and is none (mbd/plugin.h says what one has)";
  }
  if (!fault.empty()) {
    dlclose(library);
    throw Error(who + fault, Failure::plug_in);
  }
  return {plugin, [](const mbd_plugin*) {}};  // what it is made of may be in use until the end
}

// What the plug-in computes, as the equations want it.
class PluginForce final : public Force {
 public:
  explicit PluginForce(const ExtensionScene& extension)
      : plugin_(extension.plugin),
        force_(*find_force(*plugin_, extension.force)),
        places_(extension.at),
        name_(fmt::format("{} of {}", extension.force, extension.plugin_file)) {
    if (force_.make == nullptr) {
      if (!extension.values.empty())
        throw Error(extension.source,
                    fmt::format("{}: its plug-in {} takes no values for it; leave them out",
                                label_of(extension), extension.plugin_file));
      return;
    }
    std::vector<mbd_value> values;
    for (const auto& [name, value] : extension.values) values.push_back({name.c_str(), value});
    std::array<char, 512> message{};
    std::string fault;
    self_ = guarded(
        [&] { return force_.make(values.data(), values.size(), message.data(), message.size()); },
        fault);
    message.back() = '\0';
    if (fault.empty() && self_ == nullptr)
      fault = *message.data() != '\0' ? std::string("says: ") + message.data()
                                      : "refuses it, and does not say why";
    if (!fault.empty())
      throw Error(extension.source, fmt::format("{}: its plug-in {} {}", label_of(extension),
                                                extension.plugin_file, fault));
  }
  ~PluginForce() override {
    std::string ignored;
    if (force_.destroy != nullptr && self_ != nullptr)
      guarded([&] { return force_.destroy(self_), 0; }, ignored);
  }
  PluginForce(const PluginForce&) = delete;
  PluginForce& operator=(const PluginForce&) = delete;

  std::string name() const override { return name_; }
  std::vector<std::string> places() const override { return places_; }

  bool evaluate(const PlacesMotion& at, std::span<Vec6> wrenches) const override {
    const Motion motion(at);
    static_assert(sizeof(Vec6) == 6 * sizeof(double));
    return call([&] { return force_.evaluate(self_, &motion.all, wrenches.front().data()); });
  }
  bool derivatives(const PlacesMotion& at, Eigen::MatrixXd& by_motion,
                   Eigen::MatrixXd& by_velocity) const override {
    if (force_.derivatives == nullptr) return false;
    const Motion motion(at);
    const auto n = static_cast<Index>(6 * at.poses.size());
    ByRows K = ByRows::Zero(n, n), C = ByRows::Zero(n, n);
    if (!call([&] { return force_.derivatives(self_, &motion.all, K.data(), C.data()); }) ||
        !K.allFinite() || !C.allFinite())
      return false;
    by_motion = K;
    by_velocity = C;
    return true;
  }
  std::optional<double> energy(const PlacesMotion& at) const override {
    if (force_.energy == nullptr) return {};
    const Motion motion(at);
    double energy = 0.0;
    if (!call([&] { return force_.energy(self_, &motion.all, &energy); })) return {};
    return energy;
  }
  std::string fault() const override {
    const std::lock_guard lock(mutex_);
    return fault_;
  }

 private:
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  struct Motion {
    explicit Motion(const PlacesMotion& at) : places(at.poses.size()) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        Eigen::Map<Vec3>(places[i].position) = at.poses[i].r;
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(places[i].rotation) =
            at.poses[i].R();
        Eigen::Map<Vec6>(places[i].velocity) = at.velocities[i];
      }
      all = {at.t, places.size(), places.data()};
    }
    std::vector<mbd_place> places;
    mbd_motion all;
  };

  // An exception is kept for messages, and the step is tried otherwise.
  template <class F>
  bool call(const F& function) const {
    std::string fault;
    const bool done = guarded(function, fault) != 0;
    if (fault.empty()) return done;
    const std::lock_guard lock(mutex_);
    fault_ = std::move(fault);
    return false;
  }

  std::shared_ptr<const mbd_plugin> plugin_;
  const mbd_force& force_;
  std::vector<std::string> places_;
  std::string name_;
  void* self_ = nullptr;
  mutable std::mutex mutex_;
  mutable std::string fault_;
};

}  // namespace

void use_plugin(Scene& scene, const std::filesystem::path& file) {
  const std::shared_ptr<const mbd_plugin> plugin = opened(file);
  bool is_used = false;
  for (ExtensionScene& extension : scene.extensions) {
    if (find_force(*plugin, extension.force) == nullptr) continue;
    is_used = true;
    if (extension.plugin != nullptr && extension.plugin != plugin)
      throw Error(extension.source,
                  fmt::format("{}: plug-ins {} and {} both have such a force; give one of them",
                              label_of(extension), extension.plugin_file, file.string()));
    extension.plugin = plugin;
    extension.plugin_file = file.string();
  }
  if (is_used) return;
  std::vector<std::string_view> wanted, names;
  for (const ExtensionScene& extension : scene.extensions) wanted.push_back(extension.force);
  for (const mbd_force& force : forces_of(*plugin)) names.emplace_back(force.name);
  throw Error(fmt::format("plug-in {}: it has the forces {}, and {}", file.string(), list(names),
                          wanted.empty()
                              ? "the model has no <extension>; leave the plug-in out, or add one"
                              : "the model asks for " + list(wanted) + " only"));
}

std::shared_ptr<const Force> make_plugin_force(const ExtensionScene& extension) {
  if (extension.plugin == nullptr)
    throw Error(extension.source, fmt::format("{}: no plug-in has its force \"{}\"; give it by "
                                              "--plugin FILE (in a program: use_plugin), or "
                                              "leave the extension out",
                                              label_of(extension), extension.force));
  return std::make_shared<PluginForce>(extension);
}

bool has_potential(const ExtensionScene& extension) {
  const mbd_force* const force =
      extension.plugin ? find_force(*extension.plugin, extension.force) : nullptr;
  return force != nullptr && force->energy != nullptr;
}

}  // namespace mbd
