// What a joint type says of itself; the schema, the reader, compile and the messages follow from it.
#pragma once

namespace mbd::joint {

// Where the frames a and b sit in the reference configuration.
enum class Points {
  one,       // at the joint's point, and beam nodes are there too
  one_away,  // at the joint's point, which may be away from either node
  two        // each at its own point; the parameter is their distance [m]
};

// What signals prescribe: nothing; the angle or the displacement; a translation or a rotation vector.
enum class Law { none, coordinate, translation, rotation };
constexpr int signals_of(Law law) { return law == Law::none ? 0 : law == Law::coordinate ? 1 : 3; }

// A number that a model gives to the joint; it has one if it has a name.
struct Parameter {
  const char* name = "";
  const char* unit = "";
  const char* doc = "";
};

struct Traits {
  bool axis = false;          // e3 is given, as `axis`
  bool second_axis = false;   // e1 is given, as `second_axis`, perpendicular to it
  bool angle = false;         // of b relative to a about e3: can be recorded, and driven if free
  bool displacement = false;  // of b relative to a along e3: the same
  Points points = Points::one;
  Parameter parameter = {};  // not zero
  Law law = Law::none;
};

}  // namespace mbd::joint
