// Springs, bushings, and springs and torques of joints as elements between two nodes: each kind, and the damping
// of each, gets a batch if the scene states it.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elements/pair/batches.hpp"
#include "joints/coordinate_batches.hpp"
#include "libmbd/compile/joints.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

class Springs {
 public:
  // `length`: size of the scene; `rates`: whether it has a transient, without which nothing damps.
  Springs(System& system, double length, bool rates, const JointCompiler& joints, FindPlace find)
      : system_(system), length_(length), rates_(rates), joints_(joints), find_(std::move(find)) {}

  // Throw Error for what is between a thing and itself, or has no direction.
  void add(const SpringScene& spring);
  void add(const BushingScene& bushing);
  // Throw Error for an unknown joint, or one without the coordinate.
  void add(const JointSpringScene& spring);
  void add(const JointTorqueScene& torque);

  void finish();  // hands the batches to the system

  // How to read the quantity of the record's spring; valid as long as the system. Throws Error for an unknown spring,
  // or one without the quantity.
  schema::SpringReading reading(const RecordScene& record, const schema::Quantity& quantity) const;

 private:
  // How output reads a spring: with its damper, what it exerts.
  struct Reading {
    std::string what;
    schema::Quantity::Of of = schema::Quantity::Of::spring;
    std::vector<std::function<double(const State&)>>
        efforts;                                              // tensions, or moments or forces on b
    std::vector<std::function<Vec6(const State&)>> wrenches;  // on b
    std::function<schema::SpringReading::Length(const State&)> length{};
  };
  template <class E>
  ElementBatch<E>& batch(std::unique_ptr<ElementBatch<E>>& made);
  // Puts the law, if there is one, among those of a batch.
  static Characteristic characteristic(double coefficient, const std::optional<LawScene>& law,
                                       std::vector<Law>& laws);

  // Of the two places, whose nodes must differ; nothing within what is rigid, where no spring does anything.
  std::optional<std::array<Attachment, 2>> ends(const Place& a, const Place& b,
                                                const Source& source, const std::string& who) const;
  template <class Coordinate>
  void add_along(const JointSpringScene& spring, const joint::Definition& definition);

  template <class E>
  using Made = std::unique_ptr<ElementBatch<E>>;
  // Of one coordinate of joints.
  template <class Coordinate>
  struct Along {
    Made<joint::JointSpring<Coordinate>> springs;
    Made<joint::JointDamper<Coordinate>> dampers;
    Made<joint::JointTorque<Coordinate>> torques;
  };
  template <class Coordinate>
  Along<Coordinate>& along();
  template <class Coordinate>
  void add_torque(const JointTorqueScene& torque, const Expression& law, std::string_view what);

  System& system_;
  double length_;
  bool rates_;
  const JointCompiler& joints_;
  FindPlace find_;
  std::map<std::string, Reading> readings_;
  Made<Spring> springs_;
  Made<Damper> dampers_;
  Made<Bushing> bushings_;
  Made<BushingDamper> bushing_dampers_;
  Along<joint::Turning> turning_;
  Along<joint::Sliding> sliding_;
};

}  // namespace mbd
