#include <array>
#include <memory>

#include "joints/any_joint_batch.hpp"
#include "joints/joint_batch.hpp"
#include "joints/joint_list.hpp"

namespace mbd::joint {

template <class J>
std::unique_ptr<AnyJointBatch> make_batch_of() {
  return std::make_unique<JointBatch<J>>();
}

namespace {

// Compiles them, for joint_list.cpp.
template <class... J>
constexpr auto all_of(List<J...>) {
  return std::array{&make_batch_of<J>...};
}
[[gnu::used]] constexpr auto types = all_of(Types{});
[[gnu::used]] constexpr auto prescribed = all_of(Prescribed{});

}  // namespace
}  // namespace mbd::joint
