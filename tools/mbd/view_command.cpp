#include "tools/mbd/view_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/picture.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/image_files.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/stress_options.hpp"
#include "tools/mbd/view_assets.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::string what, beside, output, frames, size;
  std::vector<std::string> set;
  // pictures
  std::string image, animation, time, from, pixels, colour, scale, seconds;
  bool trails = false, bare = false;
  StressOptions stresses;

  bool has_picture() const { return !image.empty() || !animation.empty(); }
};

constexpr double least_size = 1.0, most_size = 1000.0;  // [MB] of a page
constexpr int least_pixels = 16, most_pixels = 8192, most_animated = 2048;
constexpr double frames_a_second = 25.0, shortest = 2.0, longest = 12.0, of_statics = 4.0;  // [s]
constexpr double most_seconds = 600.0, least_delay = 10.0, most_scale = 1e6;
constexpr int most_frames = 2000;  // of an animation

// A whole number of `text`, or nothing.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// What throws an Error, with the name of the option that is wrong before it.
template <class Work>
auto of_option(std::string_view option, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(fmt::format("--{}{}{}", option, option.empty() ? "" : " ", error.what()));
  }
}

PageOptions options_of(const ViewArguments& arguments) {
  PageOptions options;
  if (!arguments.frames.empty()) options.frames = frames_option(arguments.frames);
  if (arguments.size.empty()) return options;
  double size = 0.0;
  const std::string& text = arguments.size;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (code != std::errc() || end != text.data() + text.size() || !(size >= least_size) ||
      !(size <= most_size))
    throw Error(fmt::format("--size {}: write a number of megabytes between {:g} and {:g}", text,
                            least_size, most_size));
  options.most_bytes = static_cast<std::size_t>(size * 1e6);
  return options;
}

void say(const fs::path& file, const Page& page) {
  fmt::print("wrote {} ({:.3g} MB){}: open it in a browser\n", file.string(),
             static_cast<double>(page.html.size()) / 1e6,
             page.of == 1            ? ""
             : page.frames < page.of ? fmt::format(", {} of {} frames", page.frames, page.of)
                                     : fmt::format(", {} frames", page.frames));
}

void check_page(const fs::path& file) {
  if (file.extension() != ".html")
    throw Error(fmt::format("--out {}: the page is HTML; give it a name that ends in .html",
                            file.string()));
}

// What gives reason to doubt that these are results of one run that came to its end.
void say_doubts(const Motion& motion, const std::optional<History>& history = {}) {
  for (const std::string& doubt : doubts_about_run(motion.file, motion.run))
    fmt::print("note: {}\n", doubt);
  if (history && !history->run.empty() && !motion.run.empty() && history->run != motion.run)
    fmt::print("note: {} and {} are of different runs: what is shown does not belong together\n",
               motion.file.string(), history->file.filename().string());
}

// ---- pictures -----------------------------------------------------------------------------------

// Wrong use is said before anything is read.
FigureOptions figure_options(const ViewArguments& arguments) {
  FigureOptions options;
  options.trails = arguments.trails;
  options.colour = arguments.colour;
  if (!arguments.scale.empty()) {
    const std::optional<double> scale = number_of<double>(arguments.scale);
    if (!scale || !(*scale >= 0.0) || !(*scale <= most_scale))
      throw Error(
          fmt::format("--scale {}: write a number from 0 to {:g}", arguments.scale, most_scale));
    options.scale = *scale;
  }
  return options;
}

PictureOptions picture_options(const ViewArguments& arguments) {
  PictureOptions options;
  options.from = arguments.from;
  options.grid = options.words = !arguments.bare;
  if (arguments.pixels.empty()) return options;
  const std::string_view text(arguments.pixels);
  const std::size_t x = text.find('x');
  const std::optional<int> width = number_of<int>(text.substr(0, x)),
                           height =
                               number_of<int>(text.substr(x == text.npos ? text.size() : x + 1));
  const int most = arguments.animation.empty() ? most_pixels : most_animated;
  const auto is_good = [most](const std::optional<int>& n) {
    return n && *n >= least_pixels && *n <= most;
  };
  if (!is_good(width) || !is_good(height))
    throw Error(fmt::format("--pixels {}: write width x height as 960x600, each from {} to {}",
                            arguments.pixels, least_pixels, most));
  options.width = *width;
  options.height = *height;
  return options;
}

