// Pixels as files: PNG by libpng, animated WebP by libwebp, where the program was built with them.
#pragma once

#include <memory>
#include <string>

#include "libmbd/view/picture.hpp"

namespace mbd {

// Throw Error, with what to install, in a program that was built without.
void require_png();
void require_webp();

// The bytes of a PNG file.
std::string png_of(const Pixels& pixels);

// The bytes of an animated WebP file that goes round for ever. Frames that are alike are one, of their time together.
class WebpAnimation {
 public:
  WebpAnimation(int width, int height);  // [pixels]
  ~WebpAnimation();
  void add(const Pixels& frame, int milliseconds);
  std::string finish();

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace mbd
