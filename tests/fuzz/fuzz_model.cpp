// libFuzzer on reader and compile: any bytes are a model, or are refused by an Error. Everything else is a
// finding: a crash, another exception, undefined behaviour, a leak, more time or memory than tools/fuzz allows.
//
// The text is what LLVMFuzzerMutate makes of it or, half of the time, a Mutation of a model: random bytes alone
// hardly ever come past the XML parser. <include> finds nothing: its files are looked up in a directory that does
// not exist; a file elsewhere could only be read.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/language/reading_limits.hpp"
#include "tests/fuzz/mutation.hpp"

// Of libFuzzer; size of the result, at most `most`.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

// Larger models are slow under the fuzzer's instruments, and find nothing more.
constexpr long most_nodes = 300;

long nodes(const mbd::Scene& scene) {
  long sum = std::ssize(scene.bodies);
  for (const mbd::BeamScene& beam : scene.beams) sum += 1 + long{beam.elements} * long{beam.order};
  return sum;
}

std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace

// Under the fuzzer's instruments large models are slow, and find nothing more.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  mbd::reading_limits() = {.repetitions = 1'000, .section_unknowns = 3'000};
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text = mbd::test::Mutation(seed)(text_of(data, size));
  if (text.size() > most) return size;
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const mbd::Scene scene =
        mbd::read_model_text(text_of(data, size), "no_such_directory/model.xml");
    if (nodes(scene) > most_nodes) return 0;
    const mbd::Model model = mbd::compile(scene);
    mbd::VecX residual;
    model.system->residual(model.initial, residual);
  } catch (const mbd::Error&) {  // refused
  }
  return 0;
}