double seconds_of(const ViewArguments& arguments, double span, bool is_time) {
  if (arguments.seconds.empty()) return is_time ? std::clamp(span, shortest, longest) : of_statics;
  const std::optional<double> seconds = number_of<double>(arguments.seconds);
  if (!seconds || !(*seconds > 0.0) || !(*seconds <= most_seconds))
    throw Error(fmt::format("--seconds {}: write a number of seconds up to {:g}", arguments.seconds,
                            most_seconds));
  return *seconds;
}

void check_picture_options(const ViewArguments& arguments) {
  if (!arguments.has_picture()) {
    for (const auto& [option, is_given] : {std::pair{"time", !arguments.time.empty()},
                                           {"from", !arguments.from.empty()},
                                           {"pixels", !arguments.pixels.empty()},
                                           {"colour", !arguments.colour.empty()},
                                           {"scale", !arguments.scale.empty()},
                                           {"seconds", !arguments.seconds.empty()},
                                           {"trails", arguments.trails},
                                           {"bare", arguments.bare}})
      if (is_given)
        throw Error(fmt::format(
            "--{} is of pictures; add --image FILE.svg (or .png) or --animation FILE.webp",
            option));
    return;
  }
  if (!arguments.output.empty() || !arguments.size.empty())
    throw Error(
        fmt::format("--{} is of the page, and --image and --animation make none; give them apart",
                    arguments.output.empty() ? "size" : "out"));
  const fs::path image(arguments.image), animation(arguments.animation);
  if (!image.empty() && image.extension() != ".svg" && image.extension() != ".png")
    throw Error(
        fmt::format("--image {}: give it a name that ends in .svg or .png", image.string()));
  if (image.extension() == ".png") require_png();
  if (!animation.empty() && animation.extension() != ".webp")
    throw Error(
        fmt::format("--animation {}: give it a name that ends in .webp", animation.string()));
  if (!animation.empty()) require_webp();
  if (animation.empty())
    for (const auto& [option, text] :
         {std::pair{"frames", &arguments.frames}, {"seconds", &arguments.seconds}})
      if (!text->empty())
        throw Error(
            fmt::format("--{} {}: a picture has one frame; it is of --animation", option, *text));
  if (arguments.time.find(':') != std::string::npos && !image.empty())
    throw Error(fmt::format("--time {}: a picture has one time; a range is of --animation",
                            arguments.time));
  if (!animation.empty() && image.empty() && !arguments.time.empty() &&
      arguments.time.find(':') == std::string::npos)
    throw Error(
        fmt::format("--time {}: an animation has a range of times; write FROM:TO", arguments.time));
}

// An instant of --time.
double instant_of(const Stage& stage, std::string_view text) {
  const std::optional<double> key = number_of<double>(text);
  if (!key) throw Error(fmt::format("--time {}: write a number, as 2.5", text));
  return of_option("time", [&] { return stage.instant(*key); });
}

void animate(const ViewArguments& arguments, const Stage& stage, const Camera& camera,
             const PictureOptions& options) {
  const double end = static_cast<double>(stage.frames() - 1);
  double first = 0.0, last = end;
  if (const std::size_t colon = arguments.time.find(':'); colon != std::string::npos) {
    first = instant_of(stage, std::string_view(arguments.time).substr(0, colon));
    last = instant_of(stage, std::string_view(arguments.time).substr(colon + 1));
    if (!(first < last))
      throw Error(fmt::format("--time {}: the second time is to be the later one", arguments.time));
  }
  const double t0 = stage.key(first), t1 = stage.key(last);
  const double seconds = seconds_of(arguments, t1 - t0, stage.is_time());
  const int count = arguments.frames.empty()
                        ? std::max(2, static_cast<int>(std::lround(seconds * frames_a_second)))
                        : frames_option(arguments.frames);
  const double delay = 1000.0 * seconds / count;
  if (count > most_frames || delay < least_delay)
    throw Error(fmt::format(
        "{} frames in {:g} s: an animation has at most {} frames, and each at least {:g} ms; "
        "give other --seconds or --frames",
        count, seconds, most_frames, least_delay));
  WebpAnimation animation(options.width, options.height);
  const bool is_terminal = isatty(STDERR_FILENO);
  int shown = 0;
  for (int k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / (count - 1);
    // Evenly in time; of load steps, a step like another.
    const double instant = !stage.is_time() ? first + share * (last - first)
                           : k + 1 == count ? last
                                            : stage.instant(t0 + share * (t1 - t0));
    const int until = static_cast<int>(std::lround(delay * (k + 1)));
    animation.add(picture_pixels(stage, instant, camera, options, 2), until - shown);
    shown = until;
    if (is_terminal) show_progress(fmt::format("frame {} of {}", k + 1, count));
  }
  if (is_terminal) show_progress("");
  const std::string bytes = animation.finish();
  write_file(arguments.animation, bytes);
  fmt::print("wrote {} ({:.3g} MB): {} frames, {:.3g} s\n", arguments.animation,
             static_cast<double>(bytes.size()) / 1e6, count, seconds);
}

