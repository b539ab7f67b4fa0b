#include "libmbd/section/gmsh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/section/shape_functions.hpp"

namespace mbd::section {
namespace {

struct CellKind {
  int type, corners, nodes;
};
constexpr std::array<CellKind, 5> cell_kinds{
    {{2, 3, 3}, {9, 3, 6}, {3, 4, 4}, {16, 4, 8}, {10, 4, 9}}};
// Points and lines, which are passed over: numbers of their nodes by type.
constexpr std::array<std::pair<int, int>, 6> passed_over{
    {{15, 1}, {1, 2}, {8, 3}, {26, 4}, {27, 5}, {28, 6}}};

const CellKind* kind_of(int type) {
  const auto it = std::ranges::find(cell_kinds, type, &CellKind::type);
  return it == cell_kinds.end() ? nullptr : &*it;
}

// Numbers of a file, as text or as bytes.
class File {
 public:
  explicit File(const std::filesystem::path& path) : name_(path.string()) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw Error(name_ + ": there is no such file, or it cannot be read");
    text_.assign(std::istreambuf_iterator<char>(stream), {});
  }
  bool binary = false;

  [[noreturn]] void fail(const std::string& what) const {
    const std::string_view before(text_.data(), at_);
    throw Error(binary
                    ? fmt::format("{}: byte {}: {}", name_, at_, what)
                    : fmt::format("{}:{}: {}", name_, 1 + std::ranges::count(before, '\n'), what));
  }

  // The next line that begins with $, without that; nothing at the end.
  std::optional<std::string> section() {
    while (at_ < text_.size()) {
      const std::size_t found = text_.find('$', at_);
      if (found == std::string::npos) return std::nullopt;
      at_ = found + 1;
      if (found == 0 || text_[found - 1] == '\n') return line();
    }
    return std::nullopt;
  }
  // The rest of the line, without blanks at its end.
  std::string line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string result = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    while (!result.empty() && std::isspace(static_cast<unsigned char>(result.back())) != 0)
      result.pop_back();
    return result;
  }

  template <class T>
  T number(std::string_view what) {
    T value{};
    if (binary) {
      if (text_.size() - at_ < sizeof value) fail(fmt::format("it ends where {} should be", what));
      std::memcpy(&value, text_.data() + at_, sizeof value);
      at_ += sizeof value;
      return value;
    }
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{}) fail(fmt::format("{} is missing or no such number", what));
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  int integer(std::string_view what) { return number<int>(what); }
  double real(std::string_view what) {
    const double x = number<double>(what);
    if (!std::isfinite(x)) fail(fmt::format("{} is not finite", what));
    return x;
  }
  // How many of something: what follows must have room in the file.
  std::size_t count(std::string_view what) {
    const auto n = number<std::size_t>(what);
    if (n > text_.size()) fail(fmt::format("{} is {}, more than the file can hold", what, n));
    return n;
  }
  std::size_t count_of_int(std::string_view what) {
    const int n = integer(what);
    if (n < 0 || static_cast<std::size_t>(n) > text_.size())
      fail(fmt::format("{} is {}, more than the file can hold", what, n));
    return static_cast<std::size_t>(n);
  }
  void skip_byte() { at_ = std::min(at_ + 1, text_.size()); }

 private:
  std::string name_, text_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  Reader(const std::filesystem::path& path, double unit) : file_(path), unit_(unit) {}

  GmshMesh read() {
    format();
    while (const auto name = file_.section()) {
      if (*name == "PhysicalNames")
        names();
      else if (*name == "Entities")
        entities();
      else if (*name == "Nodes")
        version_ < 3.0 ? old_nodes() : nodes();
      else if (*name == "Elements")
        version_ < 3.0 ? old_elements() : elements();
      else if (*name == "PartitionedEntities")
        file_.fail("the mesh is partitioned; save it as a whole");
    }
    if (mesh_.cells.empty())
      file_.fail(
          "there are no triangles or quadrilaterals; mesh the surfaces, and where some are "
          "physical "
          "save those");
    return std::move(mesh_);
  }

