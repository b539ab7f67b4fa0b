// Expected numbers of a scene, checked while it runs.
#pragma once

#include <limits>
#include <vector>

#include "libmbd/results/observers.hpp"
#include "libmbd/results/report.hpp"

namespace mbd {

// Takes each expected value at its sample time, and extremes as the run goes; no history is kept.
class Expectations : public Observer {
 public:
  // Throws Error for a quantity that is not a column, or a time that is not one of a row of results
  // (row_interval) to 1e-9 of the duration.
  Expectations(const Scene& scene, const Model& model);

  void accepted(const Sample& sample) override;

  // Of what has been accepted so far.
  const std::vector<ExpectResult>& results() const { return results_; }

 private:
  struct Watch {
    std::size_t column = 0;
    ExpectScene::Of of = ExpectScene::Of::value_at;
    double at = 0.0;                                       // [s], or a load factor
    int number = 1;                                        // of an event of a path
    int met = 0;                                           // events of that kind so far
    double off = std::numeric_limits<double>::infinity();  // nearest row so far, from `at` [s]
  };

  std::vector<Watch> watches_;
  std::vector<ExpectResult> results_;
  double nearness_ = 0.0;  // [s]
};

// The column of that name. Throws Error naming what asks for it, the nearest spelling and all columns.
std::size_t find_column(std::span<const Column> columns, const std::string& name,
                        const Source& source, const std::string& who);

// The columns that the marks and stops of a scene's path refer to. Throws Error for others.
std::vector<std::size_t> find_marks(const Scene& scene, std::span<const Column> columns);

// Checks what plots and expectations ask of a run, without one: columns of the results and sample times.
// Throws Error as Expectations and HistoryPlot do.
void check_outputs(const Scene& scene, const Model& model);

}  // namespace mbd