void draw(const ViewArguments& arguments, const Stage& stage) {
  const PictureOptions options = picture_options(arguments);
  const Camera camera = of_option("", [&] { return camera_of(stage, options); });
  if (!arguments.image.empty()) {
    const double instant = arguments.time.empty() ? static_cast<double>(stage.frames() - 1)
                                                  : instant_of(stage, arguments.time);
    write_file(arguments.image, fs::path(arguments.image).extension() == ".svg"
                                    ? picture_svg(stage, instant, camera, options)
                                    : png_of(picture_pixels(stage, instant, camera, options)));
    fmt::print("wrote {}\n", arguments.image);
  }
  if (!arguments.animation.empty()) animate(arguments, stage, camera, options);
}

// ---- commands -------------------------------------------------------------------------------------

int view_results(const ViewArguments& arguments) {
  if (!arguments.set.empty() && !arguments.stresses.asked)
    throw Error("--set " + arguments.set.front() +
                ": these are results; run the model with it, or name the model");
  const fs::path given(arguments.what);
  const fs::path directory = fs::is_directory(given) ? given : given.parent_path();
  if (arguments.has_picture()) {
    picture_options(arguments);
    FigureOptions options = figure_options(arguments);
    if (fs::path(arguments.image).extension() == ".svg") options.round = 12, options.pieces = 2;
    const Motion motion = read_motion(directory / "motion.bin");
    say_doubts(motion);
    draw(arguments, of_option("", [&] { return Stage(motion, options); }));
    return 0;
  }
  const fs::path page =
      arguments.output.empty() ? directory / "view.html" : fs::path(arguments.output);
  check_page(page);
  say(page, write_view(directory, page, options_of(arguments),
                       [&arguments](const Motion& motion) -> std::optional<StressesOfOutlines> {
                         if (arguments.stresses.asked)
                           return stresses_of_outlines(arguments.stresses, arguments.set, motion);
                         if (has_section_stresses(motion))
                           fmt::print(
                               "note: sections are stated by material: --stresses shows "
                               "stresses on their surface\n");
                         return std::nullopt;
                       }));
  return 0;
}

// A model that is not one (XML, unknown attributes) is an error; one that cannot be assembled is shown with its fault.
int view_model(const ViewArguments& arguments) {
  if (!arguments.animation.empty())
    throw Error(
        "--animation " + arguments.animation +
        ": a model does not move before it runs; run it with --motion and name the directory "
        "of its results");
  if (!arguments.frames.empty())
    throw Error("--frames " + arguments.frames +
                ": a model has no frames; run it with --motion and name the directory of its "
                "results");
  const Scene scene = read_model(arguments.what, to_overrides(arguments.set));
  const fs::path file = results_directory(arguments.output, arguments.what, "model.html");
  check_page(file);
  std::optional<FigureOptions> figure;
  if (arguments.has_picture()) {
    figure = figure_options(arguments);
    picture_options(arguments);
    if (fs::path(arguments.image).extension() == ".svg") figure->round = 12, figure->pieces = 2;
  }
  std::string shown, fault;
  try {
    const Model model = compile(scene);
    shown = drawing(scene, model);
  } catch (const Error& error) {
    fault = error.what();
    shown = drawing(scene, fault);
  }
  if (figure) {
    draw(arguments, of_option("", [&] { return Stage(shown, *figure); }));
    if (!fault.empty()) complain("mbd: " + fault + "\n");
    return fault.empty() ? 0 : 1;
  }
  const Page page = model_page(view_assets(), shown, options_of(arguments));
  if (arguments.output.empty()) make_directory(file.parent_path());
  write_file(file, page.html);
  say(file, page);
  if (fault.empty()) return 0;
  complain("mbd: " + fault + "\n");
  return 1;
}

