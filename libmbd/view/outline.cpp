#include "libmbd/view/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <utility>

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr double on_a_line = 2e-3;  // of the larger side

// Nodes of an element round its border.
std::vector<int> border_of(const section::Element& element) {
  const auto p = static_cast<std::size_t>(element.order);
  const auto& n = element.nodes;
  std::vector<int> border;
  if (element.shape == section::Shape::grid) {
    const auto at = [&](std::size_t i, std::size_t j) { return n[i + (p + 1) * j]; };
    for (std::size_t i = 0; i < p; ++i) border.push_back(at(i, 0));
    for (std::size_t j = 0; j < p; ++j) border.push_back(at(p, j));
    for (std::size_t i = p; i > 0; --i) border.push_back(at(i, p));
    for (std::size_t j = p; j > 0; --j) border.push_back(at(0, j));
    return border;
  }
  const bool is_triangle = element.shape == section::Shape::triangle;
  const std::size_t corners = is_triangle ? 3 : 4, inside = is_triangle ? p - 1 : 1;
  for (std::size_t c = 0; c < corners; ++c) {
    border.push_back(n[c]);
    for (std::size_t k = 0; k < inside; ++k) border.push_back(n[corners + c * inside + k]);
  }
  return border;
}

double cross(const section::Point& a, const section::Point& b) { return a(0) * b(1) - a(1) * b(0); }

// Leaves out points of a loop that lie between their neighbours, seen from the last one kept.
std::vector<int> without_straight(const std::vector<int>& loop,
                                  const std::vector<section::Point>& nodes, double size) {
  const auto at = [&](std::size_t k) {
    return nodes[static_cast<std::size_t>(loop[k % loop.size()])];
  };
  std::vector<int> kept;
  std::size_t last = 0;
  kept.push_back(loop[0]);
  for (std::size_t k = 1; k < loop.size(); ++k) {
    // All points since the last kept one lie near the line from there to the point after this one.
    const section::Point from = at(last), along = at(k + 1) - from;
    const double length = along.norm();
    bool straight = length > 0.0;
    for (std::size_t i = last + 1; i <= k && straight; ++i)
      straight = std::abs(cross(along, at(i) - from)) <= on_a_line * size * length &&
                 along.dot(at(i) - from) >= 0.0 && (at(i) - from).dot(along) <= length * length;
    if (straight) continue;
    kept.push_back(loop[k]);
    last = k;
  }
  return kept.size() >= 3 ? kept : loop;
}

}  // namespace

SectionOutline round_outline(int corners) {
  SectionOutline all;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    all.rim.push_back({std::cos(angle), std::sin(angle)});
    all.next.push_back((i + 1) % corners);
  }
  all.caps = {all.rim};
  return all;
}

SectionOutline rectangle_outline() {
  SectionOutline all;
  all.rim = {{1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}};
  all.next = {1, 2, 3, 0};
  all.caps = {all.rim};
  return all;
}

bool are_alike(const SectionOutline& a, const SectionOutline& b) {
  constexpr double near = 0.15;  // of half a side
  if (a.rim.size() != b.rim.size() || a.next != b.next) return false;
  for (std::size_t i = 0; i < a.rim.size(); ++i)
    if (!(std::hypot(a.rim[i][0] - b.rim[i][0], a.rim[i][1] - b.rim[i][1]) <= near)) return false;
  return true;
}

SectionOutline outline_of(const section::Mesh& mesh, std::array<double, 2>& sides) {
  std::set<std::pair<int, int>> edges;
  for (const section::Element& element : mesh.elements) {
    const std::vector<int> border = border_of(element);
    for (std::size_t k = 0; k < border.size(); ++k) {
      const std::pair edge{border[k], border[(k + 1) % border.size()]};
      if (edges.erase({edge.second, edge.first}) == 0) edges.insert(edge);
    }
  }
  section::Point low = section::Point::Constant(1e300), high = -low;
  for (const auto& [a, b] : edges) {
    low = low.cwiseMin(mesh.nodes[static_cast<std::size_t>(a)]);
    high = high.cwiseMax(mesh.nodes[static_cast<std::size_t>(a)]);
  }
  const section::Point width = high - low;
  sides = {width(0), width(1)};
  const auto scaled = [&](int node) {
    const section::Point& x = mesh.nodes[static_cast<std::size_t>(node)];
    const auto digits = [](double v) { return std::stod(fmt::format("{:.5g}", v)) + 0.0; };
    return OutlinePoint{digits(2.0 * x(0) / width(0)), digits(2.0 * x(1) / width(1))};
  };
  SectionOutline all;
  std::multimap<int, int> after;
  for (const auto& [a, b] : edges) after.emplace(a, b);
  while (!after.empty()) {
    std::vector<int> loop;
    for (auto it = after.begin(); it != after.end(); it = after.find(loop.back())) {
      if (loop.empty()) loop.push_back(it->first);
      const int b = it->second;
      after.erase(it);
      if (b == loop.front()) break;
      loop.push_back(b);
    }
    if (loop.size() < 3) continue;
    const auto first = static_cast<int>(all.rim.size());
    for (const int node : without_straight(loop, mesh.nodes, width.maxCoeff())) {
      all.rim.push_back(scaled(node));
      all.next.push_back(static_cast<int>(all.rim.size()));
    }
    all.next.back() = first;
  }
  for (const section::Element& element : mesh.elements) {
    std::vector<OutlinePoint> cap;
    const std::vector<int> border = border_of(element);
    for (const int node : without_straight(border, mesh.nodes, width.maxCoeff()))
      cap.push_back(scaled(node));
    all.caps.push_back(std::move(cap));
  }
  return all;
}

std::string outline_text(const SectionOutline& outline) {
  const auto flat = [](const std::vector<OutlinePoint>& points) {
    std::vector<double> all;
    for (const OutlinePoint& x : points) all.insert(all.end(), x.begin(), x.end());
    return all;
  };
  Json caps = Json::array();
  for (const auto& cap : outline.caps) caps.push_back(flat(cap));
  return Json{{"rim", flat(outline.rim)}, {"next", outline.next}, {"caps", std::move(caps)}}.dump();
}

SectionOutline outline_from(const std::string& text) {
  const auto points = [](const Json& flat) {
    std::vector<OutlinePoint> all;
    for (std::size_t i = 0; i + 1 < flat.size(); i += 2)
      all.push_back({flat.at(i).get<double>(), flat.at(i + 1).get<double>()});
    return all;
  };
  const Json json = Json::parse(text);
  SectionOutline all;
  all.rim = points(json.at("rim"));
  all.next = json.at("next").get<std::vector<int>>();
  for (const Json& cap : json.at("caps")) all.caps.push_back(points(cap));
  return all;
}

}  // namespace mbd