 private:
  void format() {
    if (file_.section() != "MeshFormat") file_.fail("a file of Gmsh begins with $MeshFormat");
    version_ = file_.real("the version of the format");
    const int type = file_.integer("the type of the file"),
              size = file_.integer("the size of numbers");
    if (version_ != 2.2 && version_ != 4.1)
      file_.fail(fmt::format("format {} is not known; save it as version 2.2 or 4.1", version_));
    if (size != 8) file_.fail("numbers of other than 8 bytes");
    file_.line();
    if (type == 0) return;
    file_.binary = true;
    if (file_.integer("1, for the order of bytes") != 1)
      file_.fail("its bytes are in the other order; save it on such a machine, or as text");
  }

  void names() {
    // Text in binary files, too.
    const bool binary = std::exchange(file_.binary, false);
    const std::size_t n = file_.count("the number of physical names");
    for (std::size_t i = 0; i < n; ++i) {
      const int dimension = file_.integer("a dimension"), tag = file_.integer("a physical tag");
      const std::string rest = file_.line();
      const std::size_t from = rest.find('"'), to = rest.rfind('"');
      if (from == std::string::npos || to == from) file_.fail("a name in quotes is missing");
      if (dimension == 2) names_[tag] = rest.substr(from + 1, to - from - 1);
    }
    file_.binary = binary;
  }

