// HDF5 files that grow by rows and can be read meanwhile (SWMR). libhdf5 is loaded by the first of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

struct z_stream_s;  // of zlib

namespace mbd {

// Empty: files can be written. Else why not, and what to do. Loads libhdf5.
std::string why_no_hdf5();

using Hdf5Attributes = std::vector<std::pair<std::string, std::variant<std::string, double>>>;

// Numbers as HDF5's filters shuffle and deflate read them: all first bytes first, and so on, as a stream of zlib.
class Compressor {
 public:
  Compressor();
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  // Empty where that saves less than a tenth.
  std::string operator()(std::span<const double> numbers);

 private:
  std::unique_ptr<z_stream_s> stream_;
};

// Every function throws Error with the file and the reason (disk full). Nothing is written after that, so that what was
// written before stays as it is.
class Hdf5File {
 public:
  using Series = std::size_t;  // a dataset that grows

  // Replaces an existing file.
  explicit Hdf5File(const std::filesystem::path& file);
  ~Hdf5File();  // closes it, but for errors
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  // Before start(). Paths are "history/time": names within the root or within a group that is there. Members of a group are
  // listed in the order in which they are added.
  void add_group(const std::string& path, const Hdf5Attributes& attributes = {});
  void add_attributes(const Hdf5Attributes& attributes);  // of the file
  void add_text(const std::string& path, const std::string& text,
                const Hdf5Attributes& attributes = {});
  void add_texts(const std::string& path, const std::vector<std::string>& texts);
  void add_numbers(const std::string& path, std::span<const double> numbers,
                   const Hdf5Attributes& attributes = {});
  // Rows of numbers (of bytes), of `shape` each: {} one, {n}, {n, 3}; not empty.
  Series add_series(const std::string& path, const std::vector<std::size_t>& shape,
                    const Hdf5Attributes& attributes = {});
  Series add_bytes(const std::string& path);

  void start();  // others may read from here on

  // Whole rows; on disk after the next flush(), or when they fill a chunk.
  void append(Series series, std::span<const double> numbers);
  void replace(Series bytes, std::string_view text);
  // The last series first: on disk each is at least as long as those added before it.
  // At the end chunks that are not whole are compressed too.
  void flush(bool at_end = false);
  void close();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace mbd
