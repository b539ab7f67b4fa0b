// What the kept trials and rows of a study belong to.
#pragma once

#include <string>
#include <vector>

namespace mbd {

// Of this program, what is in the files of a model (files_of()), and the parameters that are set: another text where one has
// changed.
std::string fingerprint(const std::vector<std::string>& files, const std::vector<std::string>& set);

}  // namespace mbd
