// libFuzzer on reader and compile: any bytes are a model, or are refused by an Error. Everything else is a
// finding: a crash, another exception, undefined behaviour, a leak, more time or memory than tools/fuzz allows.
//
// No model begins with a letter. What does is, by that letter, something else that mbd reads (seeds/): e an expression, u a number
// with its unit, c a table, r a report.json beside one, m a motion.bin, s what --set says; g is a seed of valid models
// (tests/support/grammar.hpp), which run ten steps and are held against a second integrator. They share the time, or the
// variable MBD_FUZZ_ONLY says the letter of one (x: models).
//
// The text is what LLVMFuzzerMutate makes of it or, half of the time, a Mutation of a model: random bytes alone
// hardly ever come past the XML parser. <include> finds nothing: its files are looked up in a directory that does
// not exist; a file elsewhere could only be read.

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/expression.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/language/units.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/scene/reading_limits.hpp"
#include "libmbd/view/motion.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/grammar.hpp"
#include "tests/support/temporary_directory.hpp"

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

// What is thrown here is a finding, but for Errors.
void read_model_and_compile(const std::string& text, const mbd::Overrides& overrides = {}) {
  const mbd::Scene scene = mbd::read_model_text(text, "no_such_directory/model.xml", overrides);
  if (nodes(scene) > most_nodes) return;
  const mbd::Model model = mbd::compile(scene);
  mbd::VecX residual;
  model.system->residual(model.initial, residual);
}

void evaluate(const std::string& text) {
  mbd::Parameters parameters;
  parameters["L"] = 2.0;
  parameters.inputs["torque"] = {};
  parameters.functions["ref"] = {std::make_shared<const std::string>("sin(t)"),
                                 std::make_shared<const mbd::Parameters>()};
  for (const mbd::Variables allowed :
       {mbd::Variables::none, mbd::Variables::time, mbd::Variables::x, mbd::Variables::sampled})
    try {
      const mbd::Expression law = mbd::Expression::parse(text, parameters, allowed);
      const std::vector<double> sensors(law.sensors().size(), 0.5);
      const std::vector<mbd::InputValue> inputs(1);
      for (const double t : {0.0, 0.3, -1e9}) law(t, mbd::Side::left, inputs, sensors);
      std::array<mbd::Interval, mbd::Expression::most_coefficients> cells;
      if (law.breakpoints().empty() && allowed == mbd::Variables::time)
        law.enclose(0.1, 0.2, cells);
    } catch (const mbd::Error&) {
    }
}

void convert(const std::string& text) {
  const mbd::NumberAndUnit parts = mbd::split_unit(text);
  for (const std::string_view wanted : {"m", "rad/s", "N.m", ""}) try {
      mbd::unit_factor(parts.unit, wanted);
    } catch (const mbd::Error&) {
    }
}

// A file of this name, in a directory of its own, with the text.
std::filesystem::path file_with(const char* name, const std::string& text) {
  static const mbd::test::TemporaryDirectory directory;
  std::ofstream(directory.path() / name, std::ios::binary) << text;
  return directory.path() / name;
}

// What libFuzzer makes of the bytes is another seed.
void try_valid_model(const std::string& bytes) {
  const mbd::test::Grammar grammar(std::hash<std::string>{}(bytes));
  const mbd::test::GrammarTrial trial = mbd::test::try_two_integrators(grammar.text());
  const std::string fault = trial.refusal.empty() ? trial.fault() : "refused: " + trial.refusal;
  if (!fault.empty()) throw std::runtime_error(fault + "\n" + grammar.text());
}

// The letter of what this process is for; 0: of all.
char only() {
  static const char* const text = std::getenv("MBD_FUZZ_ONLY");
  return text != nullptr ? text[0] : '\0';
}

void read_other(char what, const std::string& text) {
  switch (what) {
    case 'g':
      return try_valid_model(text);
    case 'e':
      return evaluate(text);
    case 'u':
      return convert(text);
    case 'c':
      mbd::read_history(file_with("table.csv", text));
      return;
    case 'r':
      mbd::doubts_about_run(file_with("report.json", text), "0123456789abcdef");
      return;
    case 'm': {
      const mbd::Motion motion = mbd::read_motion(file_with("motion.bin", text));
      mbd::read_motion_keys(motion);
      return;
    }
    case 's': {
      const std::size_t equals = std::min(text.find('='), text.size());
      read_model_and_compile(
          R"(<mbd name="m"><parameter name="L" value="2 m"/><parameter name="N" value="2"/>
             <parameter name="M" value="N*2"/><body name="b" at="L 0 0" mass="M" inertia="1 1 1"/>
             <repeat count="N"><point_mass at="b" mass="i"/></repeat><transient duration="1" step="1/N"/></mbd>)",
          {{text.substr(0, equals), text.substr(std::min(equals + 1, text.size()))}});
      return;
    }
    default:
      return read_model_and_compile(what + text);
  }
}

}  // namespace

// Under the fuzzer's instruments large models are slow, and find nothing more.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  mbd::reading_limits() = {.repetitions = 1'000, .section_unknowns = 3'000};
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  if (only() != 0 && only() != 'x' && most > 1) {
    if (size == 0) size = 1;
    data[0] = static_cast<std::uint8_t>(only());
  }
  const bool is_model = size == 0 || std::strchr("eucrmsg", data[0]) == nullptr || data[0] == 0;
  if (!is_model) {  // it stays what it is
    const std::size_t rest = LLVMFuzzerMutate(data + 1, size - 1, most - 1);
    return rest + 1;
  }
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text = mbd::test::Mutation(seed)(text_of(data, size));
  if (text.size() > most) return size;
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string text = text_of(data, size);
    const char letter =
        text.empty() || std::isalpha(static_cast<unsigned char>(text[0])) == 0 ? 'x' : text[0];
    if (only() != 0 && letter != only()) return 0;
    if (text.empty())
      read_model_and_compile(text);
    else
      read_other(text[0], text.substr(1));
  } catch (const mbd::Error&) {  // refused
  }
  return 0;
}
