#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/view/hdf5.hpp"
#include "libmbd/view/run_file.hpp"

namespace mbd {
namespace {

constexpr std::string_view format_of_linear = "mbd linear 1";

// Dense matrices, which are written once all of the file is laid out.
class Matrices {
 public:
  explicit Matrices(Hdf5File& file) : file_(file) {}

  // One without columns has no rows in HDF5, and is left out.
  void add(const std::string& path, const MatX& matrix, const char* label) {
    if (matrix.size() == 0) return;
    const Hdf5Attributes attributes = {{"label", std::string(label)}};
    added_.emplace_back(
        file_.add_series(path, {static_cast<std::size_t>(matrix.cols())}, attributes), &matrix);
  }
  void write() {
    for (const auto& [series, matrix] : added_) {
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = *matrix;
      file_.append(series, {rows.data(), static_cast<std::size_t>(rows.size())});
    }
  }

 private:
  Hdf5File& file_;
  std::vector<std::pair<Hdf5File::Series, const MatX*>> added_;
};

void add_ports(Hdf5File& file, const std::string& group, const std::vector<Port>& ports) {
  if (ports.empty()) return;
  std::vector<std::string> names, units, frames;
  for (const Port& port : ports) {
    names.push_back(port.name);
    units.push_back(port.unit);
    frames.push_back(port.frame);
  }
  file.add_group(group);
  file.add_texts(group + "/names", names);
  file.add_texts(group + "/units", units);
  file.add_texts(group + "/frames", frames);
}

// As triplets, from 0.
void add_sparse(Hdf5File& file, const std::string& group, const Eigen::SparseMatrix<double>& matrix,
                const char* label) {
  std::vector<double> rows, columns, values;
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it) {
      rows.push_back(static_cast<double>(it.row()));
      columns.push_back(static_cast<double>(it.col()));
      values.push_back(it.value());
    }
  file.add_group(group, {{"label", std::string(label)},
                         {"rows", static_cast<double>(matrix.rows())},
                         {"columns", static_cast<double>(matrix.cols())}});
  if (values.empty()) return;
  file.add_numbers(group + "/row", rows);
  file.add_numbers(group + "/column", columns);
  file.add_numbers(group + "/value", values);
}

}  // namespace

void write_linearization(const std::filesystem::path& path, const Linearization& linear,
                         const Scene& scene) {
  Hdf5File file(path);
  add_origin(file, format_of_linear, scene);
  if (linear.rotation) {
    const Vec3 &axis = linear.rotation->axis, &through = linear.rotation->through;
    file.add_numbers("rate", std::vector<double>{linear.rotation->rate},
                     {{"unit", std::string("rad/s")}});
    file.add_numbers("axis", std::vector<double>{axis(0), axis(1), axis(2)},
                     {{"unit", std::string("1")}});
    file.add_numbers("through", std::vector<double>{through(0), through(1), through(2)},
                     {{"unit", std::string("m")}});
  }
  if (linear.time)
    file.add_numbers("time", std::vector<double>{*linear.time}, {{"unit", std::string("s")}});
  add_ports(file, "inputs", linear.ports.inputs);
  add_ports(file, "outputs", linear.ports.outputs);
  Matrices matrices(file);
  if (linear.reduced) {
    add_ports(file, "states", linear.states);
    const ReducedMotion& reduced = *linear.reduced;
    matrices.add("E", reduced.E, "E x' = A x + B u");
    matrices.add("A", reduced.A, "E x' = A x + B u");
    matrices.add("B", reduced.G, "E x' = A x + B u");
    matrices.add("C", linear.C, "y = C x + D u");
    matrices.add("D", linear.D, "y = C x + D u");
  }
  constexpr const char* all = "M u'' + C u' + K u + G^T dlambda = F dw, G u = 0";
  file.add_group("all_nodes", {{"label", std::string(all)}});
  add_sparse(file, "all_nodes/M", linear.motion.M, "mass");
  add_sparse(file, "all_nodes/C", linear.motion.C, "rates");
  add_sparse(file, "all_nodes/K", linear.motion.K, "stiffness");
  add_sparse(file, "all_nodes/G", linear.motion.B, "gradient of the constraints");
  add_sparse(file, "all_nodes/F", linear.motion.F.sparseView(0.0, 0.0), "forces of the inputs");
  if (!linear.notes.empty()) file.add_texts("notes", linear.notes);
  file.start();
  matrices.write();
  file.flush(true);
  file.close();
}

}  // namespace mbd