  // 4.1: physical tags stand with the surfaces.
  void entities() {
    std::array<std::size_t, 4> n{};
    for (std::size_t& x : n) x = file_.count("a number of entities");
    for (std::size_t dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < n[dimension]; ++i) {
        const int tag = file_.integer("a tag");
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) file_.real("a bound");
        const std::size_t physicals = file_.count("a number of physical tags");
        for (std::size_t k = 0; k < physicals; ++k) {
          const int physical = file_.integer("a physical tag");
          if (dimension != 2) continue;
          if (k > 0)
            file_.fail(
                fmt::format("surface {} is of {} physical surfaces; give it one", tag, physicals));
          physical_[tag] = std::abs(physical);
        }
        if (dimension == 0) continue;
        const std::size_t bounding = file_.count("a number of bounding entities");
        for (std::size_t k = 0; k < bounding; ++k) file_.integer("a bounding entity");
      }
  }

  void add_node(std::size_t tag, double x, double y, double z) {
    if (!number_.emplace(tag, static_cast<int>(mesh_.nodes.size())).second)
      file_.fail(fmt::format("node {} is there twice", tag));
    mesh_.nodes.emplace_back(unit_ * x, unit_ * y);
    z_.push_back(unit_ * z);
  }

  void nodes() {
    const std::size_t blocks = file_.count("the number of blocks");
    for (int i = 0; i < 3; ++i) file_.number<std::size_t>("a number of nodes");
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = file_.integer("a dimension");
      file_.integer("a tag");
      const bool parametric = file_.integer("whether there are parameters") != 0;
      const std::size_t n = file_.count("a number of nodes");
      std::vector<std::size_t> tags(n);
      for (std::size_t& tag : tags) tag = file_.number<std::size_t>("a node's number");
      for (const std::size_t tag : tags) {
        const double x = file_.real("x"), y = file_.real("y"), z = file_.real("z");
        if (parametric)
          for (int k = 0; k < dimension; ++k) file_.real("a parameter");
        add_node(tag, x, y, z);
      }
    }
  }

  void old_nodes() {
    const std::size_t n = old_count("the number of nodes");
    for (std::size_t i = 0; i < n; ++i) {
      const int tag = file_.integer("a node's number");
      const double x = file_.real("x"), y = file_.real("y"), z = file_.real("z");
      add_node(static_cast<std::size_t>(tag), x, y, z);
    }
  }

  // Of 2.2: text in binary files, too.
  std::size_t old_count(std::string_view what) {
    const bool binary = std::exchange(file_.binary, false);
    const std::size_t n = file_.count(what);
    if (binary) file_.skip_byte();
    file_.binary = binary;
    return n;
  }

  int group_of(int physical) {
    std::string name;
    if (physical != 0) {
      const auto it = names_.find(physical);
      name = it == names_.end() ? std::to_string(physical) : it->second;
    }
    const auto it = std::ranges::find(mesh_.groups, name);
    if (it != mesh_.groups.end()) return static_cast<int>(it - mesh_.groups.begin());
    mesh_.groups.push_back(name);
    return static_cast<int>(mesh_.groups.size()) - 1;
  }

  int nodes_of_type(int type) const {
    if (const CellKind* const kind = kind_of(type)) return kind->nodes;
    const auto it = std::ranges::find(passed_over, type, &std::pair<int, int>::first);
    if (it == passed_over.end())
      file_.fail(fmt::format(
          "elements of type {} are no triangles with 3 or 6 nodes or quadrilaterals with 4, 8 "
          "or 9; mesh with order 1 or 2, surfaces only",
          type));
    return it->second;
  }

  template <class T>
  void add_cell(int type, int physical, long tag, const std::vector<T>& tags) {
    const CellKind* const kind = kind_of(type);
    if (kind == nullptr) return;
    GmshMesh::Cell cell{kind->corners, {}, group_of(physical), tag};
    for (const T node : tags) {
      const auto it = number_.find(static_cast<std::size_t>(node));
      if (it == number_.end())
        file_.fail(fmt::format("element {}: there is no node {}", tag, node));
      cell.nodes.push_back(it->second);
    }
    mesh_.cells.push_back(std::move(cell));
  }

  void elements() {
    const std::size_t blocks = file_.count("the number of blocks");
    for (int i = 0; i < 3; ++i) file_.number<std::size_t>("a number of elements");
    for (std::size_t b = 0; b < blocks; ++b) {
      const int dimension = file_.integer("a dimension"), entity = file_.integer("a tag"),
                type = file_.integer("a type");
      const std::size_t n = file_.count("a number of elements");
      std::vector<std::size_t> tags(static_cast<std::size_t>(nodes_of_type(type)));
      const auto physical = physical_.find(entity);
      for (std::size_t i = 0; i < n; ++i) {
        const auto tag = static_cast<long>(file_.number<std::size_t>("an element's number"));
        for (std::size_t& node : tags) node = file_.number<std::size_t>("a node");
        if (dimension == 2)
          add_cell(type, physical == physical_.end() ? 0 : physical->second, tag, tags);
      }
    }
  }

  void old_elements() {
    const std::size_t n = old_count("the number of elements");
    const auto one = [this](int type, std::size_t labels, int tag) {
      std::vector<int> numbers(labels), tags(static_cast<std::size_t>(nodes_of_type(type)));
      for (int& x : numbers) x = file_.integer("a tag");
      for (int& node : tags) node = file_.integer("a node");
      add_cell(type, numbers.empty() ? 0 : std::abs(numbers.front()), tag, tags);
    };
    for (std::size_t i = 0; i < n;) {
      if (!file_.binary) {
        const int tag = file_.integer("an element's number"), type = file_.integer("a type");
        one(type, file_.count_of_int("a number of tags"), tag);
        ++i;
        continue;
      }
      const int type = file_.integer("a type");
      const std::size_t many = file_.count_of_int("a number of elements");
      const std::size_t labels = file_.count_of_int("a number of tags");
      for (std::size_t k = 0; k < many; ++k)
        one(type, labels, file_.integer("an element's number"));
      i += std::max<std::size_t>(many, 1);
    }
  }

  File file_;
  double unit_, version_ = 0.0;
  std::map<int, std::string> names_;  // of physical surfaces
  std::map<int, int> physical_;       // of surfaces
  std::map<std::size_t, int> number_;
  GmshMesh mesh_;

 public:
  std::vector<double> z_;
};

// ---- what a mesh must be ----------------------------------------------------------------------

