// Joints, drives and prescribed motions of a scene -> constraints of a System, and how output reads them.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "joints/any_joint_batch.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/compile/places.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

struct OwnJoint;  // libmbd/compile/extending.hpp

// Axes of a joint: a rotation whose third column is `third`; the first is `first`, or one perpendicular to it that
// depends on the inertial axes.
Mat3 frame_with_third(const Vec3& third, const std::optional<Vec3>& first = {});

// Throws Error for axes without direction, or not perpendicular.
void check_axes(const std::optional<Vec3>& axis, const std::optional<Vec3>& second_axis,
                const Source& source, const std::string& who);

// Throws Error for a law of motion whose jumps cannot be known before the run.
void check_prescribed(const Expression& law, const Source& source, const std::string& who);

class JointCompiler {
 public:
  // `length`: size of the scene; `is_fused`: whether the joint of that index needs no constraint, because what it joins
  // is one node. All arguments must outlive the compiler.
  JointCompiler(const Scene& scene, System& system, double length, FindPlace find,
                std::function<bool(std::size_t)> is_fused)
      : scene_(scene),
        system_(system),
        length_(length),
        find_(std::move(find)),
        is_fused_(std::move(is_fused)) {}

  void add_all();

  const std::vector<Model::Maker>& makers() const { return makers_; }
  const std::vector<Model::Maker>& fused() const { return fused_; }
  // In the order of the scene.
  std::vector<Model::JointFrames> frames() const;

  // A joint that the scene does not know of, of a type that make() has joints of. `type` is none of the library's.
  OwnJoint add_own(const std::string& name, std::string_view type,
                   std::unique_ptr<joint::AnyJointBatch> (*make)(),
                   const joint::Definition& definition);

  // Frames, nodes and followed angle of a joint for what acts along its free coordinate. Throws Error in the name
  // of `who` if there is no such joint, or it has no angle (`turns`) or displacement.
  const joint::Definition& coordinate(const std::string& joint, bool turns, const Source& source,
                                      const std::string& who) const;

  // How to read the quantity of the record's joint or motion. Throws Error for an unknown one, or one without it.
  schema::JointReading reading(const RecordScene& record, const schema::Quantity& quantity) const;

 private:
  struct Reading : schema::JointReading {
    std::string what;
    std::string why_none;  // why there is nothing to read; empty if there is
  };
  struct Added {
    const joint::AnyJointBatch* batch;
    Index index;
    Index angle;  // followed
  };

  joint::AnyJointBatch* find_batch(std::string_view type) const;
  joint::AnyJointBatch* batch_of(std::string_view type);
  Added add(joint::AnyJointBatch* batch, const std::string& name, const std::string& label,
            const Source& source, joint::Definition definition);
  void add_joint(const JointScene& joint);
  void leave_out(const JointScene& joint, const Attachment& A);
  joint::Definition definition_of(const JointScene& joint, const joint::Traits& traits,
                                  const Attachment& A, const Attachment& B) const;
  std::array<Vec3, 2> points_of(const JointScene& joint, const joint::Traits& traits,
                                const Attachment& A, const Attachment& B) const;
  void check_closed(const JointScene& joint, const Attachment& end, const Vec3& point) const;
  void add_drives(const JointScene& joint, const joint::Definition& definition, std::size_t free);
  void add_drive(const DriveScene& drive, const JointScene& joint,
                 const joint::Definition& definition);
  void add_motion(const MotionScene& motion);
  void prescribe(const MotionScene& motion, int node, std::string_view type, const Mat3& R,
                 const Vec3& point, std::array<int, 3> signals);
  int add_law(const Expression& law, bool is_rate, const Source& source, const std::string& who,
              std::string_view what);
  Vec3 own_point(const Place& place, const Attachment& at, const JointScene& joint,
                 std::string_view attribute) const;
  Pose<double> reference(int node) const { return system_.reference_pose(node); }

  const Scene& scene_;
  System& system_;
  double length_;
  FindPlace find_;
  std::function<bool(std::size_t)> is_fused_;
  std::map<std::string, Reading> readings_;
  std::map<std::string, joint::Definition> definitions_;  // of joints
  std::vector<Model::Maker> makers_, fused_;
};

}  // namespace mbd
