// mbd view: a model, or the motion of a run, as one HTML file.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "libmbd/view/page.hpp"

namespace mbd {

void add_view_command(CLI::App& app, int& status);

// Throws Error in a program that was built without what pages are made of.
void require_pages();

// A number of frames, as options give it. Throws Error unless it is a whole number from 2 to 1e6.
int frames_option(const std::string& text);

// The page of motion.bin, and of history.csv or path.csv if there is one beside it, in a directory of results.
// `stresses`: what pages tell of them, if anything.
using StressesOf = std::function<std::optional<StressesOfOutlines>(const Motion&)>;
Page write_view(const std::filesystem::path& results, const std::filesystem::path& page,
                PageOptions options, const StressesOf& stresses = {});

}  // namespace mbd