bool is_results(const fs::path& what) {
  std::error_code code;
  return fs::is_directory(what, code) || what.filename() == "motion.bin";
}

std::optional<History> history_beside(const fs::path& results) {
  std::error_code code;
  for (const char* name : {"history.csv", "path.csv"})
    if (fs::is_regular_file(results / name, code)) return read_history(results / name);
  return std::nullopt;
}

// One of two: a run, or a model.
struct Loaded {
  fs::path place;  // of pages beside it
  std::optional<Motion> motion;
  std::optional<History> history;
  std::string drawing, name;
};

Loaded load(const std::string& what, const ViewArguments& arguments) {
  const fs::path given(what);
  Loaded made;
  if (is_results(given)) {
    made.place = fs::is_directory(given) ? given : given.parent_path();
    made.motion = read_motion(made.place / "motion.bin");
    made.history = history_beside(made.place);
    say_doubts(*made.motion, made.history);
    made.name = fs::weakly_canonical(made.place).filename().string();
  } else {
    const Scene scene = read_model(what, to_overrides(arguments.set));
    made.place = fs::path("results") / given.stem();
    made.drawing = drawing(scene, compile(scene));
    made.name = given.stem().string() + " (model)";
  }
  return made;
}

int view_two(const ViewArguments& arguments) {
  if (arguments.has_picture())
    throw Error(
        "two runs are shown together in the page; give --image and --animation of one of them");
  if (!arguments.set.empty() && is_results(arguments.what) && is_results(arguments.beside))
    throw Error("--set " + arguments.set.front() +
                ": these are results; run the models with it, or name a model");
  std::array<Loaded, 2> both{load(arguments.what, arguments), load(arguments.beside, arguments)};
  if (both[0].name == both[1].name) {
    both[0].name = arguments.what;
    both[1].name = arguments.beside;
    if (both[0].name == both[1].name) both[1].name += " (2)";
  }
  const auto shown = [](const Loaded& one) {
    return Shown{one.name, one.drawing, one.motion ? &*one.motion : nullptr,
                 one.history ? &*one.history : nullptr};
  };
  const fs::path file =
      arguments.output.empty() ? both[0].place / "overlay.html" : fs::path(arguments.output);
  check_page(file);
  const Page page =
      overlaid_page(view_assets(), shown(both[0]), shown(both[1]), options_of(arguments));
  if (arguments.output.empty()) make_directory(file.parent_path());
  write_file(file, page.html);
  say(file, page);
  return 0;
}

// Before anything is read.
void check_stress_options(const ViewArguments& arguments) {
  check_model_has_use(arguments.stresses);
  if (!arguments.stresses.asked) return;
  if (arguments.has_picture())
    throw Error(
        "--stresses is of the page, and --image and --animation make none; give them apart");
  if (!arguments.beside.empty()) throw Error("--stresses is of the page of one run; name one");
  if (!is_results(arguments.what)) check_no_stresses_of_model(arguments.stresses);
}

int view(const ViewArguments& arguments) {
  check_picture_options(arguments);
  check_stress_options(arguments);
  if (!arguments.has_picture()) require_pages();
  if (!arguments.beside.empty()) return view_two(arguments);
  return is_results(arguments.what) ? view_results(arguments) : view_model(arguments);
}

}  // namespace

void require_pages() {
  if (view_assets().html.empty())
    throw Error(
        "this mbd was built without three.js and makes no pages; install it (Debian: "
        "libjs-three; tools/install-dependencies does), configure and build mbd again");
}

int frames_option(const std::string& text) {
  constexpr int most = 1'000'000;
  int count = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (code != std::errc() || end != text.data() + text.size() || count < 2 || count > most)
    throw Error(fmt::format("--frames {}: write a whole number from 2 to {}", text, most));
  return count;
}

