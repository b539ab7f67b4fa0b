#include "joints/joint_list.hpp"

#include "joints/any_joint_batch.hpp"

namespace mbd::joint {

std::unique_ptr<AnyJointBatch> make_joint_batch(std::string_view name) {
  std::unique_ptr<AnyJointBatch> batch;
  const auto try_type = [&]<class J>() {
    if (name == J::name) batch = make_batch_of<J>();
  };
  for_each(Types{}, try_type);
  for_each(Prescribed{}, try_type);
  return batch;
}

}  // namespace mbd::joint
