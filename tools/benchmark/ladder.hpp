#pragma once

namespace mbd {

// Cost of a step for a ladder of scenes, each with one effect more than the one before.
void register_ladder();

}  // namespace mbd