Page write_view(const fs::path& results, const fs::path& page, PageOptions options,
                const StressesOf& stresses_of) {
  const Motion motion = read_motion(results / "motion.bin");
  const std::optional<History> history = history_beside(results);
  say_doubts(motion, history);
  const std::optional<StressesOfOutlines> stresses =
      stresses_of ? stresses_of(motion) : std::nullopt;
  if (stresses) options.stresses = &*stresses;
  Page made = motion_page(view_assets(), motion, history ? &*history : nullptr, options);
  write_file(page, made.html);
  return made;
}

namespace {

void add_picture_options(CLI::App& command, ViewArguments& arguments) {
  const auto text_option = [&](const char* name, std::string& value, const char* what,
                               const char* type) {
    command.add_option(name, value, what)->check(not_empty, "", "")->type_name(type);
  };
  text_option("--image", arguments.image, "a picture in place of the page: SVG or PNG",
              "FILE.svg|FILE.png");
  text_option("--animation", arguments.animation, "an animated picture in place of the page",
              "FILE.webp");
  text_option("--time", arguments.time,
              "time [s] (or load factor) of the picture, default: the end; FROM:TO of an "
              "animation, default: all",
              "T");
  text_option("--from", arguments.from,
              "whence: iso, x, y, z, -x, -y, -z, or azimuth and elevation [degrees]; default: as "
              "the page begins",
              "VIEW");
  text_option("--pixels", arguments.pixels, "width and height of pictures; default: 960x600",
              "WxH");
  text_option("--colour", arguments.colour,
              "colour of beams: displacement, velocity, N, Q, T (torque), M (bending) or energy "
              "(strain energy per length), with a legend",
              "QUANTITY");
  text_option("--scale", arguments.scale, "displacements times this number; default: 1", "F");
  text_option(
      "--seconds", arguments.seconds,
      "how long an animation takes; default: as the run, from 2 to 12 s, and 4 s of load steps",
      "S");
  command.add_flag("--trails", arguments.trails,
                   "paths of what is recorded, and of bodies, in pictures");
  command.add_flag("--bare", arguments.bare, "pictures without ground, axes, time and legend");
}

}  // namespace

void add_view_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* const command = app.add_subcommand(
      "view", "Makes a page that shows a model, or the motion of a run, in 3-D in a browser.");
  command
      ->add_option(
          "MODEL_OR_DIR", arguments->what,
          "model file (XML), or directory of a run that kept its motion (mbd run --motion)")
      ->required();
  command
      ->add_option("SECOND_MODEL_OR_DIR", arguments->beside,
                   "a second model or run, shown with the first in one picture, at its times")
      ->check(not_empty, "", "");
  command
      ->add_option(
          "-o,--out", arguments->output,
          "page; default: view.html beside the motion (overlay.html of two), or results/, the "
          "model's name, and model.html")
      ->check(not_empty, "", "")
      ->type_name("FILE.html");
  add_set_option(*command, arguments->set);
  command
      ->add_option(
          "--frames", arguments->frames,
          "show at most N frames, evenly chosen; of an animation: N frames, default: 25 a second")
      ->check(not_empty, "", "")
      ->type_name("N");
  command
      ->add_option("--size", arguments->size,
                   "largest page [MB], for which frames are left out; default: 20")
      ->check(not_empty, "", "")
      ->type_name("MB");
  add_stress_options(
      *command, arguments->stresses,
      "of a run, also colours by stresses on the surface of beams whose sections are "
      "stated by material and shape");
  add_picture_options(*command, *arguments);
  set_examples(*command,
               "mbd view models/four_bar.xml\n"
               "mbd run models/four_bar.xml --motion && mbd view results/four_bar\n"
               "mbd view results/four_bar --frames 200 --out four_bar.html\n"
               "mbd view models/chain.xml --set N=5 --out chain.html\n"
               "mbd view results/fine results/coarse\n"
               "mbd view results/four_bar_boxes --stresses\n"
               "mbd view models/four_bar.xml --image four_bar.svg\n"
               "mbd view results/four_bar --image bent.png --time 9 --from 30,20 --colour M\n"
               "mbd view results/four_bar --animation four_bar.webp --time 6:16 --trails");
  command->callback([arguments, &status] { status = view(*arguments); });
}

}  // namespace mbd