class Checker {
 public:
  Checker(GmshMesh& mesh, const std::vector<double>& z, std::string name)
      : mesh_(mesh), z_(z), name_(std::move(name)) {}

  void check() {
    Point low = node(mesh_.cells.front().nodes.front()), high = low;
    for (const GmshMesh::Cell& cell : mesh_.cells)
      for (const int n : cell.nodes) {
        low = low.cwiseMin(node(n));
        high = high.cwiseMax(node(n));
      }
    size_ = (high - low).maxCoeff();
    const double z = z_[static_cast<std::size_t>(mesh_.cells.front().nodes.front())];
    for (const GmshMesh::Cell& cell : mesh_.cells)
      for (const int n : cell.nodes)
        if (std::abs(z_[static_cast<std::size_t>(n)] - z) > 1e-6 * size_)
          fail(cell, fmt::format(
                         "it leaves the plane z = {:g}; sections lie in the plane of x and y", z));
    for (GmshMesh::Cell& cell : mesh_.cells) turn(cell);
    sides();
    joined();
    seams();
  }

 private:
  const Point& node(int n) const { return mesh_.nodes[static_cast<std::size_t>(n)]; }

  std::string of(const GmshMesh::Cell& cell) const {
    const std::string& group = mesh_.groups[static_cast<std::size_t>(cell.group)];
    const Point& x = node(cell.nodes.front());
    return fmt::format("element {}{}{} near x2 = {:g}, x3 = {:g}", cell.tag,
                       group.empty() ? "" : " of ", group, x(0), x(1));
  }
  [[noreturn]] void fail(const GmshMesh::Cell& cell, const std::string& what) const {
    throw Error(fmt::format("{}: {}: {}", name_, of(cell), what));
  }

  // Surfaces may be seen from either side.
  void turn(GmshMesh::Cell& cell) const {
    double area = 0.0;
    const auto n = static_cast<std::size_t>(cell.corners);
    for (std::size_t i = 0; i < n; ++i) {
      const Point &a = node(cell.nodes[i]), &b = node(cell.nodes[(i + 1) % n]);
      area += 0.5 * (a(0) * b(1) - b(0) * a(1));
    }
    if (std::abs(area) < 1e-14 * size_ * size_) fail(cell, "it has no area");
    if (area > 0.0) return;
    std::vector<int>& x = cell.nodes;
    if (cell.corners == 3) {
      std::swap(x[1], x[2]);
      if (x.size() > 3) std::swap(x[3], x[5]);
    } else {
      std::swap(x[1], x[3]);
      if (x.size() > 4) {
        std::swap(x[4], x[7]);
        std::swap(x[5], x[6]);
      }
    }
  }

  struct Side {
    std::size_t cell;
    int from, to, middle;  // middle: -1 where there is none
  };

  void sides() {
    for (std::size_t c = 0; c < mesh_.cells.size(); ++c) {
      const GmshMesh::Cell& cell = mesh_.cells[c];
      const auto n = static_cast<std::size_t>(cell.corners);
      for (std::size_t i = 0; i < n; ++i) {
        const Side side{c, cell.nodes[i], cell.nodes[(i + 1) % n],
                        cell.nodes.size() > n ? cell.nodes[n + i] : -1};
        std::vector<Side>& known = sides_[std::minmax(side.from, side.to)];
        if (known.size() > 1)
          fail(cell, fmt::format("it has a side that two others have, {} is one of them",
                                 of(mesh_.cells[known.front().cell])));
        if (!known.empty() && known.front().from == side.from)
          fail(cell,
               fmt::format("it overlaps {}, with which it has a side: one of them is inverted",
                           of(mesh_.cells[known.front().cell])));
        if (!known.empty() && known.front().middle != side.middle)
          fail(cell,
               fmt::format(
                   "its side has another node in the middle than that of {}; all elements have "
                   "to be of one order",
                   of(mesh_.cells[known.front().cell])));
        known.push_back(side);
      }
    }
  }

