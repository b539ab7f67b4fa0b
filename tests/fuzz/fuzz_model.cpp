// libFuzzer on reader and compile: any bytes are a model, or are refused by an Error. Everything else is a
// finding: a crash, another exception, undefined behaviour, a leak, more time or memory than tools/fuzz allows.
//
// The text is what LLVMFuzzerMutate makes of it, or (half of the time) a model in which a tag was left out, doubled
// or moved, or a value was exchanged: random bytes alone hardly ever come past the XML parser. <include> finds
// nothing: files are looked up in a directory that does not exist.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/front/model.hpp"
#include "libmbd/front/reader.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace mbd::test::fuzz_model {
namespace {

// Values that models seldom have.
constexpr std::array<std::string_view, 40> values = {
    "",       "0",       "-0",    "1",     "-1",       "2",        "1e-300",       "1e300",
    "-1e308", "nan",     "1/0",   "1e-16", "1e16",     "1e9",      "1e9+1",        "1000",
    "0.5",    "pi",      "t",     "s",     "sqrt(-1)", "log(0)",   "exp(800)",     "t<1 ? 0 : 1",
    "1/t",    "i",       "{i}",   "0 0 0", "1 0 0",    "0 0 1e-9", "0 0 1 1",      "1 2 3 4 5 6",
    "ground", "b.start", "b.end", "b@0.5", "1 mm",     "5 deg",    "1e3 kg m/s^2", "1e400"};

// Larger models are slow under the fuzzer's instruments, and find nothing more.
constexpr long most_nodes = 300;

long nodes(const Scene& scene) {
  long sum = std::ssize(scene.bodies);
  for (const BeamScene& beam : scene.beams) sum += 1 + long{beam.elements} * long{beam.order};
  return sum;
}

class Mutation {
 public:
  Mutation(std::string text, unsigned seed) : text_(std::move(text)), random_(seed) {}

  std::string operator()() {
    switch (below(5)) {
      case 0:
        if (const auto tag = a_tag()) text_.erase(tag->begin, tag->size);
        break;
      case 1:
        if (const auto tag = a_tag()) text_.insert(tag->begin, text_.substr(tag->begin, tag->size));
        break;
      case 2:
        if (const auto tag = a_tag()) {
          const std::string moved = text_.substr(tag->begin, tag->size);
          text_.erase(tag->begin, tag->size);
          if (const auto other = a_tag()) text_.insert(other->begin, moved);
        }
        break;
      case 3:
        if (const auto value = a_value())
          text_.replace(value->begin, value->size, values[below(values.size())]);
        break;
      default:
        if (const auto value = a_value())
          if (const auto other = a_value())
            text_.replace(value->begin, value->size, text_.substr(other->begin, other->size));
    }
    return text_;
  }

 private:
  struct Piece {
    std::size_t begin, size;
  };

  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

  std::optional<Piece> chosen(const std::vector<Piece>& pieces) {
    if (pieces.empty()) return std::nullopt;
    return pieces[below(pieces.size())];
  }

  // From < to >.
  std::optional<Piece> a_tag() {
    std::vector<Piece> tags;
    for (std::size_t at = text_.find('<'); at != std::string::npos; at = text_.find('<', at + 1))
      if (const std::size_t end = text_.find('>', at); end != std::string::npos)
        tags.push_back({at, end + 1 - at});
    return chosen(tags);
  }

  // What stands in quotes, without them.
  std::optional<Piece> a_value() {
    std::vector<Piece> found;
    for (std::size_t at = text_.find("=\""); at != std::string::npos; at = text_.find("=\"", at)) {
      at += 2;
      const std::size_t end = text_.find('"', at);
      if (end == std::string::npos) break;
      found.push_back({at, end - at});
      at = end;
    }
    return chosen(found);
  }

  std::string text_;
  std::minstd_rand random_;
};

}  // namespace
}  // namespace mbd::test::fuzz_model

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text =
      mbd::test::fuzz_model::Mutation({reinterpret_cast<const char*>(data), size}, seed)();
  if (text.size() > most) return size;
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const mbd::Scene scene = mbd::read_model_text({reinterpret_cast<const char*>(data), size},
                                                  "no_such_directory/model.xml");
    if (mbd::test::fuzz_model::nodes(scene) > mbd::test::fuzz_model::most_nodes) return 0;
    const mbd::Model model = mbd::compile(scene);
    mbd::VecX residual;
    model.system->residual(model.initial, residual);
  } catch (const mbd::Error&) {  // refused
  }
  return 0;
}
