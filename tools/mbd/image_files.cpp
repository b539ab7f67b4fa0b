#include "tools/mbd/image_files.hpp"

#include "libmbd/core/error.hpp"

#if MBD_HAS_PNG
#include <png.h>
#endif
#if MBD_HAS_WEBP
#include <webp/encode.h>
#include <webp/mux.h>
#endif

namespace mbd {
namespace {

[[noreturn]] [[maybe_unused]] void fail_without(const char* what, const char* package,
                                                const char* instead) {
  throw Error(std::string("this mbd was built without ") + what +
              "; install it (Debian: " + package +
              "; tools/install-dependencies does), configure and build mbd again, or " + instead);
}

}  // namespace

#if MBD_HAS_PNG

void require_png() {}

std::string png_of(const Pixels& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(pixels.width);
  image.height = static_cast<png_uint_32>(pixels.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.rgb.data(), 0, nullptr) == 0)
    throw Error(std::string("the PNG cannot be made: ") + image.message);
  bytes.resize(size);
  return bytes;
}

#else

void require_png() { fail_without("libpng", "libpng-dev", "write .svg, which needs nothing"); }
std::string png_of(const Pixels&) {
  require_png();
  return {};
}

#endif

#if MBD_HAS_WEBP

void require_webp() {}

struct WebpAnimation::Data {
  WebPAnimEncoder* encoder = nullptr;
  WebPConfig config{};
  int time = 0;
};

WebpAnimation::WebpAnimation(int width, int height) : data_(std::make_unique<Data>()) {
  WebPAnimEncoderOptions options;
  if (WebPAnimEncoderOptionsInit(&options) == 0 || WebPConfigInit(&data_->config) == 0)
    throw Error("libwebp is of another version than the one mbd was built with; build mbd again");
  options.allow_mixed = 1;
  data_->config.lossless = 1;
  data_->config.quality = 70.0F;
  data_->encoder = WebPAnimEncoderNew(width, height, &options);
  if (data_->encoder == nullptr) throw Error("the animation is too large for WebP");
}

WebpAnimation::~WebpAnimation() {
  if (data_->encoder != nullptr) WebPAnimEncoderDelete(data_->encoder);
}

void WebpAnimation::add(const Pixels& frame, int milliseconds) {
  WebPPicture picture;
  if (WebPPictureInit(&picture) == 0) throw Error("libwebp is of another version; build mbd again");
  picture.use_argb = 1;
  picture.width = frame.width;
  picture.height = frame.height;
  const bool added = WebPPictureImportRGB(&picture, frame.rgb.data(), 3 * frame.width) != 0 &&
                     WebPAnimEncoderAdd(data_->encoder, &picture, data_->time, &data_->config) != 0;
  WebPPictureFree(&picture);
  if (!added)
    throw Error(std::string("the animation cannot be made: ") +
                WebPAnimEncoderGetError(data_->encoder));
  data_->time += milliseconds;
}

std::string WebpAnimation::finish() {
  WebPData bytes;
  WebPDataInit(&bytes);
  if (WebPAnimEncoderAdd(data_->encoder, nullptr, data_->time, nullptr) == 0 ||
      WebPAnimEncoderAssemble(data_->encoder, &bytes) == 0)
    throw Error(std::string("the animation cannot be made: ") +
                WebPAnimEncoderGetError(data_->encoder));
  std::string text(reinterpret_cast<const char*>(bytes.bytes), bytes.size);
  WebPDataClear(&bytes);
  return text;
}

#else

struct WebpAnimation::Data {};
void require_webp() { fail_without("libwebp", "libwebp-dev", "write single frames with --image"); }
WebpAnimation::WebpAnimation(int, int) { require_webp(); }
WebpAnimation::~WebpAnimation() = default;
void WebpAnimation::add(const Pixels&, int) {}
std::string WebpAnimation::finish() { return {}; }

#endif

}  // namespace mbd