  void joined() const {
    DisjointSets sets(static_cast<int>(mesh_.cells.size()));
    for (const auto& [ends, both] : sides_)
      if (both.size() == 2)
        sets.join(static_cast<int>(both[0].cell), static_cast<int>(both[1].cell));
    for (std::size_t c = 1; c < mesh_.cells.size(); ++c)
      if (sets.root(static_cast<int>(c)) != sets.root(0))
        fail(mesh_.cells[c],
             fmt::format("the section is in pieces: no side joins it to {}; let regions "
                         "share their curves (in Gmsh: Coherence, or BooleanFragments)",
                         of(mesh_.cells.front())));
  }

  // Free sides upon each other are regions that were not joined.
  void seams() const {
    std::vector<std::pair<Point, const Side*>> middles;
    for (const auto& [ends, both] : sides_)
      if (both.size() == 1)
        middles.emplace_back(0.5 * (node(both[0].from) + node(both[0].to)), &both[0]);
    std::ranges::sort(middles, {}, [](const auto& x) { return x.first(0); });
    const double near = 1e-9 * size_;
    for (std::size_t i = 0; i < middles.size(); ++i)
      for (std::size_t j = i + 1;
           j < middles.size() && middles[j].first(0) - middles[i].first(0) < near; ++j) {
        const Side &a = *middles[i].second, &b = *middles[j].second;
        if ((node(a.from) - node(b.to)).norm() < near && (node(a.to) - node(b.from)).norm() < near)
          fail(mesh_.cells[a.cell],
               fmt::format(
                   "a side of it lies upon one of {} and is not joined to it: the region is open "
                   "there; let regions share their curves (in Gmsh: Coherence), or leave a gap",
                   of(mesh_.cells[b.cell])));
      }
  }

  GmshMesh& mesh_;
  const std::vector<double>& z_;
  std::string name_;
  double size_ = 0.0;
  std::map<std::pair<int, int>, std::vector<Side>> sides_;
};

// ---- elements of an order ---------------------------------------------------------------------

// Where a node of an element lies: at a corner, on the side after a corner (k-th from it), or inside.
struct Lies {
  int corner = -1, side = -1, k = 0;
};

std::vector<Lies> nodes_on(int corners, int order) {
  std::vector<Lies> all;
  if (corners == 3) {
    for (int c = 0; c < 3; ++c) all.push_back({c, -1, 0});
    for (int s = 0; s < 3; ++s)
      for (int k = 1; k < order; ++k) all.push_back({-1, s, k});
    all.resize(static_cast<std::size_t>(nodes_of(Shape::triangle, order)));
    return all;
  }
  for (int j = 0; j <= order; ++j)
    for (int i = 0; i <= order; ++i) {
      const bool left = i == 0, right = i == order, bottom = j == 0, top = j == order;
      if ((left || right) && (bottom || top))
        all.push_back({bottom ? (left ? 0 : 1) : (right ? 2 : 3), -1, 0});
      else if (bottom)
        all.push_back({-1, 0, i});
      else if (right)
        all.push_back({-1, 1, j});
      else if (top)
        all.push_back({-1, 2, order - i});
      else if (left)
        all.push_back({-1, 3, order - j});
      else
        all.push_back({});
    }
  return all;
}

// Shape functions of the file's element at a place, in Gmsh's order of nodes.
Eigen::VectorXd shapes_of(const GmshMesh::Cell& cell, double xi, double eta) {
  if (cell.corners == 3)
    return shape_functions(Shape::triangle, cell.nodes.size() == 3 ? 1 : 2, xi, eta).col(0);
  if (cell.nodes.size() == 8) return shape_functions(Shape::serendipity, 2, xi, eta).col(0);
  constexpr std::array<Index, 4> of_four{0, 1, 3, 2};
  constexpr std::array<Index, 9> of_nine{0, 2, 8, 6, 1, 5, 7, 3, 4};
  const Eigen::VectorXd grid =
      shape_functions(Shape::grid, cell.nodes.size() == 4 ? 1 : 2, xi, eta).col(0);
  Eigen::VectorXd result(grid.size());
  for (Index i = 0; i < grid.size(); ++i)
    result(i) = grid(grid.size() == 4 ? of_four[static_cast<std::size_t>(i)]
                                      : of_nine[static_cast<std::size_t>(i)]);
  return result;
}

