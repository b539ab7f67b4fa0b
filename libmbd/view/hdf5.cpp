#include "libmbd/view/hdf5.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <mutex>

#include "libmbd/core/error.hpp"

#ifdef MBD_HDF5_LIBRARY
#include <dlfcn.h>
#include <hdf5.h>
#undef H5OPEN  // constants call the library by these
#define H5OPEN
#undef H5CHECK
#define H5CHECK
#endif

namespace mbd {

static_assert(std::endian::native == std::endian::little, "chunks have the least byte first");

std::string Compressor::operator()(std::span<const double> numbers) {
  constexpr std::size_t width = sizeof(double), most_sampled = 1024;
  constexpr double disordered = 7.0 / 8.0;  // of the bits of a byte: not worth a try
  const std::size_t count = numbers.size(), size = count * width;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(numbers.data());
  if (count == 0 || size > (std::size_t(1) << 30)) return {};
  if (!stream_) {
    stream_ = std::make_unique<z_stream>();
    // A small window, which stays in the cache.
    if (deflateInit2(stream_.get(), 0, Z_DEFLATED, 12, 5, Z_DEFAULT_STRATEGY) != Z_OK) {
      stream_.reset();
      return {};
    }
  }
  z_stream& stream = *stream_;
  std::vector<unsigned char> plane(count);
  std::string packed(size + size / 8 + 1024, '\0');
  int level = 0, strategy = Z_DEFAULT_STRATEGY, answer = deflateReset(&stream);
  if (answer == Z_OK) answer = deflateParams(&stream, level, strategy);
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  for (std::size_t k = 0; k < width && answer == Z_OK; ++k) {
    for (std::size_t i = 0; i < count; ++i) plane[i] = bytes[i * width + k];
    // Low bytes of mantissas are noise, on which a compressor would lose most of its time: stored.
    std::array<int, 256> times{};
    const std::size_t stride = (count + most_sampled - 1) / most_sampled;
    int samples = 0;
    for (std::size_t i = 0; i < count; i += stride, ++samples) ++times[plane[i]];
    const double most_bits = std::min(8.0, std::log2(static_cast<double>(samples)));
    double bits = std::log2(static_cast<double>(samples));
    for (const int n : times)
      if (n > 1) bits -= n * std::log2(static_cast<double>(n)) / samples;
    const int wanted = bits < disordered * most_bits ? 1 : 0;
    if (wanted != level) answer = deflateParams(&stream, level = wanted, strategy);
    stream.next_in = plane.data();
    stream.avail_in = static_cast<uInt>(count);
    if (answer == Z_OK) answer = deflate(&stream, k + 1 < width ? Z_NO_FLUSH : Z_FINISH);
    if (stream.avail_in != 0) answer = Z_BUF_ERROR;
  }
  const std::size_t made = stream.total_out;
  if (answer != Z_STREAM_END || 10 * made > 9 * size) return {};
  packed.resize(made);
  return packed;
}

Compressor::Compressor() = default;
Compressor::~Compressor() {
  if (stream_) deflateEnd(stream_.get());
}

#ifdef MBD_HDF5_LIBRARY

namespace {

// What is used of libhdf5: its functions, and its constants, which are variables.
#define MBD_HDF5_FUNCTIONS(f)                                                                      \
  f(H5dont_atexit) f(H5open) f(H5Eset_auto2) f(H5Ewalk2) f(H5Eclear2) f(H5Pcreate) f(H5Pclose)     \
      f(H5Pset_libver_bounds) f(H5Pset_chunk) f(H5Pset_shuffle) f(H5Pset_deflate)                  \
          f(H5Pset_fill_value) f(H5Pset_link_creation_order) f(H5Fcreate) f(H5Fclose)              \
              f(H5Fstart_swmr_write) f(H5Fflush) f(H5Gcreate2) f(H5Gclose) f(H5Oopen) f(H5Oclose)  \
                  f(H5Screate) f(H5Screate_simple) f(H5Sclose) f(H5Tcopy) f(H5Tset_size)           \
                      f(H5Tset_cset) f(H5Tclose) f(H5Dcreate2) f(H5Dclose) f(H5Dwrite)             \
                          f(H5Dwrite_chunk) f(H5Dset_extent) f(H5Dflush) f(H5Acreate2) f(H5Awrite) \
                              f(H5Aclose)
#define MBD_HDF5_CONSTANTS(f)                                                                      \
  f(H5T_NATIVE_DOUBLE_g) f(H5T_IEEE_F64LE_g) f(H5T_NATIVE_UINT8_g) f(H5T_STD_U8LE_g) f(H5T_C_S1_g) \
      f(H5P_CLS_FILE_ACCESS_ID_g) f(H5P_CLS_DATASET_CREATE_ID_g) f(H5P_CLS_GROUP_CREATE_ID_g)      \
          f(H5P_CLS_FILE_CREATE_ID_g)

struct Library {
#define MBD_DECLARE(name) decltype(&::name) name = nullptr;
  MBD_HDF5_FUNCTIONS(MBD_DECLARE)
  MBD_HDF5_CONSTANTS(MBD_DECLARE)
#undef MBD_DECLARE
  std::string fault;
};

const Library& library() {
  static const Library loaded = [] {
    Library l;
    void* const handle = dlopen(MBD_HDF5_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
    if (handle == nullptr) {
      const char* const why = dlerror();
      l.fault = std::string("HDF5 cannot be loaded (") + (why ? why : MBD_HDF5_LIBRARY) +
                "); install libhdf5-103-1 (Debian), or leave hdf5 out";
      return l;
    }
    const auto find = [&]<class T>(T*& member, const char* name) {
      member = reinterpret_cast<T*>(dlsym(handle, name));
      if (member == nullptr && l.fault.empty())
        l.fault = std::string(MBD_HDF5_LIBRARY) + " has no " + name +
                  "; install libhdf5 1.10.7 or later, or leave hdf5 out";
    };
#define MBD_FIND(name) find(l.name, #name);
    MBD_HDF5_FUNCTIONS(MBD_FIND)
    MBD_HDF5_CONSTANTS(MBD_FIND)
#undef MBD_FIND
    if (!l.fault.empty()) return l;
    l.H5dont_atexit();  // it would try again to write what could not be written
    if (l.H5open() < 0) l.fault = std::string(MBD_HDF5_LIBRARY) + " does not start";
    if (l.fault.empty()) l.H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return l;
  }();
  if (!loaded.fault.empty()) throw Error(loaded.fault);
  return loaded;
}

// Debian's serial library takes one call at a time.
std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

// An identifier of libhdf5, closed at the end of its scope.
class Id {
 public:
  using Close = herr_t (*)(hid_t);

  Id(hid_t id, Close close) : id_(id), close_(close) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  void abandon() { id_ = -1; }

 private:
  hid_t id_;
  Close close_;
};

// The innermost reason that libhdf5 gives.
std::string reason(const Library& h5, int number) {
  if (number != 0) return std::strerror(number);
  std::string text;
  const auto take = [](unsigned n, const H5E_error2_t* error, void* out) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
    return 0;
  };
  h5.H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take, &text);
  return text.empty() ? "unknown reason" : text;
}

constexpr std::size_t chunk_bytes = 1 << 16;
constexpr std::size_t most_rows = 1024;  // in a chunk
constexpr unsigned raw = 3;              // mask: without shuffle, without deflate

std::pair<std::string, std::string> split(const std::string& path) {
  const std::size_t at = path.find('/');
  return at == std::string::npos ? std::pair{std::string(), path}
                                 : std::pair{path.substr(0, at), path.substr(at + 1)};
}

}  // namespace

