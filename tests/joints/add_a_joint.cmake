# Adds a joint type to a copy of joints/, builds a program that knows it and runs a model that uses it.
# Fails when that takes more than one new file, and two lines (an include, an entry) in the type list.
# Usage: cmake -DSOURCE=… -DBUILD=… -DSCRATCH=… -P add_a_joint.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE "${SCRATCH}")
file(COPY "${SOURCE}/joints" DESTINATION "${SCRATCH}")

# ---- the change ----
file(WRITE "${SCRATCH}/joints/point_in_plane.hpp" [=[
// Point in a plane: a's origin stays in the plane through b's origin across b3.
//
//   x_b.e3 = 0 (force along b3)
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct PointInPlane {
  static constexpr const char* name = "point_in_plane";
  static constexpr const char* doc = "A point of a stays in a plane of b.";
  static constexpr std::tuple rows{position(3)};
  static constexpr Traits traits{.axis = true};
};

}  // namespace mbd::joint
]=])
set(list_file "${SCRATCH}/joints/joint_list.hpp")
file(READ "${list_file}" text)
string(REPLACE "#include \"joints/planar.hpp\"\n"
       "#include \"joints/planar.hpp\"\n#include \"joints/point_in_plane.hpp\"\n" text "${text}")
string(REPLACE "                   Planar,       //\n"
       "                   Planar,       //\n                   PointInPlane,  //\n" text "${text}")
file(WRITE "${list_file}" "${text}")

# ---- what it touched ----
set(new "")
set(changed "")
file(GLOB files RELATIVE "${SCRATCH}/joints" "${SCRATCH}/joints/*")
foreach(name IN LISTS files)
  if(NOT EXISTS "${SOURCE}/joints/${name}")
    list(APPEND new "${name}")
  else()
    file(SHA256 "${SOURCE}/joints/${name}" before)
    file(SHA256 "${SCRATCH}/joints/${name}" after)
    if(NOT before STREQUAL after)
      list(APPEND changed "${name}")
    endif()
  endif()
endforeach()
file(STRINGS "${SOURCE}/joints/joint_list.hpp" lines_before)
file(STRINGS "${list_file}" lines_after)
list(LENGTH lines_before n_before)
list(LENGTH lines_after n_after)
math(EXPR added "${n_after} - ${n_before}")
if(NOT new STREQUAL "point_in_plane.hpp" OR NOT changed STREQUAL "joint_list.hpp" OR NOT added EQUAL 2)
  message(FATAL_ERROR "new: ${new}; changed: ${changed}; lines added: ${added}")
endif()

# ---- it works ----
# Kernels of the types that there were are those of the library: declared here, they are not compiled again.
string(REGEX MATCHALL "List<[^>]*>;" lists "${text}")
string(REGEX REPLACE "//|List<|>;|[ ,;\n]+" " " names "${lists}")
string(REGEX REPLACE " +" ";" names "${names}")
list(REMOVE_ITEM names "" PointInPlane)
set(built "#include \"joints/any_joint_batch.hpp\"\n#include \"joints/joint_list.hpp\"\n\nnamespace mbd::joint {\n")
foreach(name IN LISTS names)
  string(APPEND built "extern template std::unique_ptr<AnyJointBatch> make_batch_of<${name}>();\n")
endforeach()
file(WRITE "${SCRATCH}/built.hpp" "${built}}  // namespace mbd::joint\n")

execute_process(COMMAND "${CMAKE_COMMAND}" --build "${BUILD}" --target mbd_new_joint
                OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the program with the new joint does not build:\n${output}")
endif()

# A body on an inclined plane, held at a point only: m g cos across, g sin along.
file(WRITE "${SCRATCH}/model.xml" [=[
<mbd name="new_joint">
  <body name="b" mass="2" inertia="1 1 1"/>
  <point_in_plane name="P" between="b ground" axis="0.6 0 0.8"/>
  <gravity acceleration="0 0 -10"/>
  <transient duration="1" step="0.01"/>
  <record name="b" at="b" quantities="position"/>
  <record name="P" joint="P" quantities="reaction_force"/>
  <expect quantity="b.position.1" at="1" value="2.4" tolerance="1e-9" source="g sin cos/2"/>
  <expect quantity="b.position.3" at="1" value="-1.8" tolerance="1e-9" source="g sin^2/2"/>
  <expect quantity="P.reaction_force.3" at="1" value="-16" tolerance="1e-6" source="m g cos, on the ground"/>
</mbd>
]=])
execute_process(COMMAND "${SCRATCH}/mbd" run "${SCRATCH}/model.xml" --out "${SCRATCH}/results"
                OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the model with the new joint fails:\n${output}")
endif()
message(STATUS "one new file, two lines in the list\n${output}")