Mesh mesh_of(const GmshMesh& file, const std::vector<MeshPart>& parts,
             const std::vector<MeshMaterial>& materials, int order) {
  Mesh mesh;
  mesh.materials = materials;
  std::map<int, int> corners;
  std::map<std::array<int, 3>, int> on_sides;
  const auto known = [&mesh](auto& all, const auto& key, const Point& x) {
    const auto [it, fresh] = all.emplace(key, static_cast<int>(mesh.nodes.size()));
    if (fresh) mesh.nodes.push_back(x);
    return it->second;
  };
  std::map<std::pair<int, std::size_t>, std::vector<Eigen::VectorXd>> tables;
  for (const GmshMesh::Cell& cell : file.cells) {
    Element element;
    element.shape = cell.corners == 3 ? Shape::triangle : Shape::grid;
    element.order = order;
    const MeshPart& part = parts[static_cast<std::size_t>(cell.group)];
    element.material = part.material;
    element.angle = part.angle;
    element.normals = {part.normal};
    const std::string& group = file.groups[static_cast<std::size_t>(cell.group)];
    element.name = fmt::format("element {}{}{}", cell.tag, group.empty() ? "" : " of ", group);
    std::vector<Eigen::VectorXd>& table = tables[{cell.corners, cell.nodes.size()}];
    if (table.empty()) {
      const Eigen::MatrixX2d places = node_places(element.shape, order);
      for (Index i = 0; i < places.rows(); ++i)
        table.push_back(shapes_of(cell, places(i, 0), places(i, 1)));
    }
    const std::vector<Lies> lies = nodes_on(cell.corners, order);
    for (std::size_t i = 0; i < lies.size(); ++i) {
      Point x = Point::Zero();
      for (std::size_t a = 0; a < cell.nodes.size(); ++a)
        x += table[i](static_cast<Index>(a)) * file.nodes[static_cast<std::size_t>(cell.nodes[a])];
      const auto corner = [&](int c) {
        return cell.nodes[static_cast<std::size_t>(c % cell.corners)];
      };
      if (lies[i].corner >= 0) {
        element.nodes.push_back(known(corners, corner(lies[i].corner), x));
      } else if (lies[i].side >= 0) {
        const int from = corner(lies[i].side), to = corner(lies[i].side + 1);
        const std::array<int, 3> key{std::min(from, to), std::max(from, to),
                                     from < to ? lies[i].k : order - lies[i].k};
        element.nodes.push_back(known(on_sides, key, x));
      } else {
        element.nodes.push_back(static_cast<int>(mesh.nodes.size()));
        mesh.nodes.push_back(x);
      }
    }
    mesh.elements.push_back(std::move(element));
  }
  return mesh;
}

}  // namespace

void GmshMesh::each_number(const std::function<void(double)>& f) const {
  for (const Point& x : nodes) {
    f(x(0));
    f(x(1));
  }
  for (const Cell& cell : cells) {
    f(cell.corners);
    f(cell.group);
    for (const int node : cell.nodes) f(node);
  }
}

GmshMesh read_gmsh(const std::filesystem::path& file, double unit) {
  Reader reader(file, unit);
  GmshMesh mesh = reader.read();
  Checker(mesh, reader.z_, file.string()).check();
  return mesh;
}

Mesher mesher_of(GmshMesh mesh, std::vector<MeshPart> parts, std::vector<MeshMaterial> materials) {
  return [mesh = std::move(mesh), parts = std::move(parts), materials = std::move(materials)](
             const Fineness& fineness) { return mesh_of(mesh, parts, materials, fineness.order); };
}

}  // namespace mbd::section
