// Sensors that laws and controllers name -> sensors of a System; controllers of a scene -> those of a System.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/compile/joints.hpp"
#include "libmbd/compile/places.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// What a sensor is called: "elbow.angle", "arm.end.velocity.2", "hub.position.1".
struct SensorName {
  RecordScene record;  // of its place, joint or spring, and its quantity
  const schema::Quantity* quantity = nullptr;
  int component = 0;  // from 0
};
// Throws Error in the name of `who` (with its place in the file) for what is not there.
SensorName find_sensor(const Scene& scene, const std::string& name, const std::string& who);

// How output reads a record, in SI units.
using ReadRecord =
    std::function<std::function<void(const State&, std::span<double>)>(const SensorName&)>;
// The node of a sensor's place; throws Error where it has none.
struct SensorPlace {
  int node;
  Pose<double> frame, start;  // of the place in its node; in the reference configuration
};
using FindSensorPlace = std::function<SensorPlace(const SensorName&, const std::string& who)>;

class ControlCompiler {
 public:
  ControlCompiler(const Scene& scene, System& system, const JointCompiler& joints,
                  FindSensorPlace find, ReadRecord read)
      : scene_(scene),
        system_(system),
        joints_(joints),
        find_(std::move(find)),
        read_(std::move(read)) {}

  // Laws of loads with sensors: couples them. Before System::finish().
  void feed_back();
  // After everything that it may look at.
  void add_controllers();

 private:
  std::size_t sensor(const std::string& name, const std::string& who);
  void refuse_held_motions() const;
  std::unique_ptr<Sensor> make_sensor(const SensorName& of, const std::string& who) const;

  const Scene& scene_;
  System& system_;
  const JointCompiler& joints_;
  FindSensorPlace find_;
  ReadRecord read_;
  std::map<std::string, std::size_t, std::less<>> known_;  // sensors of laws
};

// Whether a law of the item has sensors.
template <class Item>
bool has_sensors(const Item& item) {
  bool has = false;
  field::each_value(item, [&has]<class Value>(const Value& value, const field::About&) {
    if constexpr (std::is_same_v<Value, Expression>) {
      has = has || value.has_sensors();
    } else if constexpr (std::is_same_v<Value, LawVector>) {
      for (const Expression& e : value) has = has || e.has_sensors();
    } else if constexpr (std::is_same_v<Value, FieldVector>) {
      for (const FieldExpression& e : value) has = has || e.at(0.4567).has_sensors();
    }
  });
  return has;
}

// The first item of the scene whose law has sensors, or its first controller, as messages call it; empty: none.
std::string first_feedback(const Scene& scene);

}  // namespace mbd
