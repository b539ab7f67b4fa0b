// How a study of accuracy is put into words and curves, the same in text, data and pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/accuracy/accuracy.hpp"

namespace mbd::study {

// "0.0012", "0.93", "12", "1200": two digits, whole from ten on.
std::string seconds_text(double seconds);

// "3e-9", "1.2e-5", "0", "1.3", "120": `digits` of them, the exponent without zeros in front; not a number: "-".
std::string number_text(double value, int digits = 2);

// The reference's own error, rounded up, or "not known".
std::string reference_text(const Quantity& quantity, double Quantity::*error);

// rms or largest error of a point: "1.2e-5"; "< 3e-9" where it is not well above the reference's own, which is rounded
// upwards; "-" where it is not known.
std::string rms_text(const AccuracyStudy& study, std::size_t point, std::size_t quantity);
std::string largest_text(const AccuracyStudy& study, std::size_t point, std::size_t quantity);
std::string bound_text(double reference_error);  // "3e-9"

// "up to time 7.2 s of 36 s", "nowhere"; empty where a quantity has errors to the end.
std::string until_text(const AccuracyStudy& study, const Quantity& quantity);

// "complete", "stopped after 12 s", "failed: no memory".
std::string state_text(const Trial& trial);

// How many points are complete, stopped, failed.
struct Tally {
  std::size_t complete = 0, stopped = 0, failed = 0;
};
Tally tally_of(const AccuracyStudy& study);
std::string tally_text(
    const AccuracyStudy& study);  // "48 runs: 45 complete, 2 stopped, 1 failed; 3 not tried"

// How errors are measured, a sentence or two.
std::string norm_text(const AccuracyStudy& study);

bool known(const AccuracyStudy& study, std::size_t point, std::size_t quantity);
bool on_front(const AccuracyStudy& study, std::size_t point, std::size_t quantity);

// "time [s]", "load factor".
std::string place_label(const AccuracyStudy& study);

// Advice of one quantity, neighbours with the same point together.
struct Range {
  double from = 0.0, to = 0.0;  // accuracies, from >= to
  std::size_t point = 0;
};
std::vector<Range> ranges_of(const AccuracyStudy& study, std::size_t quantity);
std::string text_of(const Range& range);  // "1e-2 to 1e-4"

// Points that differ in one knob only.
struct Family {
  std::string label;  // the knobs that tell it from the others: "order 3, radau"
  Knob along = Knob::step;
  std::vector<std::size_t> points;  // from coarse to fine
};

// For curves over CPU time: along steps or tolerances where they vary, else along elements, else along orders.
std::vector<Family> families_of(const AccuracyStudy& study);

// For curves over a knob that was varied by number, the others at their finest: over steps and tolerances with the most
// elements of the highest order, over elements (for each order) and orders (for each number of elements) with the
// smallest step or tolerance. Of as fine settings as there are those with the most known errors of `quantity`.
std::vector<Family> families_over(const AccuracyStudy& study, Knob knob, std::size_t quantity);

// step, tolerance, elements, order: those with two values or more.
std::vector<Knob> numeric_knobs(const AccuracyStudy& study);

// "2 (theory 2)".
std::string slope_text(const OrderFit& fit);

// The setting of the fit's points, without its own knob.
std::string family_text(const AccuracyStudy& study, const OrderFit& fit);

}  // namespace mbd::study
