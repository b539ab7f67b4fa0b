// What messages call an item of a scene: its element and, if it has one, its name.
#pragma once

#include <string>
#include <string_view>

#include "libmbd/scene/scene.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {

// `beam "b1"`, or `gravity` of what has no name.
std::string label(std::string_view element, std::string_view name = {});

// "rod.xml:12: what", as messages begin.
std::string said(const Source& source, const std::string& what);

std::string_view element_of(const BeamScene& beam);  // "beam", "arc" or "curve"

inline std::string label(const Section& s) { return label("section", s.name); }
inline std::string label(const BeamScene& b) { return label(element_of(b), b.name); }
inline std::string label(const BodyScene& b) { return label("body", b.name); }
inline std::string label(const RigidScene& r) { return label("rigid", r.name); }
inline std::string label(const JointScene& j) { return label(j.kind, j.name); }
inline std::string label(const MotionScene& m) { return label("motion", m.name); }
inline std::string label(const LoadScene& l) { return label("load", l.name); }
inline std::string label(const DistributedLoadScene& l) { return label("distributed", l.name); }
inline std::string label(const PointMassScene& m) { return label("point_mass", m.name); }
inline std::string label(const SpringScene& s) { return label("spring", s.name); }
inline std::string label(const BushingScene& b) { return label("bushing", b.name); }
inline std::string label(const JointSpringScene& s) { return label("joint_spring", s.name); }
inline std::string label(const JointTorqueScene& t) { return label("joint_torque", t.name); }
inline std::string label(const DragScene& d) { return label("drag", d.name); }
inline std::string label(const AddedMassScene& m) { return label("added_mass", m.name); }
inline std::string label(const RecordScene& r) { return label("record", r.name); }

}  // namespace mbd