std::string why_no_hdf5() {
  try {
    const std::lock_guard lock(one_at_a_time());
    library();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

struct Hdf5File::Content {
  struct Grown {
    Id dataset;
    std::vector<hsize_t> shape;  // of the dataset, 0 rows first
    std::size_t width = 1;       // numbers of a row
    std::size_t rows_of_chunk = 1;
    std::vector<double> chunk;  // the last one
    std::size_t filled = 0;     // rows of it
    hsize_t before = 0;         // rows of those before it
    bool is_dirty = false, is_raw = false;
    bool is_bytes = false;
  };

  explicit Content(std::filesystem::path path) : h5(library()), file_path(std::move(path)) {
    std::error_code code;
    std::filesystem::remove(file_path, code);
    const Id access(h5.H5Pcreate(*h5.H5P_CLS_FILE_ACCESS_ID_g), h5.H5Pclose),
        creation(h5.H5Pcreate(*h5.H5P_CLS_FILE_CREATE_ID_g), h5.H5Pclose);
    h5.H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);  // what SWMR needs
    errno = 0;
    const hid_t made = h5.H5Fcreate(file_path.c_str(), H5F_ACC_TRUNC, creation, access);
    if (made < 0) fail();
    file.emplace_back(made, h5.H5Fclose);
  }

  // Nothing is written after a failure, not by closing either: libhdf5 keeps what it could not write.
  [[noreturn]] void fail() {
    const std::string why = reason(h5, errno);
    abandon();
    throw Error(file_path.string() + ": cannot be written (" + why + ")" +
                (has_started ? "; it holds what was written before" : ""));
  }
  void abandon() {
    for (Grown& g : series) g.dataset.abandon();
    for (Id& id : file) id.abandon();
    is_broken = true;
  }
  template <class T>
  T checked(T result) {
    if (result < 0) fail();
    return result;
  }
  Id kept(hid_t id, Id::Close close) { return Id(checked(id), close); }

  hid_t root() {
    if (is_broken || file.empty()) throw Error(file_path.string() + ": is not written any more");
    errno = 0;
    return file.front();
  }

  Id text_type() {
    Id type = kept(h5.H5Tcopy(*h5.H5T_C_S1_g), h5.H5Tclose);
    checked(h5.H5Tset_size(type, H5T_VARIABLE));
    checked(h5.H5Tset_cset(type, H5T_CSET_UTF8));
    return type;
  }
  void attach(hid_t object, const Hdf5Attributes& attributes) {
    if (attributes.empty()) return;
    const Id scalar = kept(h5.H5Screate(H5S_SCALAR), h5.H5Sclose), text = text_type();
    for (const auto& [name, value] : attributes) {
      const bool is_text = std::holds_alternative<std::string>(value);
      const Id attribute =
          kept(h5.H5Acreate2(object, name.c_str(),
                             is_text ? static_cast<hid_t>(text) : *h5.H5T_IEEE_F64LE_g, scalar,
                             H5P_DEFAULT, H5P_DEFAULT),
               h5.H5Aclose);
      if (is_text) {
        const char* const words = std::get<std::string>(value).c_str();
        checked(h5.H5Awrite(attribute, text, &words));
      } else {
        checked(h5.H5Awrite(attribute, *h5.H5T_NATIVE_DOUBLE_g, &std::get<double>(value)));
      }
    }
  }

  template <class Make>
  void in_parent(const std::string& path, const Make& make) {
    const auto [group, name] = split(path);
    if (group.empty()) {
      make(root(), name);
      return;
    }
    const Id parent = kept(h5.H5Oopen(root(), group.c_str(), H5P_DEFAULT), h5.H5Oclose);
    make(static_cast<hid_t>(parent), name);
  }

  void add_dataset(const std::string& path, hid_t of_file, hid_t of_memory, hid_t space,
                   const void* data, const Hdf5Attributes& attributes) {
    in_parent(path, [&](hid_t parent, const std::string& name) {
      const Id dataset = kept(h5.H5Dcreate2(parent, name.c_str(), of_file, space, H5P_DEFAULT,
                                            H5P_DEFAULT, H5P_DEFAULT),
                              h5.H5Dclose);
      if (data != nullptr)
        checked(h5.H5Dwrite(dataset, of_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
      attach(dataset, attributes);
    });
  }

  Series add_series(const std::string& path, const std::vector<std::size_t>& shape, bool is_bytes,
                    const Hdf5Attributes& attributes) {
    std::vector<hsize_t> size{0}, most{H5S_UNLIMITED}, chunk{1};
    std::size_t width = 1;
    for (const std::size_t n : shape) {
      size.push_back(n);
      most.push_back(n);
      chunk.push_back(n);
      width *= n;
    }
    const std::size_t bytes = is_bytes ? 1 : sizeof(double);
    chunk[0] = std::clamp<std::size_t>(chunk_bytes / (bytes * width), 1,
                                       is_bytes ? chunk_bytes : most_rows);
    const int rank = static_cast<int>(size.size());
    const Id space = kept(h5.H5Screate_simple(rank, size.data(), most.data()), h5.H5Sclose),
             creation = kept(h5.H5Pcreate(*h5.H5P_CLS_DATASET_CREATE_ID_g), h5.H5Pclose);
    checked(h5.H5Pset_chunk(creation, rank, chunk.data()));
    if (!is_bytes) {
      const double nothing = std::nan("");
      checked(h5.H5Pset_fill_value(creation, *h5.H5T_NATIVE_DOUBLE_g, &nothing));
      checked(h5.H5Pset_shuffle(creation));
      checked(h5.H5Pset_deflate(creation, 1));
    }
    in_parent(path, [&](hid_t parent, const std::string& name) {
      Id dataset = kept(
          h5.H5Dcreate2(parent, name.c_str(), is_bytes ? *h5.H5T_STD_U8LE_g : *h5.H5T_IEEE_F64LE_g,
                        space, H5P_DEFAULT, creation, H5P_DEFAULT),
          h5.H5Dclose);
      attach(dataset, attributes);
      series.push_back({std::move(dataset),
                        size,
                        width,
                        static_cast<std::size_t>(chunk[0]),
                        {},
                        0,
                        0,
                        false,
                        false,
                        is_bytes});
    });
    return series.size() - 1;
  }

  // The last chunk, as far as it is filled. Compressed once it is whole, or at the end: one that has been written before is
  // there with its full size, and stays in its place.
  void write_chunk(Grown& g, bool at_end) {
    if (!g.is_dirty) return;
    const bool is_whole = g.filled == g.rows_of_chunk;
    std::vector<hsize_t> offset(g.shape.size(), 0);
    offset[0] = g.before;
    g.shape[0] = g.before + g.filled;
    g.chunk.resize(g.rows_of_chunk * g.width, 0.0);
    const std::string packed = (is_whole || at_end) && !g.is_raw ? compress(g.chunk) : "";
    root();
    checked(h5.H5Dset_extent(g.dataset, g.shape.data()));
    if (packed.empty())
      checked(h5.H5Dwrite_chunk(g.dataset, H5P_DEFAULT, raw, offset.data(),
                                g.chunk.size() * sizeof(double), g.chunk.data()));
    else
      checked(h5.H5Dwrite_chunk(g.dataset, H5P_DEFAULT, 0, offset.data(), packed.size(),
                                packed.data()));
    g.is_dirty = false;
    g.is_raw = packed.empty();
    if (!is_whole) return;
    g.before += g.filled;
    g.filled = 0;
    g.is_raw = false;
    g.chunk.clear();
  }

  void flush(bool at_end) {
    for (std::size_t i = series.size(); i-- > 0;) {
      Grown& g = series[i];
      if (g.is_bytes) continue;
      write_chunk(g, at_end);
      root();
      if (!at_end) checked(h5.H5Dflush(g.dataset));
    }
    if (at_end) checked(h5.H5Fflush(root(), H5F_SCOPE_GLOBAL));
  }

  const Library& h5;
  std::filesystem::path file_path;
  std::vector<Id> file;  // one, as long as it is open
  std::vector<Grown> series;
  Compressor compress;
  bool has_started = false, is_broken = false;
};

Hdf5File::Hdf5File(const std::filesystem::path& file) {
  const std::lock_guard lock(one_at_a_time());
  content_ = std::make_unique<Content>(file);
}

Hdf5File::~Hdf5File() {
  const std::lock_guard lock(one_at_a_time());
  content_.reset();
}

void Hdf5File::add_group(const std::string& path, const Hdf5Attributes& attributes) {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  const Id creation = c.kept(c.h5.H5Pcreate(*c.h5.H5P_CLS_GROUP_CREATE_ID_g), c.h5.H5Pclose);
  c.checked(
      c.h5.H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  const Id group = c.kept(
      c.h5.H5Gcreate2(c.root(), path.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), c.h5.H5Gclose);
  c.attach(group, attributes);
}

void Hdf5File::add_attributes(const Hdf5Attributes& attributes) {
  const std::lock_guard lock(one_at_a_time());
  content_->attach(content_->root(), attributes);
}

void Hdf5File::add_text(const std::string& path, const std::string& text,
                        const Hdf5Attributes& attributes) {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  const Id space = c.kept(c.h5.H5Screate(H5S_SCALAR), c.h5.H5Sclose), type = c.text_type();
  const char* const words = text.c_str();
  c.add_dataset(path, type, type, space, &words, attributes);
}

void Hdf5File::add_texts(const std::string& path, const std::vector<std::string>& texts) {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  const hsize_t count = texts.size();
  const Id space = c.kept(c.h5.H5Screate_simple(1, &count, nullptr), c.h5.H5Sclose),
           type = c.text_type();
  std::vector<const char*> words;
  for (const std::string& text : texts) words.push_back(text.c_str());
  c.add_dataset(path, type, type, space, words.data(), {});
}

void Hdf5File::add_numbers(const std::string& path, std::span<const double> numbers,
                           const Hdf5Attributes& attributes) {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  const hsize_t count = numbers.size();
  const Id space = c.kept(c.h5.H5Screate_simple(1, &count, nullptr), c.h5.H5Sclose);
  c.add_dataset(path, *c.h5.H5T_IEEE_F64LE_g, *c.h5.H5T_NATIVE_DOUBLE_g, space, numbers.data(),
                attributes);
}

Hdf5File::Series Hdf5File::add_series(const std::string& path,
                                      const std::vector<std::size_t>& shape,
                                      const Hdf5Attributes& attributes) {
  const std::lock_guard lock(one_at_a_time());
  return content_->add_series(path, shape, false, attributes);
}

Hdf5File::Series Hdf5File::add_bytes(const std::string& path) {
  const std::lock_guard lock(one_at_a_time());
  return content_->add_series(path, {}, true, {});
}

void Hdf5File::start() {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  c.checked(c.h5.H5Fstart_swmr_write(c.root()));
  c.has_started = true;
}

void Hdf5File::append(Series series, std::span<const double> numbers) {
  Content::Grown& g = content_->series[series];
  while (!numbers.empty()) {
    const std::size_t rows = std::min(numbers.size() / g.width, g.rows_of_chunk - g.filled);
    const auto piece = numbers.first(rows * g.width);
    g.chunk.resize(g.filled * g.width);  // what was there to fill it up is no row
    g.chunk.insert(g.chunk.end(), piece.begin(), piece.end());
    g.filled += rows;
    g.is_dirty = true;
    numbers = numbers.subspan(piece.size());
    if (g.filled < g.rows_of_chunk) continue;
    const std::lock_guard lock(one_at_a_time());
    content_->write_chunk(g, false);
  }
}

void Hdf5File::replace(Series bytes, std::string_view text) {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  Content::Grown& g = c.series[bytes];
  const hsize_t size = text.size();
  c.root();
  c.checked(c.h5.H5Dset_extent(g.dataset, &size));
  c.checked(c.h5.H5Dwrite(g.dataset, *c.h5.H5T_NATIVE_UINT8_g, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          text.data()));
}

void Hdf5File::flush(bool at_end) {
  const std::lock_guard lock(one_at_a_time());
  content_->flush(at_end);
}

void Hdf5File::close() {
  const std::lock_guard lock(one_at_a_time());
  Content& c = *content_;
  c.flush(true);
  c.series.clear();
  const hid_t id = c.root();
  // First to disk, which can fail; what is then left for closing is little.
  c.checked(c.h5.H5Fflush(id, H5F_SCOPE_GLOBAL));
  for (Id& open : c.file) open.abandon();
  c.file.clear();
  if (c.h5.H5Fclose(id) < 0) c.fail();
}

#else  // without libhdf5

std::string why_no_hdf5() {
  return "this mbd was built without HDF5; install libhdf5-dev (tools/install-dependencies does), "
         "configure and build mbd again, or leave hdf5 out";
}

struct Hdf5File::Content {};
Hdf5File::Hdf5File(const std::filesystem::path&) { throw Error(why_no_hdf5()); }
Hdf5File::~Hdf5File() = default;
void Hdf5File::add_group(const std::string&, const Hdf5Attributes&) {}
void Hdf5File::add_attributes(const Hdf5Attributes&) {}
void Hdf5File::add_text(const std::string&, const std::string&, const Hdf5Attributes&) {}
void Hdf5File::add_texts(const std::string&, const std::vector<std::string>&) {}
void Hdf5File::add_numbers(const std::string&, std::span<const double>, const Hdf5Attributes&) {}
Hdf5File::Series Hdf5File::add_series(const std::string&, const std::vector<std::size_t>&,
                                      const Hdf5Attributes&) {
  return 0;
}
Hdf5File::Series Hdf5File::add_bytes(const std::string&) { return 0; }
void Hdf5File::start() {}
void Hdf5File::append(Series, std::span<const double>) {}
void Hdf5File::replace(Series, std::string_view) {}
void Hdf5File::flush(bool) {}
void Hdf5File::close() {}
#endif

}  // namespace mbd
