// Pictures of a model or of an instant of its motion, in perspective: SVG, and pixels.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/view/figure.hpp"

namespace mbd {

// A pinhole: of a point x, with d = x - eye, the picture's x = middle + focal d.right / d.ahead and
// y = middle - focal d.above / d.ahead [pixels, from the upper left corner].
struct Camera {
  Vec3 eye = Vec3::Zero();  // [m], from the drawing's centre
  Vec3 right = Vec3::UnitX(), above = Vec3::UnitY(), ahead = -Vec3::UnitZ();
  double focal = 1.0;              // [pixels]
  std::array<double, 2> middle{};  // [pixels]
};

struct PictureOptions {
  int width = 960, height = 600;  // [pixels]
  // Whence: "" as the page begins (flat mechanisms nearly from their front), iso, x, y, z, -x, -y, -z, or "AZ,EL" in
  // degrees. With the axis that points up being k, the azimuth is counted from axis k+1 towards axis k+2 (cyclic), the
  // elevation towards what is up: 0,0 looks from axis k+1.
  std::string from = {};
  bool grid = true;   // and the inertial axes
  bool words = true;  // time and legend
};

struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // rows from the top
};

// All of `stage`, at every one of its frames, is in the picture. Throws Error for a direction it does not know.
Camera camera_of(const Stage& stage, const PictureOptions& options);

// Faces and lines in order of their distance. <metadata> holds the camera as JSON, with "centre" (of the drawing,
// inertial axes) beside it; elements of a part carry its name as data-part.
std::string picture_svg(const Stage& stage, double instant, const Camera& camera,
                        const PictureOptions& options);

// The same by a depth buffer, smoothed by `samples` by `samples` points a pixel.
Pixels picture_pixels(const Stage& stage, double instant, const Camera& camera,
                      const PictureOptions& options, int samples = 3);

}  // namespace mbd
